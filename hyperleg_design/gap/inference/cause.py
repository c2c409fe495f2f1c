"""A cause: one effect at one place, linearised about some values of its parameters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.inference.endogenous import Factor
from hyperleg_design.gap.inference.shrinking import Shrinking

if TYPE_CHECKING:
    from scipy.sparse import csr_array


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
    """Nulls, usual sizes, least and largest values of the parameters `(k,)` each."""
    shape: np.ndarray
    """Parameters that only shape `(k,)` of bool."""
    compact: csr_array
    """`columns`, without their zeros: most effects show in a few rows of many."""
    constant: np.ndarray
    """`(S,)`; empty where the trace is linear."""
    linear: bool
    declared: float = 0.0
    """Payload that the logs declare at its place [kg]."""
    factors: tuple[Factor | Shrinking, ...] = ()
    """How it scales the torques that the residual trusts, or noise."""
    unseen: bool = False
    """Whether no log has what shows it by itself, see `Effect.driven`."""
    beyond: int = 1
    """Joints in a row that its link carries, see `Mechanism.beyond`."""
    standing: bool = False
    """Whether it acts in all logs, reference logs included, not in those under test alone."""
    before: tuple[float, ...] = ()
    """Values of the causes that it acts on, where it is linearised beside any."""

    @property
    def columns(self) -> np.ndarray:
        """In the residual's unit `(k, S)`."""
        return np.asarray(self.compact.toarray())

    @property
    def name(self) -> tuple[str, str]:
        """Effect and location."""
        return self.effect, self.location

    @property
    def phi(self) -> np.ndarray:
        """`values` in usual sizes from the nulls."""
        return np.asarray((self.values - self.nulls) / self.usual)

    def trace(self, phi: np.ndarray) -> np.ndarray:
        """Compute its trace.

        Args:
            phi: values in usual sizes from the nulls `(k,)`.

        Returns:
            In the residual's unit `(S,)`.
        """
        return np.asarray(phi @ self.columns + (0.0 if self.linear else self.constant))
