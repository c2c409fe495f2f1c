"""Slopes and correlations between signals, by which a wrong unit or a swapped joint shows."""

from __future__ import annotations

import math

import numpy as np

DEGREES = 180 / math.pi


def fitted_slopes(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Fit y as a multiple of x, column by column.

    Args:
        x: `(t, n)`.
        y: `(t, n)`.

    Returns:
        Slopes of y over x, and their correlations, `(n,)` each; NaN where one of them stands still.
    """
    known = np.isfinite(x) & np.isfinite(y)
    count = np.maximum(known.sum(0), 1)
    x, y = np.where(known, x, 0.0), np.where(known, y, 0.0)
    x, y = np.where(known, x - x.sum(0) / count, 0.0), np.where(known, y - y.sum(0) / count, 0.0)
    xx, yy, xy = (x * x).sum(0), (y * y).sum(0), (x * y).sum(0)
    with np.errstate(divide="ignore", invalid="ignore"):
        slope, fit = xy / xx, xy / np.sqrt(xx * yy)
    fit = np.where((xx > 0) & (yy == 0), 0.0, fit)  # one stands still while the other moves
    return np.asarray(slope), np.asarray(np.where(known.sum(0) < 8, np.nan, fit))


def fitted_correlations(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Correlate each column of one signal with another signal.

    Args:
        x: `(t, n)`.
        y: `(t,)`.

    Returns:
        The correlations `(n,)`.
    """
    correlations = fitted_slopes(x, np.broadcast_to(y[:, None], x.shape))[1]
    return np.where(np.isfinite(correlations), correlations, -1.0)
