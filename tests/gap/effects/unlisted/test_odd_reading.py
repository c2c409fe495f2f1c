"""Wrong readings, against the equation of motion of a pendulum."""

import numpy as np
import pytest
from pendulum import INERTIA, LENGTH, MASS, ROTOR, Wrong

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.effects.unlisted.odd_reading import ORDERS

READING = WEIGHED["odd_reading"]


def taken(signals, error, bend):
    """What a small error of the reading, and its second derivative, leave (t,)."""
    whole = INERTIA + MASS * LENGTH**2 + ROTOR
    return -whole * bend - MASS * 9.81 * LENGTH * np.cos(signals.position[:, 0]) * error


@pytest.mark.parametrize("place", range(2 * len(ORDERS)))
def test_waves_of_the_angle_leave_what_the_pendulum_needs_less(pendulum, place):
    signals = pendulum(Wrong())
    q, v, a = signals.position[:, 0], signals.velocity[:, 0], signals.acceleration[:, 0]
    k, phase = ORDERS[place // 2], np.pi / 2 * (place % 2)
    error = np.cos(k * q - phase)
    bend = -k * np.sin(k * q - phase) * a - k**2 * error * v**2
    values = np.eye(READING.sizes + 1)[place]
    (found,) = READING.trace(signals, "swing", values)["motion"]
    known = signals.valid
    np.testing.assert_allclose(
        found[known, 0], taken(signals, error, bend)[known], atol=0.01 * np.ptp(found[known])
    )


def test_a_drift_grows_with_time(pendulum):
    signals = pendulum(Wrong())
    share = (signals.time - signals.time[0]) / (signals.time[-1] - signals.time[0])
    values = np.r_[1.0, np.zeros(READING.sizes - 1), 1.0]
    (found,) = READING.trace(signals, "swing", values)["motion"]
    known = signals.valid
    np.testing.assert_allclose(
        found[known, 0], taken(signals, share, 0.0)[known], atol=0.01 * np.ptp(found[known])
    )
