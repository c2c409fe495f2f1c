"""Waves that explain a residual: which of many orders fit best."""

from __future__ import annotations

import numpy as np

RIDGE = 1e-4
"""Mean square of a wave that is added, so that waves which nothing shows stay small [-]."""
BLOCK = 16
"""Orders that are computed together."""


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
    wanted = wanted - beside @ (beside.T @ wanted)
    factor = np.broadcast_to(factor, wanted.shape)
    ridge = RIDGE * (float(np.mean(np.square(factor))) or 1.0) * len(wanted) * np.eye(2)
    gains, amplitudes = np.empty(len(orders)), np.empty((len(orders), 2))
    wave, turn, last, step = factor.astype(complex), np.ones(1), 0.0, 0.0
    for first in range(0, len(orders), BLOCK):
        some = orders[first : first + BLOCK]
        waves = np.empty((2, len(some), len(wanted)))
        for row, order in enumerate(some):
            if order - last != step:
                step = order - last
                turn = np.exp(1j * step * angle)
            wave, last = wave * turn, order
            waves[:, row] = wave.real, wave.imag
        taken, right = waves @ beside, (waves @ wanted).T
        gram = np.einsum("iot,jot->oij", waves, waves) - np.einsum("iob,job->oij", taken, taken)
        sizes = np.linalg.solve(gram + ridge, right[..., None])[..., 0]
        amplitudes[first : first + BLOCK] = sizes
        gains[first : first + BLOCK] = np.sum(right * sizes, -1)
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
