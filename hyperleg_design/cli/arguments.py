"""What option values must satisfy beyond their type, checked before a verb does anything."""

from __future__ import annotations

import math
import typing
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

from hyperleg_design.errors import InputError

LARGEST = 2**63 - 1
"""Largest value of any number, such as a seed: that of a signed integer of 64 bits, in which torch
and NumPy compute.
"""


@dataclass(frozen=True)
class AtLeast:
    """Lower bound of a number, written beside its type: `Annotated[int, AtLeast(1)]`.

    No number may exceed `LARGEST`.
    """

    low: float
    """Smallest value that is allowed, or the value that it must exceed."""
    exclusive: bool = False
    """Whether the value must be larger than `low`."""

    def admits(self, value: float) -> bool:
        """Decide whether a value satisfies the bound.

        Args:
            value: the option's value.

        Returns:
            True for a finite value on or above the bound (above it, where the bound is exclusive)
            and not above `LARGEST`.
        """
        above = value > self.low if self.exclusive else value >= self.low
        return above and value <= LARGEST and math.isfinite(value)

    def remedy(self, value: float) -> str:
        """Write what would be right.

        Args:
            value: that is not admitted.

        Returns:
            The remedy of an error.
        """
        if value > LARGEST and not (isinstance(value, float) and math.isinf(value)):
            return f"expects a number of at most {LARGEST}"
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
                raise InputError("arguments", option(field.name), value, bound.remedy(value))
