"""The result of `slipping` and `sinking`: a foot whose ground differs from the model's."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from hyperleg_design.gap.results.diagnosis import Value


@dataclass(frozen=True, eq=False)
class Underfoot:
    """One foot, and how its ground differs from the nominal one."""

    effect: str
    """Identifier of the effect in the catalogue."""
    foot: str
    parameters: Mapping[str, Value]
    shape: str
    """Name of the finding: that the foot slides, or that it sinks."""
    sentence: str
    """What was seen, in a sentence for people."""
    weight: float
    """Of this foot among others: seconds that it slides, or number of its contacts."""
    size: float
    """By how much the nominal ground is off, root mean square, in `unit`."""
    left: float
    """The same with the ground that other data show: other logs, or the other half of one."""
    unit: str

    @property
    def name(self) -> tuple[str, str]:
        """Effect and location."""
        return self.effect, self.foot

    @property
    def closed(self) -> float:
        """Share of `size` that a ground estimated from other data explains."""
        return 1 - self.left / self.size
