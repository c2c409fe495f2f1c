"""Discrepancy columns in the directions that the samples show."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import block_diag


def rotated(
    white: Sequence[np.ndarray], steady: int, truncation: float
) -> tuple[list[np.ndarray], int]:
    """Turn the columns of a channel, and leave out directions that its samples hardly show.

    The first `steady` ones, which are the same in all sessions, and the others are turned among
    themselves. All have the same prior, which no rotation changes.

    Args:
        white: by cell, columns over the noise, and the residual last `(k + 1, samples)`.
        steady: number of columns that are the same in all sessions.
        truncation: least change of the residuals that counts, see `DiscrepancyRules`.

    Returns:
        By cell, the turned columns and the residual, and how many of the columns are steady. One of
        those that are not is left at least.
    """
    total = sum((cell[:-1] @ cell[:-1].T for cell in white), np.zeros(()))
    turns = []
    for part in (slice(steady), slice(steady, None)):
        values, axes = np.linalg.eigh(total[part, part])
        shown = values > truncation
        shown[-1:] |= part.stop is None
        turns.append(axes[:, shown])
    turn = block_diag(*turns).T
    return [np.concatenate([turn @ cell[:-1], cell[-1:]]) for cell in white], turns[0].shape[1]
