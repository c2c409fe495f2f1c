import numpy as np
import pytest

from hyperleg_design.validation.blind.plants.stand import AHEAD, Stand

SIDES = np.array([[1.0, 1.0, 1.0], [1.0, 1.0, 1.0]])
MOVING = Stand(0.2, 0.05, 0.05, 0.01, np.array([0.6, 0.4, 0.7, 0.5, 0.4]), spread=0.1, turn=0.1)


def targets(stand, time, **state):
    given = {"ahead": AHEAD, "speed": 0.0, "roll": 0.0, "roll_rate": 0.0} | state
    return stand.targets(time, sides=SIDES, **given).reshape(2, 7)


def test_motions_grow_from_standing_still():
    still = targets(Stand(0.0, 0.0, 0.0, 0.0, np.ones(5)), 3.0)
    np.testing.assert_allclose(targets(MOVING, 0.0), still, atol=1e-15)
    np.testing.assert_array_equal(still[0], still[1])


@pytest.mark.parametrize("time", [0.4, 1.3, 5.0])
def test_the_hip_stays_above_the_ankle_and_the_foot_level(time):
    hip, knee, ankle = targets(Stand(0.2, 0.0, 0.0, 0.0, np.full(5, 0.6)), time)[0, 2:5]
    lean = MOVING.lean
    thigh, shank = 0.37 * np.sin(lean - hip), 0.345 * np.sin(knee + hip - lean)
    assert thigh == pytest.approx(shank)
    assert hip + knee + ankle == pytest.approx(0.0)


def test_a_body_that_leans_forward_is_pushed_back_by_both_ankles():
    upright, ahead = targets(MOVING, 2.0), targets(MOVING, 2.0, ahead=AHEAD + 0.01, speed=0.1)
    change = ahead - upright
    assert np.all(change[:, 4] > 0)
    np.testing.assert_array_equal(np.delete(change, 4, axis=1), 0.0)


def test_legs_spread_to_opposite_sides():
    wide = Stand(0.0, 0.0, 0.0, 0.0, np.full(5, 0.5), spread=0.2)
    left, right = targets(wide, 0.5)
    assert left[1] == pytest.approx(-right[1])
    assert abs(left[1]) > 0.05
