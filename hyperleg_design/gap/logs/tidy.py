"""Rows of a recording in the order of a clock that rises strictly."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from hyperleg_design.errors import InputError


def tidied(
    time: np.ndarray, signals: Mapping[str, np.ndarray], name: str
) -> tuple[np.ndarray, dict[str, np.ndarray], tuple[str, ...]]:
    """Rows without a time left out, rows that repeat a time merged (two streams written at one
    stamp), infinities made NaN.

    Args:
        time: `(t,)` [s].
        signals: by column, `(t,)`.
        name: of the file, for messages.

    Returns:
        Time, signals, and what was done.

    Raises:
        InputError: more than half of the rows repeat or lack a time: the clock is too coarse or
        stands still.
    """
    time, remarks = np.asarray(time, float), []
    signals = {column: np.asarray(values, float) for column, values in signals.items()}
    known = np.isfinite(time)
    infinite = sorted(column for column, values in signals.items() if np.isinf(values).any())
    if infinite:
        remarks.append(f"infinite values count as unknown: {', '.join(infinite[:6])}")
        signals |= {
            column: np.where(np.isinf(signals[column]), np.nan, signals[column])
            for column in infinite
        }
    if not known.all():
        if known.mean() < 0.5:
            remedy = (
                f"is no number in {int((~known).sum())} of {len(known)} rows: expects a time in "
                f"every row"
            )
            raise InputError(name, "t", None, remedy)
        remarks.append(f"{int((~known).sum())} rows have no time and were left out")
        time, signals = time[known], {column: values[known] for column, values in signals.items()}
    first = np.concatenate([[True], np.diff(time) != 0])[: len(time)]
    if first.all():
        return time, signals, tuple(remarks)
    repeats = int((~first).sum())
    if repeats > len(time) / 2:
        remedy = (
            f"repeats in {repeats} of {len(time)} rows: the clock is too coarse or stands still"
        )
        raise InputError(name, "t", None, remedy)
    remarks.append(f"{repeats} rows repeat the time of the row before and were merged with it")
    starts = np.flatnonzero(first)
    ends = np.append(starts[1:], len(time))
    merged = {column: values[starts] for column, values in signals.items()}
    for later in range(1, int((ends - starts).max())):
        # what the first of several rows does not know, a later one may
        row = np.minimum(starts + later, ends - 1)
        for column, values in signals.items():
            merged[column] = np.where(np.isnan(merged[column]), values[row], merged[column])
    return time[starts], merged, tuple(remarks)


def check_clock(time: np.ndarray, name: str) -> None:
    """Refuse a clock that no log can have.

    Args:
        time: [s], `(t,)`.
        name: of the log, for the message.

    Raises:
        InputError: fewer than two rows, a time that is no number, or one that does not rise.
    """
    if len(time) < 2:
        raise InputError(name, "t", len(time), "is an empty log: expects at least two rows")
    if not np.isfinite(time).all():
        row = int(np.flatnonzero(~np.isfinite(time))[0])
        raise InputError(name, "t", None, f"is no number in row {row}: expects a time in every row")
    back = np.flatnonzero(np.diff(time) <= 0)
    if len(back):
        row = int(back[0]) + 1
        times = f"{time[row]:.9g} s in row {row} after {time[row - 1]:.9g} s"
        remedy = "runs backwards or repeats: sort the rows, or split the recording there"
        raise InputError(name, "t", times, remedy)
