"""Streams that were recorded on clocks of their own, brought onto one."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

GAP = 3.0
"""Times the stream's own median step over which nothing is filled in."""


def onto(
    time: np.ndarray, own_time: np.ndarray, signals: Mapping[str, np.ndarray], *, hold: bool
) -> dict[str, np.ndarray]:
    """Bring the signals of one stream to other times.

    Args:
        time: wanted `(t,)` [s], rising.
        own_time: of the stream `(k,)` [s], strictly rising.
        signals: by column `(k,)`.
        hold: keep the last value, as a controller keeps its target, instead of interpolating
            linearly.

    Returns:
        Signals by column, `(t,)` each; NaN where the stream has a gap, or has not begun.
    """
    if len(own_time) < 2:
        return {column: np.full(len(time), np.nan) for column in signals}
    after = np.clip(np.searchsorted(own_time, time, side="right"), 1, len(own_time) - 1)
    reach = GAP * float(np.median(np.diff(own_time)))
    known = (time >= own_time[0]) & (time <= own_time[-1] + (reach if hold else 0.0))
    if not hold:
        known &= own_time[after] - own_time[after - 1] <= reach
    resampled = {}
    for column, values in signals.items():
        if hold:
            at = np.clip(np.searchsorted(own_time, time, side="right") - 1, 0, None)
            resampled[column] = np.where(known, values[at], np.nan)
        else:
            weight = (time - own_time[after - 1]) / (own_time[after] - own_time[after - 1])
            resampled[column] = np.where(
                known, values[after - 1] + weight * (values[after] - values[after - 1]), np.nan
            )
    return resampled


def sorted_stream(
    time: np.ndarray, signals: Mapping[str, np.ndarray]
) -> tuple[np.ndarray, dict[str, np.ndarray], int]:
    """Sort a stream by its time stamps and leave repeated stamps out.

    Args:
        time: stamps [s], `(k,)`.
        signals: by column, `(k,)` each.

    Returns:
        Stamps, signals, and how many messages came out of order.
    """
    disorder = int((np.diff(time) < 0).sum())
    time, first = np.unique(time, return_index=True)
    return time, {column: values[first] for column, values in signals.items()}, disorder
