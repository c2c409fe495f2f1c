"""Marginal likelihood of one residual channel as a function of the scales of its discrepancy."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.linalg.lapack import dtrtrs

from hyperleg_design.gap.inference.channels.spectrum import Spectrum


@dataclass(frozen=True, eq=False)
class Likelihood:
    """Marginal log-likelihood of one residual at given noise, as a function of the scales."""

    spectrum: Spectrum
    cross: np.ndarray
    """Products of the residual with each session's columns `(sessions, k, 1)`."""
    square: float
    """Of the residual with itself, all sessions."""
    spread: float
    """Log determinant of the noise."""
    _parts: dict[bytes, tuple[np.ndarray, float]] = field(default_factory=dict)
    """Of each change, what no standing scale alters."""

    def at(self, change: np.ndarray, standing: float) -> float:
        """Log-likelihood, up to what all models share [nat].

        Args:
            change: scale of the change of each session `(sessions,)`.
            standing: logarithm of the scale of the standing discrepancy.
        """
        key = change.tobytes()
        if key not in self._parts:
            shrunk, turned = self.spectrum.shrunk(change), self.spectrum.turned(self.cross)
            cross = self.spectrum.left(change, self.cross, turned)[:, 0]
            alone = float(np.sum(change[:, None] ** 2 * shrunk * turned[:, :, 0] ** 2))
            self._parts[key] = cross, self.square - alone - float(np.log(shrunk).sum())
        cross, rest = self._parts[key]
        factor = self.spectrum.factor(change, standing)
        taken, _ = dtrtrs(factor, self.spectrum.standing_scales(standing) * cross, lower=1)
        determinant = 2 * float(np.log(np.diag(factor)).sum())
        return -0.5 * (rest - float(taken @ taken) + determinant + self.spread)
