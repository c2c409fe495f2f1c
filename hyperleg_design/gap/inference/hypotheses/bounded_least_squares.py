"""Least squares within bounds, from normal equations."""

from __future__ import annotations

import numpy as np

SINGULAR = 1e-13
"""Least eigenvalue, over the diagonal, of normal equations that are solved within bounds: less is
rounding."""
TURNS = 8
"""Most guesses of which parameters lie at their bounds."""


def within_bounds(
    matrix: np.ndarray, right: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    """Minimise x^T A x / 2 - b^T x with low <= x <= high: linear least squares within bounds.

    Args:
        matrix: A of the normal equations A x = b, positive definite `(k, k)`.
        right: their right side b `(k,)`.
        low: lower bounds; where equal to `high`, the parameter is fixed `(k,)`.
        high: upper bounds `(k,)`.

    Returns:
        The minimum x `(k,)`.
    """
    free = low < high
    if free.all():
        phi = np.linalg.solve(matrix, right)
        return phi if ((phi >= low) & (phi <= high)).all() else _within(matrix, right, low, high)
    phi = np.where(free, 0.0, low)
    if free.any():
        own, others = np.flatnonzero(free), np.flatnonzero(~free)
        inner = matrix[own[:, None], own]
        rest = right[own] - matrix[own[:, None], others] @ phi[others]
        inner_phi = np.linalg.solve(inner, rest)
        if (inner_phi < low[own]).any() or (inner_phi > high[own]).any():
            inner_phi = _within(inner, rest, low[own], high[own])
        phi[own] = inner_phi
    return phi


def _within(matrix: np.ndarray, right: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """The same where no parameter is fixed, by an active set: guess which parameters lie at their
    bounds, solve for the others, and correct the guess by the signs of the slopes. Where `TURNS`
    guesses do not settle, `lsq_linear` of SciPy decides.
    """
    if len(right) == 1:
        return np.clip(right / matrix[0], low, high)
    below = above = np.zeros(len(right), bool)
    for _ in range(TURNS):
        held = below | above
        phi, free = np.where(below, low, high), ~held
        if free.any():
            own, others = np.flatnonzero(free), np.flatnonzero(held)
            rest = right[own] - matrix[own[:, None], others] @ phi[others]
            phi[own] = np.linalg.solve(matrix[own[:, None], own], rest)
        slope = right - matrix @ phi
        before = below, above
        below = (free & (phi < low)) | (below & (slope < 0))
        above = (free & (phi > high)) | (above & (slope > 0))
        if (below == before[0]).all() and (above == before[1]).all():
            return phi
    return _by_least_squares(matrix, right, low, high)


def _by_least_squares(
    matrix: np.ndarray, right: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    """The same by SciPy's bounded-variable least squares on a square root of the matrix."""
    from scipy.optimize import lsq_linear

    size = np.sqrt(np.diag(matrix))
    square, axes = np.linalg.eigh(matrix / np.outer(size, size))
    root = np.sqrt(np.maximum(square, SINGULAR))
    wanted, bounds = axes.T @ (right / size) / root, (low * size, high * size)
    solution = lsq_linear(root[:, None] * axes.T, wanted, bounds, method="bvls")
    inside = np.clip(solution.x / size, low, high)
    return np.where(solution.active_mask < 0, low, np.where(solution.active_mask > 0, high, inside))
