import numpy as np
import pytest

from hyperleg_design.validation.blind.excitation import OTHER, RIG, motion
from hyperleg_design.validation.blind.robots.catalogue import chain

RATE = 200.0


@pytest.mark.parametrize("kind", [*RIG, *OTHER])
@pytest.mark.parametrize("name", ["arm", "servo"])
def test_targets_start_at_rest_and_stay_inside_the_limits(kind, name):
    robot = chain(name)
    targets = motion(kind, robot, 8.0, RATE, np.random.default_rng(3))
    assert targets.shape == (1600, len(robot.joints))
    np.testing.assert_array_equal(targets[0], robot.rest)
    assert np.all(targets > robot.low)
    assert np.all(targets < robot.high)
    assert np.all(np.ptp(targets, axis=0) > 0.05)


def test_the_same_seed_gives_the_same_motion():
    robot = chain("arm")
    first, again, other = (
        motion("holds", robot, 4.0, RATE, np.random.default_rng(seed)) for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, other)


def test_both_operators_move_differently_and_an_unknown_motion_is_refused():
    assert not set(RIG) & set(OTHER)
    with pytest.raises(ValueError, match="no motion 'dance'"):
        motion("dance", chain("servo"), 1.0, RATE, np.random.default_rng(0))
