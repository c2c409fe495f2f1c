"""The discrepancy columns of one channel at given noise, each session's turned to where they are
apart, so that no scale of the discrepancy needs a new decomposition of them.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

REMEMBERED = 4
"""Scales of the change whose matrices are kept."""


class Spectrum:
    """Eigenvalues and axes of the columns' products with themselves, O = U diag(v) U', by session.

    With the change of scale c integrated out, the products of a session become
    O (I + c^2 O)^-1 = U diag(v / (1 + c^2 v)) U'.

    Args:
        products: of the columns with themselves over the noise `(sessions, k, k)`.
        tested: whether a session is under test; all sessions that are, and all that are not, have
            the same scale of the change `(sessions,)`.
    """

    def __init__(self, products: np.ndarray, tested: np.ndarray) -> None:
        values, self.axes = np.linalg.eigh(products)
        self.values = np.maximum(values, 0.0)
        alike = [np.flatnonzero(tested == which) for which in (False, True)]
        self._groups = [
            (int(own[0]), _grams(self.values[own], self.axes[own])) for own in alike if len(own)
        ]
        self._factor: tuple[tuple[bytes, float], np.ndarray] | None = None

    def shrunk(self, change: np.ndarray) -> np.ndarray:
        """1 / (1 + c^2 v) `(sessions, k)`.

        Args:
            change: scale of the change of each session `(sessions,)`.
        """
        return np.asarray(1 / (1 + change[:, None] ** 2 * self.values))

    def gram(self, change: np.ndarray) -> np.ndarray:
        """Sum over the sessions of O (I + c^2 O)^-1 `(k, k)`.

        Args:
            change: scale of the change of each session `(sessions,)`.
        """
        parts = [gram(float(change[first])) for first, gram in self._groups]
        return np.asarray(sum(parts[1:], parts[0]))

    def factor(self, change: np.ndarray, standing: float) -> np.ndarray:
        """Lower Cholesky factor of I + a^2 `gram` `(k, k)`.

        Args:
            change: scale of the change of each session `(sessions,)`.
            standing: logarithm of the scale a of the standing discrepancy.
        """
        key = change.tobytes(), standing
        known = self._factor
        if known is not None and known[0] == key:
            return known[1]
        whole = np.exp(2 * standing) * self.gram(change)
        whole.flat[:: len(whole) + 1] += 1.0
        factor = np.linalg.cholesky(whole)
        self._factor = key, factor
        return factor

    def turned(self, cross: np.ndarray) -> np.ndarray:
        """Products of each session's columns with others, along the axes `(sessions, k, m)`.

        Args:
            cross: `(sessions, k, m)`.
        """
        return np.asarray(self.axes.swapaxes(1, 2) @ cross)


def _grams(values: np.ndarray, axes: np.ndarray) -> Callable[[float], np.ndarray]:
    """`Spectrum.gram` of sessions with one scale of the change, a function of that scale."""
    k = axes.shape[1]
    flat, side = values.ravel(), np.ascontiguousarray(axes.swapaxes(0, 1)).reshape(k, -1)

    @lru_cache(maxsize=REMEMBERED)
    def gram(change: float) -> np.ndarray:
        return np.asarray((side * (flat / (1 + change**2 * flat))) @ side.T)

    return gram
