"""Fields of typed parameters: what each may hold, with its unit and bounds."""

from __future__ import annotations

import dataclasses
import math
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Rule:
    """What a leaf may hold."""

    kind: str
    """`number`, `text` or `flag`."""
    unit: str = ""
    """SI unit, or the unit that the field's name ends in."""
    low: float = -math.inf
    """Smallest value that makes sense; outside it the value is taken for a mistake of unit or
    sign."""
    high: float = math.inf
    """Largest value that makes sense."""
    size: int = 0
    """Length of a vector; 0 for a scalar."""
    choices: tuple[str, ...] = ()
    """Allowed texts; empty for any."""
    varies: bool = True
    """Whether the designs of a batch may differ in it."""


def number(
    unit: str,
    low: float = -math.inf,
    high: float = math.inf,
    *,
    size: int = 0,
    default: Any = dataclasses.MISSING,
) -> Any:
    """Make a dataclass field for a number, or for a vector of numbers, with bounds.

    Args:
        unit: of the number; empty without one.
        low: smallest value that is allowed.
        high: largest value that is allowed.
        size: length of the vector; 0 for a single number.
        default: of the field; required by default.

    Returns:
        The field.
    """
    return _field(Rule("number", unit, low, high, size), default)


def text(*choices: str, default: Any = dataclasses.MISSING, varies: bool = False) -> Any:
    """Make a dataclass field for a text.

    Args:
        choices: values that are allowed; any text where none are given.
        default: of the field; required by default.
        varies: whether the designs of a batch may differ in it.

    Returns:
        The field.
    """
    return _field(Rule("text", choices=choices, varies=varies), default)


def flag(default: Any = dataclasses.MISSING) -> Any:
    """Make a dataclass field for true or false.

    Args:
        default: of the field; required by default.

    Returns:
        The field.
    """
    return _field(Rule("flag", varies=False), default)


def _field(rule: Rule, default: Any) -> Any:
    metadata = {"rule": rule}
    if default is dataclasses.MISSING:
        return dataclasses.field(metadata=metadata)
    if isinstance(default, tuple):
        default = np.asarray(default, float)
        return dataclasses.field(default_factory=lambda: default, metadata=metadata)
    return dataclasses.field(default=default, metadata=metadata)


def rule_of(field: dataclasses.Field[Any]) -> Rule:
    """Look up the rule of a leaf that `number`, `text` or `flag` made.

    Args:
        field: of a dataclass.

    Returns:
        The rule.
    """
    rule: Rule = field.metadata["rule"]
    return rule


def is_leaf(field: dataclasses.Field[Any]) -> bool:
    """Decide whether a dataclass field is a leaf, not a section.

    Args:
        field: of a dataclass.

    Returns:
        True for a leaf.
    """
    return "rule" in field.metadata


def section_types(cls: type) -> Mapping[str, type]:
    """Find the sections of a dataclass.

    Returns:
        Dataclass of each section, by field.
    """
    return _section_types(cls)  # typing.get_type_hints is slow


@cache
def _section_types(cls: Any) -> Mapping[str, type]:
    hints = typing.get_type_hints(cls)
    return MappingProxyType(
        {
            f.name: hints[f.name]
            for f in dataclasses.fields(cls)
            if dataclasses.is_dataclass(hints[f.name])
        }
    )
