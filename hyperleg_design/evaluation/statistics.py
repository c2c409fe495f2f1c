"""What measured numbers say: intervals over seeds and trials, differences, effect sizes and verdicts.

A training seed is one draw of a policy; the trials of its policies are draws of starting states. A design is judged by
several seeds, so a group of values is a sequence with one array a seed, and a seed's trials (of all its late checkpoints)
are that array. Values that could not be measured (no arrival, so no time) are NaN: they are left out of means, counted in
`missing`, and never silently dropped.

Intervals rest on a hierarchical bootstrap: seeds are drawn with replacement, then trials within each drawn seed. With few
seeds the bootstrap's spread is too small by sqrt((k - 1) / k) and percentiles cover too little, so its standard error is
multiplied by sqrt(k / (k - 1)) and by Student's t with k - 1 degrees of freedom (Hesterberg, 2015, on both corrections).
Drawing trials anew counts their spread twice, in the seeds' means and within them, so intervals are wider than they need
be where trials of one seed differ more than seeds do, and never narrower.
One seed alone gives an interval over its trials that cannot speak about seeds, and says so.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError

RESAMPLES = 10_000
"""Of a bootstrap."""
LEVEL = 0.95
"""Of intervals."""
FEWEST_SEEDS = 3
"""Seeds that each side needs before a difference is told."""

DIFFERS = "differs"
NOT_TOLD_APART = "cannot be told apart"
TOO_FEW_SEEDS = "too few seeds to tell"
NOTHING_MEASURED = "nothing was measured"
AGREES = "agrees"

_DRAWS = 2_000_000
"""Numbers drawn at once, so that memory stays small."""

Groups = Sequence[Any]
"""One array of values a seed."""


@dataclass(frozen=True)
class Estimate:
    """A mean over seeds and trials with its interval."""

    mean: float
    """Of the seeds' means; NaN where nothing was measured."""
    low: float
    """Lower end of the interval; NaN where there is none."""
    high: float
    """Upper end of the interval; NaN where there is none."""
    standard_error: float
    """Of the mean, corrected for few seeds."""
    seeds: int
    """With at least one value."""
    trials: int
    """With a value."""
    missing: int
    """Trials without a value."""
    level: float = LEVEL
    """Of the interval."""

    @property
    def speaks_of_seeds(self) -> bool:
        """Whether the interval covers the spread between trainings; false for a single seed."""
        return self.seeds > 1

    def against(self, value: float) -> str:
        """Verdict on a number from elsewhere, such as the paper's: inside the interval it agrees."""
        if not np.isfinite(self.mean):
            return NOTHING_MEASURED
        if not self.speaks_of_seeds:
            return TOO_FEW_SEEDS
        return AGREES if self.low <= value <= self.high else DIFFERS

    def text(self, digits: int = 3) -> str:
        """Mean and interval for a person, with what it rests on."""
        if not np.isfinite(self.mean):
            return f"not measured ({self.missing} trials)"
        base = f"{self.seeds} seeds, {self.trials} trials" if self.speaks_of_seeds else f"1 seed, {self.trials} trials: says nothing about seeds"
        lost = f", {self.missing} without a value" if self.missing else ""
        return f"{self.mean:.{digits}g} [{self.low:.{digits}g}, {self.high:.{digits}g}] ({base}{lost})"


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
    """Of the interval."""


def estimate(groups: Groups, *, level: float = LEVEL, resamples: int = RESAMPLES, seed: int = 0) -> Estimate:
    """Mean over seeds and trials.

    Args:
        groups: one array a seed; NaN where nothing could be measured.
        level: of the interval.
        resamples: of the bootstrap.
        seed: of its random numbers.

    Raises:
        InputError: no group, or a level or number of resamples that makes no sense.
    """
    _check(level, resamples)
    kept, missing = _measured(groups)
    trials = sum(len(g) for g in kept)
    if not kept:
        return Estimate(np.nan, np.nan, np.nan, np.nan, 0, 0, missing, level)
    mean = float(np.mean([g.mean() for g in kept]))
    error, freedom = _standard_error(kept, _means(kept, resamples, np.random.default_rng(seed)))
    low, high = _interval(mean, error, freedom, level)
    return Estimate(mean, low, high, error, len(kept), trials, missing, level)


