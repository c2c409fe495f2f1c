"""Entries of a user's file that are no fields of a section: numbers, mappings and their keys."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from hyperleg_design.errors import InputError
from hyperleg_design.robot.parameters.fields import Rule
from hyperleg_design.robot.parameters.values import checked, some, unknown


def checked_number(
    value: Any, where: str, path: str, low: float = -math.inf, high: float = math.inf
) -> float:
    """Check a number.

    Args:
        value: as the file gives it.
        where: file, for error messages.
        path: dotted path of the entry.
        low: smallest value that makes sense.
        high: largest value that makes sense.

    Returns:
        The number.

    Raises:
        InputError: no number, not finite, or outside the range.
    """
    return float(checked(value, Rule("number", low=low, high=high), where, path))


def checked_whole_number(
    value: Any, where: str, path: str, low: float = -math.inf, high: float = math.inf
) -> int:
    """Check a whole number.

    Args:
        value: as the file gives it.
        where: file, for error messages.
        path: dotted path of the entry.
        low: smallest value that makes sense.
        high: largest value that makes sense.

    Returns:
        The number.

    Raises:
        InputError: no whole number, or outside the range.
    """
    number = checked_number(value, where, path, low, high)
    if number != int(number):
        raise InputError(where, path, value, "expects a whole number")
    return int(number)


def checked_mapping(data: Any, where: str, path: str, of: str = "") -> Mapping[str, Any]:
    """Check that an entry is a mapping.

    Args:
        data: as the file gives it.
        where: file, for error messages.
        path: dotted path of the entry.
        of: what it maps, for the error message, such as `of names to sections`.

    Returns:
        The mapping.

    Raises:
        InputError: no mapping.
    """
    if not isinstance(data, Mapping):
        raise InputError(where, path, data, f"expects a mapping {of}".rstrip())
    return data


def check_keys(
    data: Mapping[str, Any],
    where: str,
    path: str,
    needed: Sequence[str],
    optional: Sequence[str] = (),
) -> None:
    """Check that a mapping has the keys that it needs, and no unknown ones.

    Args:
        data: the mapping.
        where: file, for error messages.
        path: dotted path of the mapping; empty for that of the whole file.
        needed: keys that must be there.
        optional: further keys that may be there.

    Raises:
        InputError: an unknown key, with the nearest known one and all others, or a missing key.
    """
    dot = f"{path}." if path else ""
    for key in data:
        if key not in (*needed, *optional):
            keys = sorted((*needed, *optional))
            remedy = unknown(str(key), keys)
            if remedy.endswith("?"):
                remedy += f" There are {some(keys)}"
            raise InputError(where, f"{dot}{key}", data[key], remedy)
    for key in needed:
        if key not in data:
            raise InputError(where, f"{dot}{key}", None, "is missing")
