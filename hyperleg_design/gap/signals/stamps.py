"""Samples that were taken at other times than their stamps say: what that makes of a motion, the
faster a joint moves the more.

A sample that is early or late by some tau is off by tau times the joint's speed. All joints share a
clock, so the middle one of their taus is the log's. Smoothing lets of such noise, of a level that
its one level for the whole log cannot know, what is below its crossover.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hyperleg_design.gap.signals.signals import Signals

FASTEST = 90.0
"""Percentile of a joint's speed from which it is fast, against the slower half."""
FEWEST = 300
"""Samples of a joint below which they tell nothing."""
PASSED = 0.1745
"""Integral of x^4 / (1 + x^6)^2 from 0: squares of acceleration that a smoother passes of white
noise, see `smoothing`."""


def off_stamps(signals: Signals) -> float:
    """How far samples are off their stamps, standard deviation [s]; 0 where no more noise is in
    fast motion than in slow.
    """
    log, found = signals.log, []
    told = log.stack("position", signals.subject.joints)
    for joint in range(told.shape[1]):
        known = np.isfinite(told[:, joint])
        if known.sum() < FEWEST:
            continue
        speed = np.abs(np.interp(log.time[known], signals.time, signals.velocity[:, joint]))
        off = told[known, joint] - np.interp(
            log.time[known], signals.time, signals.position[:, joint]
        )
        slow, fast = speed <= np.median(speed), speed >= np.percentile(speed, FASTEST)
        beyond = max(_variance(off[fast]) - _variance(off[slow]), 0.0)
        found.append(
            np.sqrt(
                beyond / max(float(np.mean(speed[fast] ** 2) - np.mean(speed[slow] ** 2)), 1e-12)
            )
        )
    return float(np.median(found)) if found else 0.0


def of_acceleration(signals: Signals) -> np.ndarray:
    """What that leaves in the joints' smoothed accelerations, standard deviation `(t, n)`
    [rad/s^2].
    """
    if signals.bandwidth is None:
        return np.zeros_like(signals.velocity)
    crossover = 2 * np.pi * np.nan_to_num(signals.bandwidth)
    gain = np.sqrt(PASSED * crossover**5 * signals.step / np.pi)
    return np.asarray(off_stamps(signals) * np.abs(signals.velocity) * gain)


def _variance(values: np.ndarray) -> float:
    """Robust."""
    return float((np.median(np.abs(values)) / 0.6745) ** 2)
