from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.checks.consistency import leg_length


def test_the_papers_lengths(hyperleg):
    assert leg_length(hyperleg) == pytest.approx(0.786, abs=1e-12)
    assert leg_length(hyperleg) + hyperleg.pelvis.height == pytest.approx(0.9586, abs=1e-12)
    batch = hyperleg.with_values({"thigh.length": np.array([0.3, 0.4])})
    np.testing.assert_allclose(leg_length(batch), [0.716, 0.816], atol=1e-12)


@pytest.mark.parametrize(
    ("values", "field", "word"),
    [
        (
            {"joints.knee.lower_deg": 150, "joints.knee.upper_deg": 0},
            "joints.knee.lower_deg",
            "reversed",
        ),
        ({"joints.toe.lower_deg": 10}, "joints.toe.lower_deg", "empty"),
        ({"joints.knee.default_deg": -20}, "joints.knee.default_deg", "within"),
        ({"foot.ball_length": 0.6, "toe.length": 0.3}, "foot.ball_length", "longer than the leg"),
        ({"foot.ankle_height": 0.35}, "foot.ankle_height", "shank"),
        ({"toe.axis_height": 0.08}, "toe.axis_height", "ankle"),
        ({"foot.width": 0.5}, "foot.width", "overlap"),
        (
            {"toe.axis_height": 0.005, "foot.width": 0.02, "contact.pad_radius": 0.09},
            "contact.pad_radius",
            "larger",
        ),
        ({"thigh.mass": 0.5}, "thigh.mass", "carriers"),
        ({"foot.mass": 0.05}, "foot.cross_mass", "foot.mass"),
        ({"toe.mass": 0.0}, "toe.mass", "locked"),
        ({"actuators.toe_installed": False}, "actuators.toe_installed", "locked"),
        ({"pelvis.gyration": [0.01, 0.01, 0.1]}, "pelvis.gyration", "no body"),
        ({"thigh.gyration_fraction": [0.3, 0.1, 0.1]}, "thigh.gyration_fraction", "no body"),
        ({"toe.gyration": [0.001, 0.2, 0.01]}, "toe.gyration", "no body"),
        ({"pelvis.mass": 3.0}, "pelvis.mass", "actuators"),
        ({"thigh.mass": 2.5}, "thigh.mass", "actuators"),
        (
            {
                "transmission.walking.knee": 1000,
                "transmission.scale.knee": 20,
                "transmission.scale.toe": 0.05,
                "transmission.walking.toe": 0.1,
            },
            "transmission.walking",
            "singular",
        ),
    ],
)
def test_what_does_not_fit_together(hyperleg, values, field, word):
    with pytest.raises(InputError) as caught:
        hyperleg.with_values(values)
    assert caught.value.field == field
    assert word in str(caught.value)
    assert "hyperleg.yaml with override" in str(caught.value)


def test_the_faulty_design_of_a_batch_is_named(hyperleg):
    lower = np.array([-65.0, 20.0, -65.0])
    with pytest.raises(InputError, match=r"joints\.toe\.lower_deg = 20\.0"):
        hyperleg.with_values({"joints.toe.lower_deg": lower})
    with pytest.raises(InputError, match=r"toe\.gyration = \[0\.2, 0\.01, 0\.01\]"):
        hyperleg.with_values({"toe.gyration": np.array([[0.02, 0.02, 0.02], [0.2, 0.01, 0.01]])})
