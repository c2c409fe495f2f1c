"""Rows of a trial's target table: shares, calibration, coverage and medians, with intervals."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.validation.blind.view import View
from hyperleg_design.validation.wilson import wilson

BINS = 5
"""Of equal width, of the stated probability."""
RESAMPLES = 4000
"""Of the bootstrap."""


@dataclass(frozen=True)
class Row:
    """One line of the target table."""

    measure: str
    value: float | None
    """None where no case speaks of it."""
    low: float | None
    high: float | None
    """95 % interval: Wilson's for shares, bootstrap else."""
    cases: int
    target: str
    reached: bool | None
    """None where no case speaks of it or no target is set."""


def calibration_error(probability: np.ndarray, right: np.ndarray) -> float:
    """Compute the expected calibration error.

    That is the mean distance of stated probability and share of right ones over `BINS` bins,
    weighted by cases.

    Args:
        probability: stated, `(c,)`.
        right: whether each was right, `(c,)`.

    Returns:
        The error, 0 to 1.
    """
    place = np.minimum((probability * BINS).astype(int), BINS - 1)
    return float(
        sum(
            abs(probability[place == k].mean() - right[place == k].mean()) * (place == k).mean()
            for k in range(BINS)
            if (place == k).any()
        )
    )


def share_row(
    measure: str, hits: Sequence[bool], target: float | None, *, most: bool = False
) -> Row:
    """Write the row of a share of cases.

    Args:
        measure: what is counted.
        hits: whether each case counts.
        target: of the share, None where none is set.
        most: whether the target is an upper bound.

    Returns:
        The row, with Wilson's interval.
    """
    aim = "-" if target is None else f"{'<=' if most else '>='} {target:.0%}"
    if not hits:
        return Row(measure, None, None, None, 0, aim, None)
    value = sum(hits) / len(hits)
    reached = None if target is None else (value <= target if most else value >= target)
    return Row(measure, value, *wilson(sum(hits), len(hits)), len(hits), aim, reached)


def calibration_row(views: Sequence[View]) -> Row:
    """Write the row of the expected calibration error of the stated probability.

    Args:
        views: the cases.

    Returns:
        The row, with a bootstrap interval over the cases that state one.
    """
    stated = [(v.probability, v.right()) for v in views if v.probability is not None]
    measure, aim = "expected calibration error of the stated probability", "<= 0.05"
    if not stated:
        return Row(measure, None, None, None, 0, aim, None)
    probability = np.array([p for p, _ in stated], float)
    right = np.array([r for _, r in stated], float)
    value = calibration_error(probability, right)
    low, high = _bootstrap(
        len(stated), lambda rows: calibration_error(probability[rows], right[rows])
    )
    return Row(measure, value, low, high, len(stated), aim, value <= 0.05)


def coverage_row(views: Sequence[View]) -> Row:
    """Write the row of the share of 95 % parameter intervals that hold the truth.

    Args:
        views: the cases.

    Returns:
        The row, with a bootstrap interval over cases.
    """
    groups = [held for v in views if (held := v.intervals())]
    measure, aim = "95 % parameter intervals that hold the truth", "90-98 %"
    if not groups:
        return Row(measure, None, None, None, 0, aim, None)
    value = float(np.mean(np.concatenate(groups)))
    low, high = _bootstrap(
        len(groups), lambda rows: float(np.mean(np.concatenate([groups[i] for i in rows])))
    )
    return Row(measure, value, low, high, len(groups), aim, 0.90 <= value <= 0.98)


def median_row(measure: str, values: Sequence[float | None], target: float | None) -> Row:
    """Write the row of a median.

    Args:
        measure: what is measured.
        values: of the cases, None where a case does not tell.
        target: least value, None where none is set.

    Returns:
        The row, with a bootstrap interval.
    """
    known = np.array([v for v in values if v is not None], float)
    aim = "-" if target is None else f">= {target:.0%}"
    if not known.size:
        return Row(measure, None, None, None, 0, aim, None)
    value = float(np.median(known))
    low, high = _bootstrap(known.size, lambda rows: float(np.median(known[rows])))
    return Row(
        measure, value, low, high, known.size, aim, None if target is None else value >= target
    )


def _bootstrap(count: int, statistic: Callable[[np.ndarray], float]) -> tuple[float, float]:
    rng = np.random.default_rng(0)
    values = [
        statistic(rng.integers(count, size=count))
        for _ in range(RESAMPLES if count < 200 else RESAMPLES // 4)
    ]
    return float(np.percentile(values, 2.5)), float(np.percentile(values, 97.5))
