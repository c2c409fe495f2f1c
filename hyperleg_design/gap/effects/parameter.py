"""A number that an effect has: unit, null, range, and usual size with its source."""

from __future__ import annotations

from dataclasses import dataclass

from hyperleg_design.errors import InputError


@dataclass(frozen=True)
class Parameter:
    """One parameter of an effect."""

    name: str
    """Name in files and on pages."""
    unit: str
    """Unit; empty for a number without one."""
    null: float
    """Value at which the simulation is as it was."""
    low: float
    """Lower end of the range that is searched, of what is physically plausible."""
    high: float
    """Upper end of that range."""
    typical: float
    """Usual distance from `null` on hardware: scale of the prior and of finite differences."""
    source: str
    """Where the magnitude comes from."""
    spread: float = 0.0
    """Usual distance of a healthy robot from `null`, the standard deviation of a nuisance parameter
    (assumed, of the order that data sheets and drawings are wrong by); 0 of one that is none."""
    of_strength: bool = False
    """Whether `typical` and `spread` are over the torque that the joint or motor is made for."""
    shape: bool = False
    """Whether it only shapes the trace (a Stribeck speed, a cogging order) and means nothing while
    the size is at its null."""
    choices: tuple[str, ...] = ()
    """What 0, 1, ... stand for, of one that is no size."""

    def checked(self, value: float, where: str, field: str) -> float:
        """A value inside the bounds.

        Args:
            value: that somebody gave.
            where: file or option, for the message.
            field: place there.

        Returns:
            The value.

        Raises:
            InputError: outside.
        """
        if not self.low <= value <= self.high:
            remedy = f"expects {self.low:g} .. {self.high:g} {self.unit}".rstrip()
            raise InputError(where, field, value, remedy)
        return value
