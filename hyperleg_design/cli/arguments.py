"""What option values must satisfy beyond their type, checked before a verb does anything."""

from __future__ import annotations

import math
import typing
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

from hyperleg_design.errors import InputError


@dataclass(frozen=True)
class AtLeast:
    """Lower bound of a number, written beside its type: `Annotated[int, AtLeast(1)]`."""

    low: float
    """Smallest value that is allowed, or the value that it must exceed."""
    exclusive: bool = False
    """Whether the value must be larger than `low`."""

    def admits(self, value: float) -> bool:
        """Decide whether a value satisfies the bound.

        Args:
            value: the option's value.

        Returns:
            True for a finite value on or above the bound (above it, where the bound is exclusive).
        """
        return math.isfinite(value) and (value > self.low if self.exclusive else value >= self.low)

    @property
    def remedy(self) -> str:
        """What an error says would be right."""
        return f"expects a number {'above' if self.exclusive else 'of at least'} {self.low:g}"


def option(field: str) -> str:
    """Write a field's name as a user types it.

    Args:
        field: name of the field, such as `only_make`.

    Returns:
        The option, such as `--only-make`.
    """
    return "--" + field.replace("_", "-")


def check_bounds(command: Any) -> None:
    """Check every number of a parsed command, and of the commands in it, against its `AtLeast`.

    Args:
        command: a dataclass whose fields are options.

    Raises:
        InputError: names the option, its value and the bound.
    """
    hints = typing.get_type_hints(type(command), include_extras=True)
    for field in fields(command):
        value = getattr(command, field.name)
        if is_dataclass(value):
            check_bounds(value)
        for bound in getattr(hints[field.name], "__metadata__", ()):
            if isinstance(bound, AtLeast) and value is not None and not bound.admits(value):
                raise InputError("arguments", option(field.name), value, bound.remedy)
