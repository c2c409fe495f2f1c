"""How a log was sampled: rate, jitter, dropouts, and of each column its own rate, quantisation,
noise and saturation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.logs.log import Log

OF_MEDIAN = 1.4826
"""Standard deviation of normal noise over its median deviation [-] (derived)."""
DROPOUT = 2.5
"""Steps from which the time between two rows is a dropout."""
SATURATION_RATIO = 5.0
"""Times that an extreme value must be more frequent than the next one to count as a bound."""
SATURATION_RUNS = 3
"""Times that a bound must be reached; a signal that merely rests does so once or twice."""
SATURATION_RUN = 3
"""Rows in a row at a bound from which it counts."""
_THIRD_DIFFERENCE = 20.0
"""Variance of the third difference of white noise of variance one, 1 + 9 + 9 + 1."""


@dataclass(frozen=True)
class Sampling:
    """How evenly the rows of a log follow each other in time."""

    ticks: int
    """Number of rows [-]."""
    duration: float
    """Time from the first row to the last [s]."""
    step: float
    """Median time between two rows [s]."""
    jitter: float
    """Spread of the steps without dropouts, a robust standard deviation over the median [-]."""
    dropouts: float
    """Share of the duration in steps longer than `DROPOUT` medians [-]."""
    longest: float
    """Longest time between two rows [s]."""

    @property
    def rate(self) -> float:
        """The number of rows per second [Hz]."""
        return 1 / self.step


@dataclass(frozen=True)
class Column:
    """What the values of one signal of a log look like: their own rate, range, steps and noise."""

    column: str
    """Name of the column, `kind/place`."""
    rate: float
    """At which its value is given anew [Hz]."""
    missing: float
    """Share of rows without a value, beyond those between its own samples [-]."""
    low: float
    """Smallest value, in the unit of the column."""
    high: float
    """Largest value of the column."""
    quantum: float
    """Smallest step between values; 0 where there is none."""
    noise: float
    """Standard deviation of what is white in it, quantisation included."""
    saturated: float
    """Share of rows at a bound that clips them [-]."""
    constant: bool
    """Whether it never changes."""
    held: int
    """Rows over which each value is kept."""
    unit: str = ""
    """Unit of the values."""


def sampling_of(time: np.ndarray) -> Sampling:
    """Describe the clock of a log.

    Args:
        time: of the rows [s], `(t,)`.

    Returns:
        Step, jitter and dropouts.
    """
    steps = np.diff(time)
    step = float(np.median(steps))
    usual = steps[steps <= DROPOUT * step]
    spread = OF_MEDIAN * float(np.median(np.abs(usual - np.median(usual)))) if len(usual) else 0.0
    lost = float(np.maximum(steps[steps > DROPOUT * step] - step, 0).sum() / (time[-1] - time[0]))
    return Sampling(
        len(time), float(time[-1] - time[0]), step, spread / step, lost, float(steps.max())
    )


def columns_of(log: Log) -> tuple[Column, ...]:
    """Describe each column of a log.

    Args:
        log: the log.

    Returns:
        Facts of the columns, in their order.
    """
    rate = 1 / log.step
    return tuple(_column(name, values, rate) for name, values in log.signals.items())


def _column(name: str, values: np.ndarray, rate: float) -> Column:
    known = np.flatnonzero(np.isfinite(values))
    if len(known) < 2:
        low = float(values[known[0]]) if len(known) else float("nan")
        return Column(name, 0.0, 1.0, low, low, 0.0, 0.0, 0.0, True, 1)
    own = values[known]
    every = max(int(np.median(np.diff(known))), 1)
    missing = max(0.0, 1 - len(known) * every / len(values))
    held = held_rows(own)
    low, high = float(own.min()), float(own.max())
    facts = quantum(own), noise(own[::held] if held > 1 else own), saturation(own)
    return Column(name, rate / (every * held), missing, low, high, *facts, low == high, held)


def held_rows(values: np.ndarray) -> int:
    """Count the rows over which every value is kept, as a controller keeps the target of a slow
    policy.

    Args:
        values: `(t,)`.

    Returns:
        The count; 1 where values change freely.
    """
    changes = np.flatnonzero(np.diff(values)) + 1
    if len(changes) < 8:
        return 1
    gaps = np.diff(changes)
    shortest = int(np.percentile(gaps, 5))
    if shortest < 2:
        return 1
    return shortest if np.mean(gaps % shortest == 0) > 0.9 else 1


def quantum(values: np.ndarray) -> float:
    """Find the smallest step between values of a quantised signal.

    Args:
        values: `(t,)`.

    Returns:
        The step; 0 where values hardly ever repeat, or are no multiples of one step.
    """
    levels = np.unique(values)
    if len(levels) < 2 or len(levels) > 0.95 * len(values):
        return 0.0
    gaps = np.diff(levels)
    # not the rounding of single precision
    real = gaps[gaps > 1e-6 * max(abs(levels[0]), abs(levels[-1]), 1e-12)]
    if not len(real):
        return 0.0
    step = float(real.min())
    ratio = real / step
    return step if np.mean(np.abs(ratio - np.round(ratio)) < 0.1) > 0.9 else 0.0


def noise(values: np.ndarray) -> float:
    """Estimate the standard deviation of the white part of a smooth signal, from its third
    differences.

    Args:
        values: `(t,)`.

    Returns:
        The deviation, in the unit of the values.
    """
    if len(values) < 8:
        return 0.0
    third = np.diff(values, 3)
    spread = OF_MEDIAN * float(np.median(np.abs(third - np.median(third))))
    if spread == 0:  # mostly at rest on one level
        spread = float(third.std())
    return spread / float(np.sqrt(_THIRD_DIFFERENCE))


def saturation(values: np.ndarray) -> float:
    """Compute the share of samples at a bound: an extreme that is far more frequent than the value
    next to it, and reached several times.

    Args:
        values: `(t,)`.

    Returns:
        The share [-].
    """
    levels, counts = np.unique(values, return_counts=True)
    if len(levels) < 20:
        return 0.0
    share = 0.0
    for end, beside in ((0, 1), (-1, -2)):
        if counts[end] < max(SATURATION_RATIO * counts[beside], 0.005 * len(values)):
            continue
        at = np.concatenate([[False], values == levels[end], [False]])
        edges = np.flatnonzero(np.diff(at.astype(np.int8)))
        runs = edges[1::2] - edges[::2]
        if (runs >= SATURATION_RUN).sum() >= SATURATION_RUNS:
            share += float(counts[end] / len(values))
    return share
