from __future__ import annotations

import numpy as np
import pytest
from robots import PENDULUM, servo_run, waves

from hyperleg_design.gap.playback.evidence import Evidence, evidence
from hyperleg_design.gap.playback.sheets import root_mean_square
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.gap.signals.signals import Signals

LOAD = (
    '<body name="load" pos="0 0 -0.2"><inertial pos="0 0 0" mass="0.2" diaginertia="1e-5 1e-5 '
    '1e-5"/></body>'
)
TRUE = {
    "effect": "payload",
    "location": "arm",
    "parameters": {"mass": {"value": 0.2}, "com_z": {"value": -0.2}},
}


@pytest.fixture(scope="module")
def signals(tmp_path_factory: pytest.TempPathFactory) -> Signals:
    path = tmp_path_factory.mktemp("pendulum") / "pendulum.xml"
    path.write_text(PENDULUM)
    log = servo_run(PENDULUM.replace("</body>", LOAD + "</body>"), waves(1, 1.0), 8.0, base="fixed")
    return condition(log, load_subject(path, [log]))


def test_the_true_cause_explains_and_another_does_not(signals: Signals) -> None:
    right, nothing = evidence(signals, [TRUE]), evidence(signals, [])
    wrong = evidence(
        signals,
        [
            {
                "effect": "coulomb_friction",
                "location": "swing",
                "parameters": {"torque": {"value": 0.05}},
            }
        ],
    )
    before = root_mean_square(nothing.before)[0]
    assert before > 0.02
    assert root_mean_square(right.after)[0] < 0.02 * before
    assert root_mean_square(wrong.after)[0] > 0.9 * before
    np.testing.assert_array_equal(nothing.after, nothing.before)
    assert right.rows == ("swing",)
    assert (right.units, right.speed_units) == (("Nm",), ("rad/s",))
    assert right.worst == 0


def test_what_the_references_show_already_is_taken_off(signals: Signals) -> None:
    nothing, stood = evidence(signals, []), evidence(signals, [], standing=[TRUE])
    before = root_mean_square(nothing.before)[0]
    assert root_mean_square(stood.before)[0] < 0.02 * before
    np.testing.assert_array_equal(stood.after, stood.before)
    np.testing.assert_allclose(stood.before, evidence(signals, [TRUE]).after, atol=1e-9)


def test_the_row_that_is_drawn_is_the_one_that_causes_explain():
    """A larger residual elsewhere is another matter, unless nothing is explained."""
    before, units = np.tile([3.0, 1.0], (5, 1)), (("Nm",) * 2, ("rad/s",) * 2)
    one = Evidence(
        "log",
        "motion",
        ("hip", "knee"),
        np.arange(5.0),
        before,
        np.tile([0.0, 0.5], (5, 1)),
        np.zeros((5, 2)),
        *units,
    )
    nothing = Evidence(
        "log",
        "motion",
        ("hip", "knee"),
        np.arange(5.0),
        before,
        np.zeros((5, 2)),
        np.zeros((5, 2)),
        *units,
    )
    assert (one.worst, nothing.worst) == (1, 0)
