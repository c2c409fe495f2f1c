"""Causes, linearised, and least squares within bounds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.inference.endogenous import Factor
from hyperleg_design.gap.inference.shrinking import Shrinking

SINGULAR = 1e-13
"""Least eigenvalue, over the diagonal, of normal equations that are solved within bounds: less is
rounding."""
TURNS = 8
"""Guesses of which parameters lie at their bounds."""


@dataclass(frozen=True, eq=False)
class Cause:
    """One effect at one place, linearised at some values; its trace is `constant + columns phi`
    with phi = (values - nulls) / usual.
    """

    effect: str
    location: str
    values: np.ndarray
    """At which it is linearised `(k,)`."""
    nulls: np.ndarray
    usual: np.ndarray
    low: np.ndarray
    high: np.ndarray
    """Bounds `(k,)` each."""
    shape: np.ndarray
    """Parameters that only shape `(k,)` of bool."""
    columns: np.ndarray
    """`(k, S)` in the residual's unit."""
    constant: np.ndarray
    """`(S,)`; 0 where the trace is linear."""
    linear: bool
    declared: float = 0.0
    """Payload that the logs declare at its place [kg]."""
    factors: tuple[Factor | Shrinking, ...] = ()
    """How it scales the torques that the residual trusts, or noise."""
    unseen: bool = False
    """Whether no log has the signal that drives it, a voltage or a temperature, so that it is
    modelled."""
    beyond: int = 1
    """Joints in a row that its link carries, see `Mechanism.beyond`."""
    standing: bool = False
    """Whether it acts in all logs, reference logs included, not in those under test alone."""
    before: tuple[float, ...] = ()
    """Values of the causes that it acts on, where it is linearised beside any."""

    @property
    def name(self) -> tuple[str, str]:
        """Effect and location."""
        return self.effect, self.location

    @property
    def phi(self) -> np.ndarray:
        """`values` in usual sizes from the nulls."""
        return np.asarray((self.values - self.nulls) / self.usual)

    def trace(self, phi: np.ndarray) -> np.ndarray:
        """Its trace at some phi `(k,)`, in the residual's unit `(S,)`."""
        return np.asarray(phi @ self.columns + (0.0 if self.linear else self.constant))


def within_bounds(
    matrix: np.ndarray, right: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    """Least squares within bounds.

    Args:
        matrix: of the normal equations `(k, k)`.
        right: of them `(k,)`.
        low: bounds `(k,)`.
        high: the same.

    Returns:
        Where x matrix x / 2 - right x is least with low < x < high `(k,)`.
    """
    free = low < high
    if free.all():
        phi = np.linalg.solve(matrix, right)
        return phi if ((phi >= low) & (phi <= high)).all() else _within(matrix, right, low, high)
    phi = np.where(free, 0.0, low)
    if free.any():
        inner = matrix[np.ix_(free, free)]
        rest = right[free] - matrix[np.ix_(free, ~free)] @ phi[~free]
        found = np.linalg.solve(inner, rest)
        if (found < low[free]).any() or (found > high[free]).any():
            found = _within(inner, rest, low[free], high[free])
        phi[free] = found
    return phi


def _within(matrix: np.ndarray, right: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Where x matrix x / 2 - right x is least with low < x < high, all `(k,)`: by the parameters
    that lie at their bounds, which a few solutions mostly tell, else by `lsq_linear`.
    """
    if len(right) == 1:
        return np.clip(right / matrix[0], low, high)
    below = above = np.zeros(len(right), bool)
    for _ in range(TURNS):
        held = below | above
        found, free = np.where(below, low, high), ~held
        if free.any():
            rest = right[free] - matrix[np.ix_(free, held)] @ found[held]
            found[free] = np.linalg.solve(matrix[np.ix_(free, free)], rest)
        slope = right - matrix @ found
        before = below, above
        below = (free & (found < low)) | (below & (slope < 0))
        above = (free & (found > high)) | (above & (slope > 0))
        if (below == before[0]).all() and (above == before[1]).all():
            return found
    return _by_least_squares(matrix, right, low, high)


def _by_least_squares(
    matrix: np.ndarray, right: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    """As `_within`."""
    from scipy.optimize import lsq_linear

    size = np.sqrt(np.diag(matrix))
    square, axes = np.linalg.eigh(matrix / np.outer(size, size))
    root = np.sqrt(np.maximum(square, SINGULAR))
    wanted, bounds = axes.T @ (right / size) / root, (low * size, high * size)
    found = lsq_linear(root[:, None] * axes.T, wanted, bounds, method="bvls")
    inside = np.clip(found.x / size, low, high)
    return np.where(found.active_mask < 0, low, np.where(found.active_mask > 0, high, inside))
