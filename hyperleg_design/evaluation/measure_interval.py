"""The interval of a measure over seeds and trials, of the kind that suits the measure."""

from __future__ import annotations

import dataclasses

from hyperleg_design.evaluation.measures import OUTCOMES, SHARES
from hyperleg_design.evaluation.resampling import Groups
from hyperleg_design.evaluation.statistics import RESAMPLES, Estimate, estimate, share


def measure_interval(name: str, groups: Groups, *, resamples: int = RESAMPLES) -> Estimate:
    """Estimate the mean of a measure with its interval.

    Args:
        name: of the measure.
        groups: one array of the trials' values a seed; NaN where nothing could be measured.
        resamples: of the bootstrap.

    Returns:
        The estimate: `share` of ways in which trials end, which are counts; of other shares, such
        as that of time at a limit, `estimate` with its interval cut to 0 .. 1.
    """
    if name in OUTCOMES:
        return share(groups, resamples=resamples)
    interval = estimate(groups, resamples=resamples)
    if name not in SHARES:
        return interval
    return dataclasses.replace(interval, low=max(interval.low, 0.0), high=min(interval.high, 1.0))
