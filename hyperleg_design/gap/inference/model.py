"""Some causes together, and how they predict held-out blocks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.inference.fit import Cause, Fit, parts
from hyperleg_design.gap.inference.held_out import Held


@dataclass(frozen=True, eq=False)
class Model:
    """Some causes together, and how they predict held-out blocks."""

    causes: tuple[Cause, ...]
    fit: Fit
    held: Held
    gain: float
    """Log-likelihood of held-out blocks over that of no cause, and how much more plausible the
    nuisance parameters are."""
    below: float = 0.0
    """Part of `gain` that is noise less than its floor."""

    @property
    def names(self) -> tuple[tuple[str, str], ...]:
        """Effects and locations."""
        return tuple(c.name for c in self.causes)

    @property
    def over(self) -> float:
        """As `gain`, were no noise less than its floor: what a model makes better of less than that
        is no evidence of a gap.
        """
        return self.gain - self.below

    def values(self, place: int) -> np.ndarray:
        """Fitted parameters of one cause."""
        cause = self.causes[place]
        return np.clip(
            cause.nulls + self.fit.phi[parts(self.causes)[place]] * cause.usual,
            cause.low,
            cause.high,
        )

    def deviation(self, place: int) -> np.ndarray:
        """Standard deviation of one cause's fitted parameters."""
        variance = np.diag(self.fit.covariance)[parts(self.causes)[place]]
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)) * self.causes[place].usual)