def share(groups: Groups, *, level: float = LEVEL, resamples: int = RESAMPLES, seed: int = 0) -> Estimate:
    """Share of trials in which something happened, such as a fall.

    The interval is that of `estimate`, at least as wide as Clopper and Pearson's of all trials together (which is not
    empty where it never happened), and inside 0 .. 1.

    Args:
        groups: one array of true and false a seed.
        level: of the interval.
        resamples: of the bootstrap.
        seed: of its random numbers.
    """
    from scipy.stats import beta

    found = estimate([np.asarray(g, float) for g in groups], level=level, resamples=resamples, seed=seed)
    if not found.trials:
        return found
    count, happened = found.trials, round(sum(float(np.nansum(np.asarray(g, float))) for g in groups))
    tail = (1 - level) / 2
    low = 0.0 if happened == 0 else float(beta.ppf(tail, happened, count - happened + 1))
    high = 1.0 if happened == count else float(beta.ppf(1 - tail, happened + 1, count - happened))
    if np.isfinite(found.low):
        low, high = min(low, max(found.low, 0.0)), max(high, min(found.high, 1.0))
    return Estimate(found.mean, low, high, found.standard_error, found.seeds, count, found.missing, level)


def difference(first: Groups, second: Groups, *, paired: bool = False, level: float = LEVEL, resamples: int = RESAMPLES, seed: int = 0) -> Difference:
    """First less second.

    Args:
        first: one array a seed.
        second: one array a seed.
        paired: compare seeds one to one, in order (seeds that share their random numbers); else as two independent sets.
        level: of the interval.
        resamples: of the bootstrap.
        seed: of its random numbers.

    Raises:
        InputError: no group, unequal numbers of seeds when paired, or a level or number of resamples that makes no sense.
    """
    _check(level, resamples)
    if paired:
        first, second = _pairs(first, second)
    (a, _), (b, _) = _measured(first), _measured(second)
    if not a or not b:
        nan = np.nan
        return Difference(nan, nan, nan, nan, nan, nan, nan, nan, "", paired, NOTHING_MEASURED, level)
    base = float(np.mean([g.mean() for g in b]))
    mean = float(np.mean([g.mean() for g in a])) - base
    rng = np.random.default_rng(seed)
    if paired:
        error, freedom = _paired_error(a, b, resamples, rng)
    else:
        (error_a, freedom_a), (error_b, freedom_b) = (_standard_error(g, _means(g, resamples, rng)) for g in (a, b))
        error = float(np.hypot(error_a, error_b))
        freedom = _welch(error_a, freedom_a, error_b, freedom_b)
    low, high = _interval(mean, error, freedom, level)
    by_seed = len(a) > 1 and len(b) > 1
    x, y = (np.array([g.mean() for g in s]) if by_seed else np.concatenate(s) for s in (a, b))
    scale = abs(base) if base else np.nan
    return Difference(
        mean, low, high, mean / scale, low / scale, high / scale, hedges_g(x, y), cliffs_delta(x, y),
        "seeds" if by_seed else "trials", paired, _verdict(low, high, min(len(a), len(b))), level,
    )  # fmt: skip


