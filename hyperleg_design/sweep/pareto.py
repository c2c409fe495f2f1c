"""Designs that no other design beats in every objective."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

_BLOCK = 512
"""Candidates compared at a time: bounds memory at block x front x objectives."""


def nondominated(values: np.ndarray, better: Sequence[str]) -> np.ndarray:
    """Find the points that lie on the Pareto front.

    A point dominates another if it is at least as good in all objectives and better in one. Equal
    points do not dominate each other, so all of them stay. Points with a nan are never on the front
    and dominate nothing.

    Sorted lexicographically by cost, a point is dominated by earlier ones only; in two objectives a
    running minimum then decides (O(n log n)), in more each block is compared with the front so far.

    Args:
        values: objectives of each point, `(n, objectives)`.
        better: `low` or `high` for each objective.

    Returns:
        `(n,)`, True on the front.

    Raises:
        ValueError: shapes that do not fit, or a direction other than those.
    """
    values = np.asarray(values, float)
    if values.ndim != 2 or values.shape[1] != len(better) or not len(better):
        raise ValueError(
            f"values of shape {values.shape} do not fit {len(better)} objectives; expects (n, "
            f"objectives)"
        )
    if any(b not in ("low", "high") for b in better):
        raise ValueError(f"better = {list(better)}: expects low or high")
    front = np.zeros(len(values), dtype=bool)
    real = np.flatnonzero(~np.isnan(values).any(1))
    if not real.size:
        return front
    cost = values[real] * [1.0 if b == "low" else -1.0 for b in better]
    unique, inverse = np.unique(
        cost, axis=0, return_inverse=True
    )  # sorted lexicographically, ties joined
    on_front = _staircase(unique) if unique.shape[1] <= 2 else _blockwise(unique)
    front[real] = on_front[inverse.reshape(-1)]
    return front


def _staircase(cost: np.ndarray) -> np.ndarray:
    last = cost[:, -1]
    if cost.shape[1] == 1:
        return last == last[0]
    best_before = np.concatenate([[np.inf], np.minimum.accumulate(last)[:-1]])
    # the first point keeps even an infinite second cost: nothing comes before it
    return (last < best_before) | (np.arange(len(last)) == 0)


def _blockwise(cost: np.ndarray) -> np.ndarray:
    """The front of sorted, different points, one block at a time."""
    on_front = np.zeros(len(cost), dtype=bool)
    front = np.empty((0, cost.shape[1]))
    for start in range(0, len(cost), _BLOCK):
        block = cost[start : start + _BLOCK]
        alive = np.flatnonzero(~_beaten(block, front))
        # within the block; different points, so no worse everywhere means dominated
        rest = block[alive]
        no_worse = np.all(rest[None, :, :] <= rest[:, None, :], -1)
        np.fill_diagonal(no_worse, False)
        alive = alive[~no_worse.any(1)]
        on_front[start + alive] = True
        front = np.concatenate([front, block[alive]])
    return on_front


def _beaten(points: np.ndarray, front: np.ndarray) -> np.ndarray:
    """Find the points that some other point of the front equals or beats in every objective."""
    beaten = np.zeros(len(points), dtype=bool)
    for start in range(0, len(front), 4 * _BLOCK):
        part = front[start : start + 4 * _BLOCK]
        open_ = np.flatnonzero(~beaten)
        beaten[open_] = np.all(part[None, :, :] <= points[open_][:, None, :], -1).any(1)
    return beaten
