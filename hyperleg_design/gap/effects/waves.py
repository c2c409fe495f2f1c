"""Waves that explain a residual: which of many orders fit best."""

from __future__ import annotations

import numpy as np

RIDGE = 1e-4
"""Mean square of a wave that is added, so that waves which nothing shows stay small [-]."""


def fitted_waves(
    wanted: np.ndarray,
    angle: np.ndarray,
    orders: np.ndarray,
    beside: np.ndarray,
    factor: np.ndarray | float = 1.0,
) -> tuple[np.ndarray, np.ndarray]:
    """Fit factor * (c cos(order * angle) + s sin(order * angle)) of each order alone.

    Args:
        wanted: what they are to explain `(t,)`.
        angle: `(t,)` [rad].
        orders: `(o,)`.
        beside: what is taken out of waves and `wanted` alike, orthonormal `(t, b)`.
        factor: of the waves `(t,)`.

    Returns:
        What each explains, a sum of squares `(o,)`, and its c and s `(o, 2)`.
    """

    def alone(rows: np.ndarray) -> np.ndarray:
        return np.asarray(rows - beside @ (beside.T @ rows))

    wanted = alone(wanted)
    size = float(np.mean(np.square(np.broadcast_to(factor, wanted.shape)))) or 1.0
    gains, amplitudes = np.empty(len(orders)), np.empty((len(orders), 2))
    for row, order in enumerate(orders):
        wave = np.stack([np.cos(order * angle), np.sin(order * angle)], -1)
        wave = alone(wave * np.reshape(factor, (-1, 1)))
        gram = wave.T @ wave
        gram[np.diag_indices(2)] += RIDGE * size * len(wanted)
        right = wave.T @ wanted
        amplitudes[row] = np.linalg.solve(gram, right)
        gains[row] = right @ amplitudes[row]
    return gains, amplitudes


def peaks(gains: np.ndarray, count: int) -> np.ndarray:
    """Where gains `(o,)` are larger than their neighbours, the largest first.

    Args:
        gains: by order.
        count: most that are returned.

    Returns:
        Indices, `count` at most.
    """
    padded = np.concatenate([[-np.inf], gains, [-np.inf]])
    summits = np.flatnonzero((padded[1:-1] >= padded[:-2]) & (padded[1:-1] >= padded[2:]))
    return summits[np.argsort(-gains[summits], kind="stable")[:count]]
