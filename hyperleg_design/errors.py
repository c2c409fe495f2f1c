"""The errors a user can meet: each names where, what, the value found and what would be right."""

from __future__ import annotations

import difflib
import reprlib
import textwrap
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

_SHORT = reprlib.Repr()
_SHORT.maxstring = _SHORT.maxother = _SHORT.maxlong = 100


class HyperlegError(Exception):
    """Base of every error this package raises on purpose; the command line prints it as one
    line.
    """


class InputError(HyperlegError):
    """A value that a user gave is wrong.

    Args:
        where: file, option or object in which the value stands.
        field: dotted path of the field, empty when the whole file is meant.
        value: the value found.
        remedy: what would be right.
        bad: in a batch of designs, which of them are wrong in this, `(n,)` of bool; None where that
            is not known.
    """

    def __init__(
        self, where: str, field: str, value: object, remedy: str, *, bad: Any = None
    ) -> None:
        self.where, self.field, self.value, self.remedy, self.bad = where, field, value, remedy, bad
        super().__init__(
            f"{self.place} = {shown(value)}: {remedy}"
            if value is not None
            else f"{self.place}: {remedy}"
        )

    @property
    def place(self) -> str:
        """Where and field, the field as a user wrote it."""
        field = (
            self.field if self.field.isprintable() and len(self.field) <= 120 else shown(self.field)
        )
        return f"{self.where}: {field}" if self.field else self.where


def of_batch(errors: Mapping[int, InputError], count: int) -> InputError:
    """Join the errors of single designs of a batch.

    Args:
        errors: by the design's number, at least one.
        count: designs of the batch.

    Returns:
        The first of them; its `bad` marks the designs that have the same one.
    """
    first = next(iter(errors.values()))
    same = [i for i, e in errors.items() if (e.field, e.remedy) == (first.field, first.remedy)]
    bad = np.isin(np.arange(count), same)
    return InputError(first.where, first.field, first.value, first.remedy, bad=bad)


def shown(value: object) -> str:
    """Write a value as messages show it: on one line, and short however large or nested it is.

    Args:
        value: any value.

    Returns:
        At most 120 characters.
    """
    if hasattr(value, "tolist"):  # numpy's, as Python's
        value = value.tolist()
    try:
        text = " ".join(_SHORT.repr(value).split())
    except ValueError:  # Python refuses to write integers of thousands of digits
        return f"{type(value).__name__} too long to show"
    return text if len(text) <= 120 else text[:117] + "..."


def in_short(error: Exception, width: int = 100) -> str:
    """Shorten the message of another library to one line.

    Args:
        error: the exception.
        width: most characters; the text is cut between words unless one is very long.

    Returns:
        The text.
    """
    text = " ".join(str(error).split())
    cut = textwrap.shorten(text, width, placeholder=" ...")
    return cut if 2 * len(cut) > width or len(text) <= width else text[: width - 4] + " ..."


def meant(name: str, known: Iterable[str], otherwise: str = "") -> str:
    """Write the remedy for a name that does not exist.

    Args:
        name: that was given.
        known: names that exist.
        otherwise: what to say where no name is near; all names by default.

    Returns:
        A question with the nearest name, or `otherwise`.
    """
    names = list(known)
    near = difflib.get_close_matches(name[:100], names, n=1)
    if alike := [each for each in names if each.lower() == name.lower()]:
        near = alike
    elif not near:
        lower = {each.lower(): each for each in reversed(names)}
        near = [lower[n] for n in difflib.get_close_matches(name[:100].lower(), lower, n=1)]
    if near:
        return f"did you mean {near[0]}?"
    return otherwise or f"there are {', '.join(names) or 'none'}"


class OutputError(HyperlegError):
    """A result could not be written; nothing half-written is left behind."""


class InfeasibleError(HyperlegError):
    """A question with a well-formed input has no solution (a force outside the envelope, an
    unreachable pose).
    """
