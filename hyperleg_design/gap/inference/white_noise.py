"""White noise of a residual, read off above the frequencies of the motion."""

from __future__ import annotations

import numpy as np

BESIDE, HIGHEST = 1.3, 0.3
"""White noise is read off from so many times the cutoff on, but from so much of the sampling rate
at most [-]: interpolation onto even ticks takes noise away near the Nyquist frequency."""


def has_room(cutoff: float, step: float) -> bool:
    """Tell whether a log has frequencies above those of its motion.

    Args:
        cutoff: frequency above which a row holds noise only [Hz].
        step: of the ticks [s].
    """
    return BESIDE * cutoff <= HIGHEST / step


def white_density(residual: np.ndarray, mask: np.ndarray, cutoff: float, step: float) -> float:
    """Estimate the density of a residual above its cutoff, by the median, which lines and leaks do
    not move.

    Args:
        residual: one row, unknown ticks zero `(t,)` [unit].
        mask: known ticks `(t,)`.
        cutoff: frequency above which the row holds noise only [Hz].
        step: of the ticks [s].

    Returns:
        One-sided density [unit^2/Hz]; 0 where too little is known.
    """
    known = np.flatnonzero(mask)
    if len(known) < 64:
        return 0.0
    # third differences take out what is slow, so that none of it leaks
    third = np.diff(np.interp(np.arange(known[0], known[-1] + 1), known, residual[known]), 3)
    power = np.abs(np.fft.rfft(third * np.hanning(len(third)))) ** 2
    frequency = np.fft.rfftfreq(len(third), step)
    first = min(BESIDE * cutoff, HIGHEST / step)
    high = (frequency > first) & (frequency < min(2 * first, 0.45 / step))
    if high.sum() < 8:
        return 0.0
    passed = (2 * np.sin(np.pi * frequency[high] * step)) ** 6
    passed = passed * (
        1 - (1 - np.cos(2 * np.pi * frequency[high] * step)) / 3
    )  # mean of linear interpolation at any place
    density = np.median(power[high] / passed) / np.log(2)
    return float(2 * step * density / np.sum(np.hanning(len(third)) ** 2))
