"""Discrepancy columns in the directions that the samples show."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import block_diag


def rotated(
    white: Sequence[np.ndarray], known: int, steady: int, truncation: float
) -> tuple[list[np.ndarray], int, int]:
    """Turn the columns of a channel, and leave out directions that its samples hardly show.

    The first `known` ones, whose deviation is known, those up to `steady`, which are the same in
    all sessions, too, and the others are turned among themselves. All of a part have the same
    prior, which no rotation changes.

    Args:
        white: by cell, columns over the noise, and the residual last `(k + 1, samples)`.
        known: number of columns whose deviation is known.
        steady: number of columns that are the same in all sessions, those included.
        truncation: least change of the residuals that counts, see `DiscrepancyRules`.

    Returns:
        By cell, the turned columns and the residual, and how many of the columns are known and
        steady. One of those that are not is left at least.
    """
    total = sum((cell[:-1] @ cell[:-1].T for cell in white), np.zeros(()))
    turns = []
    for part in (slice(known), slice(known, steady), slice(steady, None)):
        values, axes = np.linalg.eigh(total[part, part])
        shown = values > truncation
        shown[-1:] |= part.stop is None
        turns.append(axes[:, shown])
    turn = block_diag(*turns).T
    turned = [np.concatenate([turn @ cell[:-1], cell[-1:]]) for cell in white]
    known, more = turns[0].shape[1], turns[1].shape[1]
    return turned, known, known + more
