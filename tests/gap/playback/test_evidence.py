from __future__ import annotations

import numpy as np
import pytest
from robots import PENDULUM, servo_run, waves

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
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


def test_a_gain_explains_what_it_does_to_targets_that_come_late(tmp_path):
    """A servo of 0.7 of its stiffness, whose targets come 15 ms late in its references, too."""
    (tmp_path / "servo.xml").write_text(
        '<mujoco><worldbody><body name="arm"><joint name="hinge" axis="0 1 0" armature="0.01"/>'
        '<inertial pos="0 0 -0.1" mass="0.3" diaginertia="0.001 0.001 0.0001"/></body></worldbody>'
        '<actuator><position name="hinge" joint="hinge" kp="12" kv="0.5"/></actuator></mujoco>'
    )
    time = np.arange(0, 10, 0.005)
    position = 0.8 * np.sin(2 * time) + 0.3 * np.sin(5 * time)
    speed = 1.6 * np.cos(2 * time) + 1.5 * np.cos(5 * time)
    target = position + 0.06 * speed
    given = 12 * 0.7 * (np.interp(time - 0.015, time, target) - position) - 0.5 * speed
    signals = {"position/hinge": position, "position_target/hinge": target}
    log = Log("servo", time, signals | {"motor_torque/hinge": given}, Metadata(targets="moving"))
    conditioned = condition(log, load_subject(tmp_path / "servo.xml"))

    def cause(effect, location, **values):
        parameters = {name: {"value": value} for name, value in values.items()}
        return {"effect": effect, "location": location, "parameters": parameters}

    softer = cause("controller_gain", "hinge", stiffness_scale=0.7)
    late = cause("command_delay", "robot", delay=0.015, late=1.0)
    shown = evidence(conditioned, [softer], "drive", [late])
    before, after = (np.nanstd(rows) for rows in (shown.before, shown.after))
    assert after < 0.02 * before
