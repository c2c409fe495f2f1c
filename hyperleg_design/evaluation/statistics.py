"""What measured numbers say: intervals over seeds and trials, differences, effect sizes and
verdicts.

A training seed is one draw of a policy; the trials of its policies are draws of starting states. A
design is judged by several seeds, so a group of values is a sequence with one entry a seed: an
array of its trials, or, where several late checkpoints of a training were tried, a list of such
arrays, one a checkpoint. Values that could not be measured (no arrival, so no time) are NaN: they
are left out of means, counted in `missing`, and never silently dropped.

Intervals rest on a hierarchical bootstrap: seeds are drawn with replacement, then checkpoints of
each drawn seed, then trials of each drawn checkpoint; a seed's mean is that of its checkpoints'
means. With few seeds the bootstrap's spread is too small by sqrt((k - 1) / k) and percentiles cover
too little, so its standard error is multiplied by sqrt(k / (k - 1)) and by Student's t with k - 1
degrees of freedom (Hesterberg, 2015, on both corrections). Drawing trials anew counts their spread
twice, in the seeds' means and within them, so intervals are wider than they need be where trials of
one seed differ more than seeds do, and never narrower. One seed alone gives an interval over its
checkpoints, or the trials of its one, that cannot speak about seeds, and says so.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.effect_size import cliffs_delta, hedges_g
from hyperleg_design.evaluation.resampling import (
    Groups,
    flat_seed,
    mean_over_seeds,
    measured_groups,
    paired_error,
    paired_groups,
    resampled_means,
    standard_error,
    t_interval,
    welch,
)

RESAMPLES = 10_000
"""Number of resamples of a bootstrap."""
LEVEL = 0.95
"""Level of intervals."""
FEWEST_SEEDS = 3
"""Seeds that each side needs before two designs are said to differ."""

DIFFERS = "differs"
NOT_TOLD_APART = "cannot be told apart"
TOO_FEW_SEEDS = "too few seeds to tell"
NOTHING_MEASURED = "nothing was measured"
AGREES = "agrees"


@dataclass(frozen=True)
class Estimate:
    """A mean over seeds and trials with its interval."""

    mean: float
    """Mean of the seeds' means; NaN where nothing was measured."""
    low: float
    """Lower end of the interval; NaN where there is none."""
    high: float
    """Upper end of the interval; NaN where there is none."""
    standard_error: float
    """Standard error of the mean, corrected for few seeds."""
    seeds: int
    """Number of seeds with at least one value."""
    trials: int
    """Number of trials with a value."""
    missing: int
    """Trials without a value."""
    level: float = LEVEL
    """Level of the interval."""

    @property
    def speaks_of_seeds(self) -> bool:
        """Whether the interval covers the spread between trainings; false for a single seed."""
        return self.seeds > 1

    def against(self, value: float) -> str:
        """Compare the estimate with a number from elsewhere, such as the paper's.

        Args:
            value: the number.

        Returns:
            A verdict: inside the interval it agrees.
        """
        if not np.isfinite(self.mean):
            return NOTHING_MEASURED
        if self.seeds < FEWEST_SEEDS:
            return TOO_FEW_SEEDS
        return AGREES if self.low <= value <= self.high else DIFFERS

    def text(self, digits: int = 3) -> str:
        """Write mean and interval for a person, with the numbers of seeds and trials.

        Args:
            digits: significant digits.

        Returns:
            One line of text.
        """
        if not np.isfinite(self.mean):
            return f"not measured ({self.missing} trials)"
        base = (
            f"{self.seeds} seeds, {self.trials} trials"
            if self.speaks_of_seeds
            else f"1 seed, {self.trials} trials: says nothing about seeds"
        )
        lost = f", {self.missing} without a value" if self.missing else ""
        return (
            f"{self.mean:.{digits}g} [{self.low:.{digits}g}, {self.high:.{digits}g}] ({base}{lost})"
        )


@dataclass(frozen=True)
class Difference:
    """First less second, with its interval, effect sizes and verdict."""

    mean: float
    """Difference of the means."""
    low: float
    """Lower end of the interval."""
    high: float
    """Upper end of the interval."""
    relative: float
    """Difference over the second mean's magnitude [-]."""
    relative_low: float
    """Lower end of the interval over the second mean's magnitude [-]."""
    relative_high: float
    """Upper end of the interval over the second mean's magnitude [-]."""
    hedges_g: float
    """Difference over the pooled standard deviation, corrected for few values [-]."""
    cliffs_delta: float
    """Share of pairs in which the first is larger, less that in which it is smaller, -1 .. 1."""
    unit: str
    """What the effect sizes count: means of `seeds`, or `trials` where a side has one seed."""
    paired: bool
    """Whether seeds were compared one to one."""
    verdict: str
    """`DIFFERS`, `NOT_TOLD_APART`, `TOO_FEW_SEEDS` or `NOTHING_MEASURED`."""
    level: float = LEVEL
    """Level of the interval."""


