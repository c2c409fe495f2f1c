"""Joints in a limit cycle: a line in the motion above all that was commanded, as of a control loop
on the edge of its stability.

A smoother takes it for noise, and rightly leaves it out of accelerations. But friction sees it: a
joint that swings to and fro with the speed a sin(phi) while it moves at v is held back by the mean
of sign(v + a sin(phi)), 2/pi asin(v / a) where |v| < a, and hardly at all at rest
(Armstrong-Helouvry, Dupont and Canudas de Wit 1994, on dither). And it is a sign: healthy loops are
damped.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.signals.smoothing import Smooth, bridged

PRESLIDING = 3e-4
"""Half the way over which friction turns over [rad]; assumed: bristles of gears bend by 0.1-1 mrad
before they slide."""
LEAST_LINE = 0.5
"""Share of what smoothing leaves that a line must have; white noise has a tenth."""
HALF_WIDTH = 6
"""Half width of the line of a limit cycle, in steps of the spectrum; its frequency wanders with
posture and load."""
SEGMENT = 256
"""Ticks of a piece of the averaged spectrum."""
LOWEST = 0.15
"""Least frequency of a limit cycle over the rate of the log [-]: 30 Hz at 200 Hz; below it,
commanded motion may leave something."""
ABOVE = 1.3
"""Lowest frequency of a line over that of the smoother."""
WINDOW = 0.2
"""Time over which its size is averaged [s]."""
UNSETTLED = 0.2
"""Share of a log in which a joint must be in a limit cycle to count as unsettled."""


@dataclass(frozen=True, eq=False)
class LimitCycle:
    """Limit cycles of `n` joints on `t` ticks: how fast they are, and their share of the motion."""

    speed: np.ndarray
    """Amplitude of the joints' speed beyond what bends friction's bristles `(t, n)` [rad/s]; 0
    where a joint is in none."""
    frequency: np.ndarray
    """`(n,)` [Hz], as sampled; NaN where a joint is in none."""
    share: np.ndarray
    """Of the variance of the positions about their smooth course that the line makes `(n,)`."""
    joints: np.ndarray
    """Which joints are unsettled by it `(n,)` of bool."""


def limit_cycle(
    position: np.ndarray, velocity: np.ndarray, motion: Smooth, step: float
) -> LimitCycle | None:
    """Find the limit cycles of joints.

    Args:
        position: logged, on the ticks `(t, n)` [rad].
        velocity: logged, on the ticks `(t, n)` [rad/s]; a channel without any is derived from the
            positions.
        motion: smoothed.
        step: of the ticks [s].

    Returns:
        Their speeds and shares; None where no joint is in one.
    """
    ticks, count = position.shape
    cycle = LimitCycle(
        np.zeros((ticks, count)), np.full(count, np.nan), np.zeros(count), np.zeros(count, bool)
    )
    for joint in range(count):
        apart = _filled(position[:, joint] - motion.value[:, joint])
        if apart is None:
            continue
        fast = _filled(velocity[:, joint] - motion.first[:, joint])
        if fast is None:
            fast = np.gradient(apart, step)
        lowest = max(LOWEST / step, ABOVE * float(motion.crossover[joint]) / (2 * np.pi))
        frequency, share = _line(fast, step, lowest)
        if share < LEAST_LINE:
            continue
        square = _averaged(fast**2, max(round(WINDOW / step), 1))
        most = np.sqrt(2 * share * square)
        cycle.speed[:, joint] = np.maximum(most - PRESLIDING * 2 * np.pi * frequency, 0.0)
        cycle.frequency[joint], cycle.share[joint] = frequency, _line(apart, step, lowest)[1]
        cycle.joints[joint] = bool((cycle.speed[:, joint] > 0).mean() >= UNSETTLED)
    return cycle if cycle.speed.any() else None


def _filled(values: np.ndarray) -> np.ndarray | None:
    return bridged(values) if np.isfinite(values).sum() >= SEGMENT else None


def _line(values: np.ndarray, step: float, lowest: float) -> tuple[float, float]:
    """Frequency of the strongest line above one [Hz], and its share of all."""
    from scipy.signal import welch

    frequency, power = welch(values, 1 / step, nperseg=SEGMENT, detrend="linear")
    high = np.where(frequency >= lowest, power, 0.0)
    if not high.any():
        return np.nan, 0.0
    top = int(np.argmax(high))
    line = high[max(top - HALF_WIDTH, 0) : top + HALF_WIDTH + 1].sum()
    return float(frequency[top]), float(line / power.sum())


def _averaged(values: np.ndarray, window: int) -> np.ndarray:
    from scipy.ndimage import uniform_filter1d

    return np.asarray(uniform_filter1d(values, window))
