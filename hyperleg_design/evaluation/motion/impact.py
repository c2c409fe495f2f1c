"""Impact at touchdown: peak of the vertical ground reaction force, loading rate and impulse.

The force is low-pass filtered by a Butterworth filter run forwards and backwards (no delay);
cut-off and order are the protocol's. Much of the peak is the stiffness of the sole's contact, so
designs are compared at equal contact settings.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError

RATE_FROM, RATE_TO = 0.2, 0.8
"""Shares of the peak between which the loading rate is the mean slope."""


@dataclass(frozen=True, eq=False)
class Impacts:
    """Impacts of one foot: one entry of each array for each touchdown, `(k,)`."""

    peak: np.ndarray
    """Largest filtered vertical force within the window [N]."""
    raw_peak: np.ndarray
    """Largest unfiltered vertical force within the window [N]."""
    loading_rate: np.ndarray
    """Mean slope from `RATE_FROM` to `RATE_TO` of the peak, on the rise to it [N/s]; NaN where the
    record begins on that rise."""
    impulse: np.ndarray
    """Integral of the filtered force over the window [Ns]."""


def low_pass(force: Any, time_step: float, cutoff: float, order: int) -> np.ndarray:
    """Filter forces with a low-pass filter that causes no delay.

    Args:
        force: `(t, ...)` [N].
        time_step: between samples [s].
        cutoff: frequency at which both passes together leave half the amplitude [Hz]; 0 for no
            filter.
        order: of both passes together, even.

    Returns:
        The filtered forces, `(t, ...)` [N].

    Raises:
        InputError: a cut-off past half the sampling rate.
    """
    from scipy.signal import sosfiltfilt

    force = np.asarray(force, float)
    if cutoff == 0:
        return force.copy()
    if not 0 < cutoff < 0.5 / time_step:
        raise InputError(
            "impact",
            "cutoff",
            cutoff,
            f"expects a frequency below half the sampling rate, {0.5 / time_step:g} Hz, or 0 for "
            f"none",
        )
    sections = _sections(order // 2, cutoff, 1 / time_step)
    padding = min(3 * (2 * len(sections) + 1), len(force) - 1)
    return np.asarray(sosfiltfilt(sections, force, axis=0, padlen=padding))


@cache
def _sections(order: int, cutoff: float, rate: float) -> np.ndarray:
    """Second-order sections of the Butterworth filter, which every trial of a protocol shares."""
    from scipy.signal import butter

    return np.asarray(butter(order, cutoff, fs=rate, output="sos"))


def impacts(force: Any, filtered: Any, touchdown: Any, time_step: float, window: float) -> Impacts:
    """Measure the impact of each touchdown of one foot.

    Args:
        force: vertical force on the foot [N], `(t,)`.
        filtered: the same, filtered, `(t,)`.
        touchdown: samples at which contacts begin, `(k,)`; those whose window the record does not
            hold are NaN.
        time_step: between samples [s].
        window: after touchdown [s].

    Returns:
        The impacts in the order of `touchdown`, `(k,)` each.
    """
    force, filtered, downs = (
        np.asarray(force, float),
        np.asarray(filtered, float),
        np.asarray(touchdown, int),
    )
    length = round(window / time_step)
    values = np.full((4, len(downs)), np.nan)
    for i, down in enumerate(downs):
        if down + length >= len(force):
            continue
        part = slice(down, down + length + 1)
        place = down + int(np.argmax(filtered[part]))
        values[:, i] = (
            filtered[place],
            force[part].max(),
            _slope(filtered, place, time_step),
            np.trapezoid(filtered[part], dx=time_step),
        )
    return Impacts(*values)


def _slope(force: np.ndarray, peak: int, time_step: float) -> float:
    """Mean slope between two shares of a peak on the way up to it [N/s]."""
    times = []
    for portion in (RATE_TO, RATE_FROM):
        below = np.flatnonzero(force[:peak] < portion * force[peak])
        if not len(below):
            return np.nan
        low = int(below[-1])
        times.append(
            (low + (portion * force[peak] - force[low]) / (force[low + 1] - force[low])) * time_step
        )
    return float((RATE_TO - RATE_FROM) * force[peak] / (times[0] - times[1]))