def hedges_g(first: Any, second: Any) -> float:
    """Difference of means over the pooled standard deviation, times 1 - 3 / (4 (n + m) - 9); NaN without spread or with too few.

    Args:
        first: `(n,)`
        second: `(m,)`
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
    """Share of pairs with first > second less that with first < second, `(n,)`, `(m,)` -> -1 .. 1."""
    x, y = np.asarray(first, float), np.asarray(second, float)
    return float(np.mean(np.sign(x[:, None] - y[None, :])))


def _check(level: float, resamples: int) -> None:
    if not 0 < level < 1:
        raise InputError("statistics", "level", level, "expects a number between 0 and 1, such as 0.95")
    if resamples < 100:
        raise InputError("statistics", "resamples", resamples, "expects at least 100")


def _measured(groups: Groups) -> tuple[list[np.ndarray], int]:
    """Values of each seed that has any, and how many values are missing."""
    arrays = [np.atleast_1d(np.asarray(g, float)) for g in groups]
    if not arrays or any(a.ndim != 1 for a in arrays):
        raise InputError("statistics", "groups", [list(a.shape) for a in arrays], "expects one array of values a seed")
    if any(np.isinf(a).any() for a in arrays):
        raise InputError("statistics", "groups", "infinite", "expects finite values, or NaN where nothing could be measured")
    kept = [a[~np.isnan(a)] for a in arrays]
    return [k for k in kept if len(k)], sum(len(a) for a in arrays) - sum(len(k) for k in kept)


def _pairs(first: Groups, second: Groups) -> tuple[list[Any], list[Any]]:
    if len(first) != len(second):
        raise InputError("statistics", "paired", [len(first), len(second)], "needs as many seeds on both sides")
    both = [(x, y) for x, y in zip(first, second, strict=True) if np.isfinite(np.asarray(x, float)).any() and np.isfinite(np.asarray(y, float)).any()]
    return [x for x, _ in both] or [[np.nan]], [y for _, y in both] or [[np.nan]]


def _means(groups: list[np.ndarray], resamples: int, rng: np.random.Generator) -> np.ndarray:
    """Means of hierarchical resamples, `(resamples,)`: seeds with replacement, then trials of each."""
    return _drawn_means(groups, rng.integers(len(groups), size=(resamples, len(groups))), rng)


def _drawn_means(groups: list[np.ndarray], chosen: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Means over chosen seeds `(resamples, places)` of their trials drawn with replacement, `(resamples,)`."""
    lengths = np.array([len(g) for g in groups])
    values = np.zeros((len(groups), lengths.max()))
    for row, group in zip(values, groups, strict=True):
        row[: len(group)] = group
    found = np.empty(len(chosen))
    at_once = max(1, _DRAWS // (chosen.shape[1] * values.shape[1]))
    for begin in range(0, len(chosen), at_once):
        seeds = chosen[begin : begin + at_once]
        length = lengths[seeds][..., None]
        trials = (rng.random((*seeds.shape, values.shape[1])) * length).astype(int)
        drawn = values[seeds[..., None], trials]
        drawn[np.arange(values.shape[1]) >= length] = 0.0  # of shorter groups, drawn for nothing
        found[begin : begin + at_once] = (drawn.sum(-1) / length[..., 0]).mean(-1)
    return found


def _standard_error(groups: list[np.ndarray], means: np.ndarray) -> tuple[float, int]:
    """Corrected for few seeds (few trials where there is one seed), and degrees of freedom."""
    units = len(groups) if len(groups) > 1 else len(groups[0])
    return (float(means.std() * np.sqrt(units / (units - 1))), units - 1) if units > 1 else (np.nan, 0)


def _paired_error(a: list[np.ndarray], b: list[np.ndarray], resamples: int, rng: np.random.Generator) -> tuple[float, int]:
    """Of the mean of the seeds' differences: seeds are drawn together, trials of each side apart."""
    seeds = len(a)
    if seeds == 1:
        error_a, error_b = (_standard_error(g, _means(g, resamples, rng)) for g in (a, b))
        return float(np.hypot(error_a[0], error_b[0])), _welch(*error_a, *error_b)
    chosen = rng.integers(seeds, size=(resamples, seeds))
    found = _drawn_means(a, chosen, rng) - _drawn_means(b, chosen, rng)
    return float(found.std() * np.sqrt(seeds / (seeds - 1))), seeds - 1


def _welch(error_a: float, freedom_a: int, error_b: float, freedom_b: int) -> int:
    """Degrees of freedom of a difference (Welch and Satterthwaite), rounded down."""
    if not freedom_a or not freedom_b:
        return 0
    if error_a == 0 and error_b == 0:
        return freedom_a + freedom_b
    return max(1, int((error_a**2 + error_b**2) ** 2 / (error_a**4 / freedom_a + error_b**4 / freedom_b)))


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
