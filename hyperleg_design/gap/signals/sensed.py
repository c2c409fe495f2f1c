"""The velocity that controllers see: that of the motion, but the logged one at moments where no
position follows it.

A joint that shakes faster than its sensors sample, at a multiple of their rate, looks as if it
moved steadily. It does not, and the smoothed motion is right; but whoever damps by the sensor
pushes against what the sensor tells. Elsewhere the two differ by noise, which need not be that of
the controller's own samples: there the motion is what it sees, and no gain is taken for less than
it is.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.signals.smoothing import Smooth, lateness

WINDOW = 0.04
"""Time over which both velocities are averaged [s]."""
APART = 0.3
"""Difference over the size of the joint's velocity, from which they contradict each other."""
CLEARLY = 8.0
"""And over the usual size of the difference, its median."""
MARGIN = 0.04
"""Time around such a moment that counts to it [s]."""


def sensed_velocity(velocity: np.ndarray, motion: Smooth, step: float) -> np.ndarray:
    """Compute the velocity of the joints as their controllers measure it.

    Args:
        velocity: logged, on the ticks `(t, n)` [rad/s]; NaN where unknown.
        motion: smoothed.
        step: of the ticks [s].

    Returns:
        The velocity [rad/s], `(t, n)`.
    """
    sensed = motion.first.copy()
    for joint, (logged, speed, second) in enumerate(
        zip(velocity.T, motion.first.T, motion.second.T, strict=True)
    ):
        known = np.isfinite(logged) & np.isfinite(speed) & np.isfinite(second)
        if not known.any():
            continue
        apart, turning = (np.where(known, values, 0.0) for values in (logged - speed, second))
        apart = np.abs(_averaged(apart + lateness(apart, turning) * turning, WINDOW / step))
        size = float(np.sqrt(np.mean(speed[known] ** 2)))
        off = known & (apart > max(APART * size, CLEARLY * float(np.median(apart[known]))))
        near = known & (_averaged(off.astype(float), 2 * MARGIN / step) > 0)
        sensed[near, joint] = logged[near]
    return sensed


def _averaged(values: np.ndarray, width: float) -> np.ndarray:
    """Moving average over an odd number of ticks."""
    from scipy.ndimage import uniform_filter1d

    return np.asarray(uniform_filter1d(values, 2 * max(round(width / 2), 1) + 1, mode="nearest"))
