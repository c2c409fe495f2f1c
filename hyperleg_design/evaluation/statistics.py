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

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError

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

_DRAWS = 2_000_000
"""Numbers drawn at once, so that memory stays small."""

Groups = Sequence[Any]
"""One array of values a seed, or one list of arrays, an array a checkpoint."""
_Seed = list[np.ndarray]
"""Measured values of a seed, an array a checkpoint."""


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
    seeds_measured, missing = _measured(groups)
    trials = sum(len(_flat(g)) for g in seeds_measured)
    if not seeds_measured:
        return Estimate(np.nan, np.nan, np.nan, np.nan, 0, 0, missing, level)
    mean = float(np.mean([_mean(g) for g in seeds_measured]))
    error, freedom = _standard_error(
        seeds_measured, _means(seeds_measured, resamples, np.random.default_rng(seed))
    )
    low, high = _interval(mean, error, freedom, level)
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
        round(sum(float(_flat(g).sum()) for g in _measured(groups)[0])),
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
        first, second = _pairs(first, second)
    (a, _), (b, _) = _measured(first), _measured(second)
    if not a or not b:
        nan = np.nan
        return Difference(
            nan, nan, nan, nan, nan, nan, nan, nan, "", paired, NOTHING_MEASURED, level
        )
    base = float(np.mean([_mean(g) for g in b]))
    mean = float(np.mean([_mean(g) for g in a])) - base
    rng = np.random.default_rng(seed)
    if paired:
        error, freedom = _paired_error(a, b, resamples, rng)
    else:
        (error_a, freedom_a), (error_b, freedom_b) = (
            _standard_error(g, _means(g, resamples, rng)) for g in (a, b)
        )
        error = float(np.hypot(error_a, error_b))
        freedom = _welch(error_a, freedom_a, error_b, freedom_b)
    low, high = _interval(mean, error, freedom, level)
    by_seed = len(a) > 1 and len(b) > 1
    x, y = (
        np.array([_mean(g) for g in s]) if by_seed else np.concatenate([_flat(g) for g in s])
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


def hedges_g(first: Any, second: Any) -> float:
    """Compute Hedges' g, the difference of two means over their pooled standard deviation.

    It is corrected for few values by the factor 1 - 3 / (4 (n + m) - 9).

    Args:
        first: `(n,)`
        second: `(m,)`

    Returns:
        The effect size [-]; NaN without spread or with fewer than two values on a side.
    """
    x, y = np.asarray(first, float), np.asarray(second, float)
    freedom = len(x) + len(y) - 2
    if min(len(x), len(y)) < 2:
        return np.nan
    pooled = np.sqrt(((len(x) - 1) * x.var(ddof=1) + (len(y) - 1) * y.var(ddof=1)) / freedom)
    if pooled == 0:
        return np.nan
    return float((x.mean() - y.mean()) / pooled * (1 - 3 / (4 * freedom - 1)))


def cliffs_delta(first: Any, second: Any) -> float:
    """Compute Cliff's delta: the share of pairs with first > second minus that with first < second.

    Args:
        first: `(n,)`
        second: `(m,)`

    Returns:
        The effect size, -1 .. 1 [-].
    """
    x, y = np.asarray(first, float), np.asarray(second, float)
    return float(np.mean(np.sign(x[:, None] - y[None, :])))


def _check(level: float, resamples: int) -> None:
    if not 0 < level < 1:
        raise InputError(
            "statistics", "level", level, "expects a number between 0 and 1, such as 0.95"
        )
    if resamples < 100:
        raise InputError("statistics", "resamples", resamples, "expects at least 100")


def _checkpoints(group: Any) -> _Seed:
    """A seed's values, an array a checkpoint."""
    nested = (
        isinstance(group, list | tuple)
        and len(group) > 0
        and all(np.ndim(part) == 1 for part in group)
    )
    return (
        [np.asarray(part, float) for part in group]
        if nested
        else [np.atleast_1d(np.asarray(group, float))]
    )


def _flat(seed: _Seed) -> np.ndarray:
    """All values of a seed."""
    return np.concatenate(seed)


def _mean(seed: _Seed) -> float:
    """Mean of the checkpoints' means."""
    return float(np.mean([values.mean() for values in seed]))


def _measured(groups: Groups) -> tuple[list[_Seed], int]:
    """Values of each seed that has any, without empty checkpoints, and how many values are
    missing.
    """
    seeds = [_checkpoints(g) for g in groups]
    if not seeds or any(a.ndim != 1 for seed in seeds for a in seed):
        raise InputError(
            "statistics",
            "groups",
            [[list(a.shape) for a in s] for s in seeds],
            "expects one array of values a seed, or a list of them",
        )
    if any(np.isinf(a).any() for seed in seeds for a in seed):
        raise InputError(
            "statistics",
            "groups",
            "infinite",
            "expects finite values, or NaN where nothing could be measured",
        )
    measured = [[a[~np.isnan(a)] for a in seed] for seed in seeds]
    missing = sum(len(a) for seed in seeds for a in seed) - sum(
        len(a) for seed in measured for a in seed
    )
    return [found for found in ([a for a in seed if len(a)] for seed in measured) if found], missing


def _pairs(first: Groups, second: Groups) -> tuple[list[Any], list[Any]]:
    if len(first) != len(second):
        raise InputError(
            "statistics", "paired", [len(first), len(second)], "needs as many seeds on both sides"
        )
    both = [
        (x, y)
        for x, y in zip(first, second, strict=True)
        if all(np.isfinite(_flat(_checkpoints(g))).any() for g in (x, y))
    ]
    return [x for x, _ in both] or [[np.nan]], [y for _, y in both] or [[np.nan]]


def _means(groups: Groups, resamples: int, rng: np.random.Generator) -> np.ndarray:
    """Means of hierarchical resamples, `(resamples,)`: seeds with replacement, then checkpoints of
    each, then trials of each.
    """
    seeds = [_checkpoints(g) for g in groups]
    return _drawn_means(seeds, rng.integers(len(seeds), size=(resamples, len(seeds))), rng)


def _drawn_means(groups: list[_Seed], chosen: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Means over chosen seeds `(resamples, places)` of their checkpoints and trials drawn with
    replacement, `(resamples,)`.
    """
    counts = np.array([len(seed) for seed in groups])
    lengths = np.zeros((len(groups), counts.max()), int)
    for row, seed in zip(lengths, groups, strict=True):
        row[: len(seed)] = [len(values) for values in seed]
    table = np.zeros((*lengths.shape, lengths.max()))
    for block, seed in zip(table, groups, strict=True):
        for row, values in zip(block, seed, strict=False):
            row[: len(values)] = values
    resampled = np.empty(len(chosen))
    picked = (rng.random((*chosen.shape, table.shape[1])) * counts[chosen][..., None]).astype(int)
    at_once = max(1, _DRAWS // (chosen.shape[1] * table.shape[1] * table.shape[2]))
    for begin in range(0, len(chosen), at_once):
        seeds = chosen[begin : begin + at_once]
        count = counts[seeds][..., None]
        checkpoint = picked[begin : begin + at_once]
        length = lengths[seeds[..., None], checkpoint][..., None]
        trial = (rng.random((*checkpoint.shape, table.shape[2])) * length).astype(int)
        drawn = table[seeds[..., None, None], checkpoint[..., None], trial]
        drawn[np.arange(table.shape[2]) >= length] = (
            0.0  # of shorter checkpoints, drawn for nothing
        )
        means = drawn.sum(-1) / length[..., 0]
        means[np.arange(table.shape[1]) >= count] = 0.0  # likewise of seeds with fewer checkpoints
        resampled[begin : begin + at_once] = (means.sum(-1) / count[..., 0]).mean(-1)
    return resampled


def _standard_error(groups: list[_Seed], means: np.ndarray) -> tuple[float, int]:
    """Corrected for few seeds (few checkpoints or trials where there is one seed), and degrees of
    freedom.
    """
    units = next(
        n
        for n in (len(groups), len(groups[0]), len(groups[0][0]))
        if n > 1 or n == len(groups[0][0])
    )
    return (
        (float(means.std() * np.sqrt(units / (units - 1))), units - 1) if units > 1 else (np.nan, 0)
    )


def _paired_error(
    a: list[_Seed], b: list[_Seed], resamples: int, rng: np.random.Generator
) -> tuple[float, int]:
    """Standard error of the mean of the seeds' differences: seeds are drawn together, and trials of
    each side independently.
    """
    seeds = len(a)
    if seeds == 1:
        error_a, error_b = (_standard_error(g, _means(g, resamples, rng)) for g in (a, b))
        return float(np.hypot(error_a[0], error_b[0])), _welch(*error_a, *error_b)
    chosen = rng.integers(seeds, size=(resamples, seeds))
    differences = _drawn_means(a, chosen, rng) - _drawn_means(b, chosen, rng)
    return float(differences.std() * np.sqrt(seeds / (seeds - 1))), seeds - 1


def _welch(error_a: float, freedom_a: int, error_b: float, freedom_b: int) -> int:
    """Degrees of freedom of a difference (Welch and Satterthwaite), rounded down."""
    if not freedom_a or not freedom_b:
        return 0
    if error_a == 0 and error_b == 0:
        return freedom_a + freedom_b
    return max(
        1, int((error_a**2 + error_b**2) ** 2 / (error_a**4 / freedom_a + error_b**4 / freedom_b))
    )


def _interval(mean: float, error: float, freedom: int, level: float) -> tuple[float, float]:
    from scipy.stats import t

    if not freedom or not np.isfinite(error):
        return np.nan, np.nan
    reach = float(t.ppf((1 + level) / 2, freedom)) * error
    return mean - reach, mean + reach


def _verdict(low: float, high: float, seeds: int) -> str:
    if seeds < FEWEST_SEEDS or not np.isfinite(low):
        return TOO_FEW_SEEDS
    return DIFFERS if low > 0 or high < 0 else NOT_TOLD_APART
