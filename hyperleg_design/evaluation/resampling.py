"""Resampling of measured values, seeds first, then trials of each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError

_DRAWS = 2_000_000
"""Numbers drawn at once, so that memory stays small."""
Groups = Sequence[Any]
"""One array of values a seed, or one list of arrays, an array a checkpoint."""
Seed = list[np.ndarray]
"""Measured values of a seed, an array a checkpoint."""


def _checkpoints(group: Any) -> Seed:
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


def flat_seed(seed: Seed) -> np.ndarray:
    """Collect all values of a seed.

    Args:
        seed: an array a checkpoint.

    Returns:
        Its values, `(k,)`.
    """
    return np.concatenate(seed)


def mean_over_seeds(seed: Seed) -> float:
    """Compute the mean of the checkpoints' means of one seed.

    Args:
        seed: an array a checkpoint.

    Returns:
        The mean.
    """
    return float(np.mean([values.mean() for values in seed]))


def measured_groups(groups: Groups) -> tuple[list[Seed], int]:
    """Leave out values, checkpoints and seeds that were not measured.

    Args:
        groups: values of each seed.

    Returns:
        Values of each seed that has any, without empty checkpoints, and how many are missing.

    Raises:
        InputError: no seed, a value that is infinite, or more than one axis.
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
    return [
        checkpoints
        for checkpoints in ([a for a in seed if len(a)] for seed in measured)
        if checkpoints
    ], missing


def paired_groups(first: Groups, second: Groups) -> tuple[list[Any], list[Any]]:
    """Keep the seeds of which both sides measured something.

    Args:
        first: values of each seed.
        second: values of the same seeds on the other side.

    Returns:
        The seeds of either side; one without a value where nothing was measured.

    Raises:
        InputError: not as many seeds on both sides.
    """
    if len(first) != len(second):
        raise InputError(
            "statistics", "paired", [len(first), len(second)], "needs as many seeds on both sides"
        )
    both = [
        (x, y)
        for x, y in zip(first, second, strict=True)
        if all(np.isfinite(flat_seed(_checkpoints(g))).any() for g in (x, y))
    ]
    return [x for x, _ in both] or [[np.nan]], [y for _, y in both] or [[np.nan]]


def resampled_means(groups: Groups, resamples: int, rng: np.random.Generator) -> np.ndarray:
    """Draw means of hierarchical resamples: seeds with replacement, then checkpoints of each, then
    trials of each.

    Args:
        groups: values of each seed.
        resamples: how many to draw.
        rng: source of randomness.

    Returns:
        The means, `(resamples,)`.
    """
    seeds = [_checkpoints(g) for g in groups]
    return _drawn_means(seeds, rng.integers(len(seeds), size=(resamples, len(seeds))), rng)


def _drawn_means(groups: list[Seed], chosen: np.ndarray, rng: np.random.Generator) -> np.ndarray:
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


def standard_error(groups: list[Seed], means: np.ndarray) -> tuple[float, int]:
    """Compute a standard error that is corrected for few seeds, or few values of one seed.

    Args:
        groups: measured values of each seed.
        means: of the resamples.

    Returns:
        The standard error, and its degrees of freedom.
    """
    units = next(
        n
        for n in (len(groups), len(groups[0]), len(groups[0][0]))
        if n > 1 or n == len(groups[0][0])
    )
    return (
        (float(means.std() * np.sqrt(units / (units - 1))), units - 1) if units > 1 else (np.nan, 0)
    )


def paired_error(
    a: list[Seed], b: list[Seed], resamples: int, rng: np.random.Generator
) -> tuple[float, int]:
    """Compute the standard error of the mean of the seeds' differences.

    Seeds are drawn together, trials of each side independently.

    Args:
        a: measured values of each seed on one side.
        b: those on the other.
        resamples: how many to draw.
        rng: source of randomness.

    Returns:
        The standard error, and its degrees of freedom.
    """
    seeds = len(a)
    if seeds == 1:
        error_a, error_b = (standard_error(g, resampled_means(g, resamples, rng)) for g in (a, b))
        return float(np.hypot(error_a[0], error_b[0])), welch(*error_a, *error_b)
    chosen = rng.integers(seeds, size=(resamples, seeds))
    differences = _drawn_means(a, chosen, rng) - _drawn_means(b, chosen, rng)
    return float(differences.std() * np.sqrt(seeds / (seeds - 1))), seeds - 1


def welch(error_a: float, freedom_a: int, error_b: float, freedom_b: int) -> int:
    """Compute the degrees of freedom of a difference (Welch and Satterthwaite), rounded down.

    Args:
        error_a: standard error of one side.
        freedom_a: its degrees of freedom.
        error_b: standard error of the other.
        freedom_b: its degrees of freedom.

    Returns:
        The degrees of freedom; 0 where a side has none.
    """
    if not freedom_a or not freedom_b:
        return 0
    if error_a == 0 and error_b == 0:
        return freedom_a + freedom_b
    return max(
        1, int((error_a**2 + error_b**2) ** 2 / (error_a**4 / freedom_a + error_b**4 / freedom_b))
    )


def t_interval(mean: float, error: float, freedom: int, level: float) -> tuple[float, float]:
    """Compute the interval of Student's t around a mean.

    Args:
        mean: its middle.
        error: standard error.
        freedom: degrees of freedom.
        level: of the interval, 0 to 1.

    Returns:
        Lower and upper end; NaN where the error is not known.
    """
    from scipy.stats import t

    if not freedom or not np.isfinite(error):
        return np.nan, np.nan
    reach = float(t.ppf((1 + level) / 2, freedom)) * error
    return mean - reach, mean + reach
