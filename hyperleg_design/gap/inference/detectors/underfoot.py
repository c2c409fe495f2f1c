"""What feet tell of their ground without any residual, foot by foot; see `slipping` and
`sinking`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from hyperleg_design.gap.results.diagnosis import Value


@dataclass(frozen=True, eq=False)
class Underfoot:
    """One foot on another ground than it should be."""

    effect: str
    """Of the catalogue."""
    foot: str
    parameters: Mapping[str, Value]
    shape: str
    """By which it is known."""
    says: str
    """For people."""
    weight: float
    """Of this foot among others: seconds, or contacts."""
    size: float
    """By how much the nominal ground is off, root mean square, in `unit`."""
    left: float
    """Of it, with a ground taken from other data: other logs, or the other half of one."""
    unit: str

    @property
    def name(self) -> tuple[str, str]:
        """Effect and location."""
        return self.effect, self.foot

    @property
    def closed(self) -> float:
        """Share of the gap that is foretold."""
        return 1 - self.left / self.size
