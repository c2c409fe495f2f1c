import numpy as np
import pytest

from hyperleg_design.gap.signals.sensed import MARGIN, sensed_velocity
from hyperleg_design.gap.signals.smoothing import Smooth

STEP = 0.004
TIME = np.arange(0, 6, STEP)
SPEED = np.cos(2 * np.pi * 0.7 * TIME)


@pytest.fixture
def motion():
    turning = -2 * np.pi * 0.7 * np.sin(2 * np.pi * 0.7 * TIME)
    return Smooth(
        np.zeros((len(TIME), 1)),
        SPEED[:, None],
        turning[:, None],
        np.array([60.0]),
        np.array([1e-5]),
    )


def sensed(motion, logged):
    return sensed_velocity(logged[:, None], motion, STEP)[:, 0]


@pytest.mark.parametrize("kind", ["noise", "late", "unknown"])
def test_what_differs_by_noise_or_comes_late_is_the_motion(motion, kind):
    noise = 0.05 * np.random.default_rng(2).normal(size=len(TIME))
    logged = {
        "noise": SPEED + noise,
        "late": np.interp(TIME - 0.008, TIME, SPEED) + 0.1 * noise,
        "unknown": np.full(len(TIME), np.nan),
    }[kind]
    np.testing.assert_array_equal(sensed(motion, logged), SPEED)


def test_moments_that_no_position_follows_are_as_logged(motion):
    noise = 0.02 * np.random.default_rng(3).normal(size=len(TIME))
    shaken = np.abs(TIME - 3.0) < 0.1
    logged = SPEED + noise + 1.5 * shaken
    found = sensed(motion, logged)
    np.testing.assert_array_equal(found[shaken], logged[shaken])
    away = np.abs(TIME - 3.0) > 0.1 + 2 * MARGIN
    np.testing.assert_array_equal(found[away], SPEED[away])
    assert np.array_equal(motion.first[:, 0], SPEED), "the motion itself stays"
