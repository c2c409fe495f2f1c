"""What an effect at one joint or motor does in each step of a simulation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from hyperleg_design.simulation.alteration import Alteration, Live


class Hooks(Live):
    """Hooks at one joint or motor; constants of the alteration are attributes of the same name."""

    kind: ClassVar[str]
    """Where they act: `joint` or `motor`."""
    alteration: Placed
    place: int
    """Of the joint or motor in the machine."""

    def prepare(self) -> None:
        """Find the place, and take over the constants."""
        self.place = getattr(self.machine, self.kind)(self.alteration.location)
        for name, value in self.alteration.constants.items():
            setattr(self, name, value)


class JointHooks(Hooks):
    """Hooks at one joint of the machine."""

    kind: ClassVar[str] = "joint"


class MotorHooks(Hooks):
    """Hooks at one motor of the machine."""

    kind: ClassVar[str] = "motor"


@dataclass(frozen=True, eq=False)
class Placed(Alteration):
    """An effect at one joint or motor, by its hooks."""

    location: str
    constants: Mapping[str, Any]
    """`()` or `(n,)` each."""
    live: type[Hooks] | None = field(default=None, kw_only=True)  # type: ignore[misc]
