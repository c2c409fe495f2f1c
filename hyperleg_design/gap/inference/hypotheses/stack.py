"""Causes of a hypothesis one after the other, and the sums of their products with all channels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from hyperleg_design.gap.inference.assembly import Evidence
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.channels.crossing import Crossing
from hyperleg_design.gap.inference.endogenous import Factor, joined
from hyperleg_design.gap.inference.shrinking import Shrinking


@dataclass(frozen=True, eq=False)
class Stack:
    """Linearised causes, one after the other."""

    causes: tuple[Cause, ...]
    weight: np.ndarray
    """What a trace is multiplied by before products are taken `(S,)`."""
    crossing: Crossing
    """Products of `rows` with all channels."""
    low: np.ndarray
    high: np.ndarray
    """Bounds of theta `(k,)`."""
    shape: np.ndarray
    """Parameters that only shape a trace `(k,)` of bool."""
    factors: tuple[tuple[int, Factor | Shrinking], ...]
    """Parameters that scale the torque which the residual is made of, and the missing term of its
    density, see `endogenous`."""

    @classmethod
    def of(cls, causes: Sequence[Cause], evidence: Evidence) -> Stack:
        """Stack linearised causes one after the other.

        Args:
            causes: in their order.
            evidence: on whose samples they are linearised.
        """
        crossing = Crossing.of(evidence.channels, _rows(causes, evidence.weight))
        return cls._of(tuple(causes), evidence.weight, crossing)

    @classmethod
    def _of(cls, causes: tuple[Cause, ...], weight: np.ndarray, crossing: Crossing) -> Stack:
        """A stack with known products."""
        ends = np.cumsum([0, *(len(cause.nulls) for cause in causes)]).tolist()
        none = np.zeros(0)
        return cls(
            causes,
            weight,
            crossing,
            np.concatenate([none, *((c.low - c.nulls) / c.usual for c in causes)]),
            np.concatenate([none, *((c.high - c.nulls) / c.usual for c in causes)]),
            np.concatenate([none.astype(bool), *(cause.shape.astype(bool) for cause in causes)]),
            tuple(
                (start + term.parameter, term)
                for start, cause in zip(ends, causes, strict=False)
                for term in cause.factors
            ),
        )

    def extended(self, causes: Sequence[Cause], evidence: Evidence) -> Stack:
        """Stack further causes after these, whose products are not computed again.

        Args:
            causes: further ones.
            evidence: on whose samples all are linearised.
        """
        known, whole = self.rows[: len(self.low)], (*self.causes, *causes)
        columns = np.concatenate([cause.columns for cause in causes])
        further = np.concatenate([columns, *_constant(whole)]) * self.weight
        crossing = self.crossing.extended(evidence.channels, known, further)
        return self._of(whole, self.weight, crossing)

    def held(self, causes: Sequence[tuple[slice, Cause]]) -> Stack:
        """Hold some causes at the values at which they are linearised.

        Args:
            causes: and where their parameters stand.
        """
        low, high = self.low.copy(), self.high.copy()
        for part, cause in causes:
            low[part] = high[part] = (cause.values - cause.nulls) / cause.usual
        return replace(self, low=low, high=high)

    @cached_property
    def groups(self) -> list[tuple[list[int], Factor | Shrinking]]:
        """`factors`, of which those that scale the same torque are one."""
        return joined(self.factors)

    @cached_property
    def constant_last(self) -> bool:
        """Whether `rows` ends with a constant trace."""
        return bool(_constant(self.causes))

    @cached_property
    def rows(self) -> np.ndarray:
        """Weighted columns, and last the trace at theta 0 of what is linearised elsewhere, where
        there is one `(k, S)` or `(k + 1, S)`.
        """
        return _rows(self.causes, self.weight)

    @property
    def columns(self) -> np.ndarray:
        """Weighted as the residual `(k, S)`."""
        return self.rows[: len(self.low)]

    def sizes(self, theta: np.ndarray) -> np.ndarray:
        """Compute sizes of all rows: those of the causes, and 1 of the constant trace.

        Args:
            theta: of the causes `(k,)`.
        """
        return np.append(theta, 1.0) if self.constant_last else theta


def _constant(causes: Sequence[Cause]) -> list[np.ndarray]:
    """Sum of the constant traces of some causes, where there is any `(1, S)`."""
    constants = [cause.constant for cause in causes if not cause.linear]
    whole = np.sum(constants, axis=0) if constants else np.zeros(1)
    return [whole[None]] if whole.any() else []


def _rows(causes: Sequence[Cause], weight: np.ndarray) -> np.ndarray:
    """Weighted columns of causes, and the sum of their constant traces, if any."""
    none = np.zeros((0, len(weight)))
    return np.concatenate([none, *(c.columns for c in causes), *_constant(causes)]) * weight