def estimate(
    groups: Groups, *, level: float = LEVEL, resamples: int = RESAMPLES, seed: int = 0
) -> Estimate:
    """Estimate the mean over seeds and trials with its interval.

    Args:
        groups: one array a seed; NaN where nothing could be measured.
        level: of the interval.
        resamples: of the bootstrap.
        seed: of its random numbers.

    Returns:
        The mean, its interval, and the numbers of seeds and trials that it rests on.

    Raises:
        InputError: no group, or a level or number of resamples that makes no sense.
    """
    _check(level, resamples)
    seeds_measured, missing = measured_groups(groups)
    trials = sum(len(flat_seed(g)) for g in seeds_measured)
    if not seeds_measured:
        return Estimate(np.nan, np.nan, np.nan, np.nan, 0, 0, missing, level)
    mean = float(np.mean([mean_over_seeds(g) for g in seeds_measured]))
    error, freedom = standard_error(
        seeds_measured, resampled_means(seeds_measured, resamples, np.random.default_rng(seed))
    )
    low, high = t_interval(mean, error, freedom, level)
    return Estimate(mean, low, high, error, len(seeds_measured), trials, missing, level)


def share(
    groups: Groups, *, level: float = LEVEL, resamples: int = RESAMPLES, seed: int = 0
) -> Estimate:
    """Estimate the share of trials in which something happened, such as a fall.

    The interval is that of `estimate`, at least as wide as Clopper and Pearson's of all trials
    together (which is not empty where it never happened), and inside 0 .. 1.

    Args:
        groups: one array of true and false a seed.
        level: of the interval.
        resamples: of the bootstrap.
        seed: of its random numbers.

    Returns:
        The share, its interval, and the numbers of seeds and trials that it rests on.
    """
    from scipy.stats import beta

    interval = estimate(groups, level=level, resamples=resamples, seed=seed)
    if not interval.trials:
        return interval
    count, happened = (
        interval.trials,
        round(sum(float(flat_seed(g).sum()) for g in measured_groups(groups)[0])),
    )
    tail = (1 - level) / 2
    low = 0.0 if happened == 0 else float(beta.ppf(tail, happened, count - happened + 1))
    high = 1.0 if happened == count else float(beta.ppf(1 - tail, happened + 1, count - happened))
    if np.isfinite(interval.low):
        low, high = min(low, max(interval.low, 0.0)), max(high, min(interval.high, 1.0))
    return Estimate(
        interval.mean,
        low,
        high,
        interval.standard_error,
        interval.seeds,
        count,
        interval.missing,
        level,
    )


def difference(
    first: Groups,
    second: Groups,
    *,
    paired: bool = False,
    level: float = LEVEL,
    resamples: int = RESAMPLES,
    seed: int = 0,
) -> Difference:
    """Difference of two means, first less second, with its interval, effect sizes and verdict.

    Args:
        first: one array a seed.
        second: one array a seed.
        paired: compare seeds one to one, in order (seeds that share their random numbers); else as
            two independent sets.
        level: of the interval.
        resamples: of the bootstrap.
        seed: of its random numbers.

    Returns:
        The difference. Its verdict needs at least `FEWEST_SEEDS` seeds on each side.

    Raises:
        InputError: no group, unequal numbers of seeds when paired, or a level or number of
            resamples that makes no sense.
    """
    _check(level, resamples)
    if paired:
        first, second = paired_groups(first, second)
    (a, _), (b, _) = measured_groups(first), measured_groups(second)
    if not a or not b:
        nan = np.nan
        return Difference(
            nan, nan, nan, nan, nan, nan, nan, nan, "", paired, NOTHING_MEASURED, level
        )
    base = float(np.mean([mean_over_seeds(g) for g in b]))
    mean = float(np.mean([mean_over_seeds(g) for g in a])) - base
    rng = np.random.default_rng(seed)
    if paired:
        error, freedom = paired_error(a, b, resamples, rng)
    else:
        (error_a, freedom_a), (error_b, freedom_b) = (
            standard_error(g, resampled_means(g, resamples, rng)) for g in (a, b)
        )
        error = float(np.hypot(error_a, error_b))
        freedom = welch(error_a, freedom_a, error_b, freedom_b)
    low, high = t_interval(mean, error, freedom, level)
    by_seed = len(a) > 1 and len(b) > 1
    x, y = (
        np.array([mean_over_seeds(g) for g in s])
        if by_seed
        else np.concatenate([flat_seed(g) for g in s])
        for s in (a, b)
    )
    scale = abs(base) if base else np.nan
    return Difference(
        mean,
        low,
        high,
        mean / scale,
        low / scale,
        high / scale,
        hedges_g(x, y),
        cliffs_delta(x, y),
        "seeds" if by_seed else "trials",
        paired,
        _verdict(low, high, min(len(a), len(b))),
        level,
    )


def _check(level: float, resamples: int) -> None:
    if not 0 < level < 1:
        raise InputError(
            "statistics", "level", level, "expects a number between 0 and 1, such as 0.95"
        )
    if resamples < 100:
        raise InputError("statistics", "resamples", resamples, "expects at least 100")


def _verdict(low: float, high: float, seeds: int) -> str:
    if seeds < FEWEST_SEEDS or not np.isfinite(low):
        return TOO_FEW_SEEDS
    return DIFFERS if low > 0 or high < 0 else NOT_TOLD_APART
