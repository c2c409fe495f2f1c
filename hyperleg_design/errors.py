"""The errors a user can meet: each names where, what, the value found and what would be right."""

from __future__ import annotations


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
        shown = repr(value)
        if len(shown) > 120:
            shown = shown[:117] + "..."
        place = f"{where}: {field}" if field else where
        super().__init__(f"{place} = {shown}: {remedy}" if value is not None else f"{place}: {remedy}")


class OutputError(HyperlegError):
    """A result could not be written; nothing half-written is left behind."""


class InfeasibleError(HyperlegError):
    """A question with a well-formed input has no solution (a force outside the envelope, an unreachable pose)."""
