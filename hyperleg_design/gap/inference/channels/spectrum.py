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
    """Products O of the columns with themselves, by session, with the change integrated out.

    Only the columns after the first `steady` ones change from session to session. With
    O' = U diag(v) U' for the products of these, and B = O U for those of all with them, a change of
    scale c leaves of the products of a session O - B diag(c^2 / (1 + c^2 v)) B'.

    Args:
        products: of the columns with themselves over the noise `(sessions, k, k)`.
        tested: whether a session is under test; all sessions that are, and all that are not, have
            the same scale of the change `(sessions,)`.
        steady: number of columns that do not change.
        known: number of these, the first ones, whose deviation is known, and no scale alters.
    """

    def __init__(
        self, products: np.ndarray, tested: np.ndarray, steady: int = 0, known: int = 0
    ) -> None:
        self.known = known
        values, self.axes = np.linalg.eigh(products[:, steady:, steady:])
        self.steady, self.values = steady, np.maximum(values, 0.0)
        self.beside = products[:, :, steady:] @ self.axes
        self._whole = products.sum(0)
        self._groups = [
            (int(own[0]), _grams(self.values[own], self.beside[own]))
            for own in (np.flatnonzero(tested == which) for which in (False, True))
            if len(own)
        ]
        self._factor: tuple[tuple[bytes, float], np.ndarray] | None = None

    def shrunk(self, change: np.ndarray) -> np.ndarray:
        """1 / (1 + c^2 v) `(sessions, k - steady)`.

        Args:
            change: scale of the change of each session `(sessions,)`.
        """
        return np.asarray(1 / (1 + change[:, None] ** 2 * self.values))

    def left(self, change: np.ndarray, cross: np.ndarray, turned: np.ndarray) -> np.ndarray:
        """Products of the columns with others that the change leaves, summed over the sessions
        `(k, m)`.

        Args:
            change: scale of the change of each session `(sessions,)`.
            cross: products by session `(sessions, k, m)`.
            turned: the same along the axes `(sessions, k - steady, m)`.
        """
        taken = (change[:, None] ** 2 * self.shrunk(change))[:, :, None] * turned
        return np.asarray((cross - self.beside @ taken).sum(0))

    def gram(self, change: np.ndarray) -> np.ndarray:
        """Products of the columns with themselves that the change leaves, summed over the sessions
        `(k, k)`.

        Args:
            change: scale of the change of each session `(sessions,)`.
        """
        return np.asarray(
            self._whole - sum(gram(float(change[first])) for first, gram in self._groups)
        )

    def standing_scales(self, standing: float) -> np.ndarray:
        """Scales of the columns in the standing discrepancy `(k,)`.

        Args:
            standing: logarithm of the scale of those whose deviation is not known.
        """
        scales = np.full(len(self._whole), np.exp(standing))
        scales[: self.known] = 1.0
        return scales

    def factor(self, change: np.ndarray, standing: float) -> np.ndarray:
        """Lower Cholesky factor of I + A `gram` A, A the diagonal of `standing_scales` `(k, k)`.

        Args:
            change: scale of the change of each session `(sessions,)`.
            standing: logarithm of the scale a of the standing discrepancy.
        """
        key = change.tobytes(), standing
        last = self._factor
        if last is not None and last[0] == key:
            return last[1]
        scales = self.standing_scales(standing)
        whole = scales[:, None] * self.gram(change) * scales
        whole.flat[:: len(whole) + 1] += 1.0
        factor = np.linalg.cholesky(whole)
        self._factor = key, factor
        return factor

    def turned(self, cross: np.ndarray) -> np.ndarray:
        """Products of each session's changing columns with others, along the axes
        `(sessions, k - steady, m)`.

        Args:
            cross: of all columns `(sessions, k, m)`.
        """
        return np.asarray(self.axes.swapaxes(1, 2) @ cross[:, self.steady :])


def _grams(values: np.ndarray, beside: np.ndarray) -> Callable[[float], np.ndarray]:
    """What a change takes of `Spectrum.gram`, of sessions with one scale of it: a function of that
    scale.
    """
    flat = values.ravel()
    side = np.ascontiguousarray(beside.swapaxes(0, 1)).reshape(beside.shape[1], -1)

    @lru_cache(maxsize=REMEMBERED)
    def gram(change: float) -> np.ndarray:
        return np.asarray((side * (change**2 / (1 + change**2 * flat))) @ side.T)

    return gram
