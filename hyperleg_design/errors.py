"""The errors a user can meet: each names where, what, the value found and what would be right."""

from __future__ import annotations

import reprlib

_SHORT = reprlib.Repr()
_SHORT.maxstring = _SHORT.maxother = _SHORT.maxlong = 100
"""Values as messages show them; short however large or nested they are."""


class HyperlegError(Exception):
    """Base of every error this package raises on purpose; the command line prints it as one line."""


class InputError(HyperlegError):
    """A value that a user gave is wrong.

    Args:
        where: file, option or object in which the value stands.
        field: dotted path of the field, empty when the whole file is meant.
        value: the value found.
        remedy: what would be right.
    """

    def __init__(self, where: str, field: str, value: object, remedy: str) -> None:
        self.where, self.field, self.value, self.remedy = where, field, value, remedy
        shown = " ".join(_shown(value).split())
        if len(shown) > 120:
            shown = shown[:117] + "..."
        place = f"{where}: {field}" if field else where
        super().__init__(f"{place} = {shown}: {remedy}" if value is not None else f"{place}: {remedy}")


def _shown(value: object) -> str:
    try:
        return _SHORT.repr(value)
    except ValueError:  # Python refuses to write integers of thousands of digits
        return f"{type(value).__name__} too long to show"


class OutputError(HyperlegError):
    """A result could not be written; nothing half-written is left behind."""


class InfeasibleError(HyperlegError):
    """A question with a well-formed input has no solution (a force outside the envelope, an unreachable pose)."""
