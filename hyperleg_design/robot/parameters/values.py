"""Typed parameters: from YAML to frozen, validated dataclasses, with units, bounds and the origin
of each value.

A leaf stands in a file as a plain value, or as a mapping `{value, label, source}` where the label
says how far to trust it: `paper` (printed there), `vendor` (a data sheet), `derived` (follows from
those), `assumed` (an engineer's choice). A leaf holds one value, or, in a batch of designs, an
array of them with the batch in front: `(n,)`, `(n, 3)`.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cache
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np

from hyperleg_design.errors import InputError, meant
from hyperleg_design.robot.parameters.fields import Rule, is_leaf, rule_of, section_types

LABELS = ("paper", "vendor", "derived", "assumed", "user")
"""Origins of a value; `user` marks one that a user set."""

MOST_NAMES = 16
"""Names that an error lists at most."""

T = TypeVar("T")


@dataclass(frozen=True)
class Origin:
    """Where a value comes from."""

    label: str
    """One of `LABELS`."""
    source: str = ""
    """Table, page or reason."""


def checked(value: Any, rule: Rule, where: str, path: str) -> Any:
    """Bring a value into the form of its rule.

    Args:
        value: as a file or a user gives it.
        rule: of the leaf.
        where: file or option, for error messages.
        path: dotted path of the leaf.

    Returns:
        A float, text or bool; a read-only array for vectors and batches.

    Raises:
        InputError: wrong type, shape, unit (by magnitude), sign, or not finite.
    """
    if isinstance(value, np.ndarray) and value.ndim and not rule.varies:
        raise InputError(
            where, path, value.tolist(), "cannot differ within a batch; make one batch for each"
        )
    if rule.kind == "flag":
        if isinstance(value, bool | np.bool_):
            return bool(value)
        raise InputError(where, path, value, "expects true or false")
    if rule.kind == "text":
        if (
            isinstance(value, np.ndarray)
            and value.ndim == 1
            and value.size
            and all(isinstance(v, str) for v in value.tolist())
        ):
            bad = [str(v) for v in np.unique(value) if rule.choices and v not in rule.choices]
            if not bad:
                value = value.astype(str)
                value.setflags(write=False)
                return value
            value = bad[0]
        elif isinstance(value, str) and (not rule.choices or value in rule.choices):
            return value
        raise InputError(
            where,
            path,
            value,
            f"expects {'one of ' + ', '.join(rule.choices) if rule.choices else 'a text'}",
        )
    return _checked_number(value, rule, where, path)


def _checked_number(value: Any, rule: Rule, where: str, path: str) -> Any:
    """A number or vector, or a batch of them as a read-only array, that keeps its rule.

    Raises:
        InputError: it does not.
    """
    low, high = rule.low, rule.high
    if type(value) is float and not rule.size and low <= value <= high and math.isfinite(value):
        return value  # as nearly all are, without an array
    unit = f" in {rule.unit}" if rule.unit else ""
    what = f"a vector of {rule.size} numbers{unit}" if rule.size else f"a number{unit}"
    array = _as_array(value, what, where, path)
    if not _has_shape(array, value, rule.size):
        raise InputError(where, path, value, f"expects {what}")
    if array.ndim and array.shape[0] == 0:
        raise InputError(where, path, value, "is a batch of no designs")
    if not np.all(np.isfinite(array)):
        raise InputError(where, path, value, f"expects {what}, finite")
    outside = (array < low) | (array > high)
    if np.any(outside):
        worst = float(array[outside].flat[0]) if array.ndim else value
        remedy = f"expects {what} within {low:g} .. {high:g}; check unit and sign"
        raise InputError(where, path, worst, remedy)
    if array.ndim == 0:
        return float(array)
    array.setflags(write=False)
    return array


def _as_array(value: Any, what: str, where: str, path: str) -> np.ndarray:
    """Numbers as an array of floats; texts are read as numbers, since YAML takes 1e-3 for a text.

    Raises:
        InputError: something that is no number, or a truth value.
    """
    some = list(value) if isinstance(value, list | tuple) else [value]
    remedy = f"expects {what}"
    try:
        if any(isinstance(v, bool) for v in some):
            raise TypeError
        if isinstance(value, str):
            remedy += ", without a unit after it"
            return np.array(float(value))
        if isinstance(value, list | tuple):
            value = [float(v) if isinstance(v, str) else v for v in value]
        return np.array(value, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise InputError(where, path, value, remedy) from None


def _has_shape(array: np.ndarray, value: Any, size: int) -> bool:
    """Whether it is a vector of a size, a number where the size is 0, or an array of these."""
    if size:
        return array.ndim in (1, 2) and array.shape[-1] == size
    return array.ndim <= 1 and not isinstance(value, list | tuple)


class Checked:
    """A dataclass whose leaves are checked and normalised when one is made; errors name the class
    in place of a file.
    """

    def __post_init__(self) -> None:
        section: Any = self
        for field in dataclasses.fields(section):
            if is_leaf(field):
                value = getattr(self, field.name)
                value = checked(value, rule_of(field), type(self).__name__.lower(), field.name)
                object.__setattr__(self, field.name, value)


def from_mapping(
    cls: type[T], data: Any, where: str, path: str = "", origins: dict[str, Origin] | None = None
) -> T:
    """Build a dataclass of leaves and sections from nested mappings.

    Args:
        cls: the dataclass.
        data: mapping as YAML gives it.
        where: file or option, for messages.
        path: dotted path of `data` in that file.
        origins: filled with the origin of each leaf, by dotted path.

    Returns:
        The validated dataclass.

    Raises:
        InputError: unknown or missing field, or a leaf that breaks its rule.
    """
    if not isinstance(data, Mapping):
        raise InputError(
            where,
            path,
            data,
            f"expects a mapping with {', '.join(f.name for f in dataclasses.fields(cls))}",  # type: ignore[arg-type]
        )
    fields = {f.name: f for f in dataclasses.fields(cls)}  # type: ignore[arg-type]
    sections = section_types(cls)
    known = {n for n, f in fields.items() if n in sections or is_leaf(f)}
    dot = f"{path}." if path else ""
    for name in data:
        if name not in known:
            raise InputError(where, f"{dot}{name}", data[name], unknown(str(name), sorted(known)))
    values: dict[str, Any] = {}
    for name, field in fields.items():
        if name not in known:
            continue
        if name in sections:
            if name in data:
                values[name] = from_mapping(sections[name], data[name], where, dot + name, origins)
            elif (
                field.default is dataclasses.MISSING
                and field.default_factory is dataclasses.MISSING
            ):
                raise InputError(where, dot + name, None, "is missing")
            continue
        if name not in data:
            if (
                field.default is dataclasses.MISSING
                and field.default_factory is dataclasses.MISSING
            ):
                unit = f" [{rule_of(field).unit}]" if rule_of(field).unit else ""
                raise InputError(where, dot + name, None, f"is missing{unit}")
            if origins is not None:
                origins[dot + name] = Origin("assumed", "default of this field")
            continue
        value, origin = labelled(data[name], where, dot + name)
        values[name] = checked(value, rule_of(field), where, dot + name)
        if origins is not None:
            origins[dot + name] = origin
    return cls(**values)


def labelled(data: Any, where: str, path: str) -> tuple[Any, Origin]:
    """Split a leaf into its value and its origin.

    Args:
        data: a plain value, or a mapping `{value, label, source}`.
        where: file, for error messages.
        path: dotted path of the leaf.

    Returns:
        The value and its origin; that of a plain value is the user.

    Raises:
        InputError: a mapping with other keys, or with a label that does not exist.
    """
    if not isinstance(data, Mapping):
        return data, Origin("user")
    known = ["confidence", "label", "source", "value"]
    for key in data:
        if key not in known and "value" in data:
            raise InputError(where, f"{path}.{key}", data[key], unknown(str(key), known))
    if "value" not in data:
        raise InputError(
            where, path, dict(data), "expects a value, or a mapping with value, label, source"
        )
    label = data.get("label", "user")
    if label not in LABELS:
        raise InputError(where, f"{path}.label", label, f"expects one of {', '.join(LABELS)}")
    return data["value"], Origin(label, str(data.get("source", "")))


def unknown(name: str, known: list[str], what: str = "field") -> str:
    """Write the remedy for a name that does not exist: the nearest name, or all of them.

    Args:
        name: that was given.
        known: names that exist.
        what: is named.

    Returns:
        The text.
    """
    every = f"there are {some(known) or 'none'}"
    return f"no such {what}; {meant(name, known, every)}"


def some(names: Iterable[str]) -> str:
    """Write names in one line: all, or the sections they lie in where there are many.

    Args:
        names: dotted paths.

    Returns:
        The text.
    """
    names = list(names)
    if len(names) <= MOST_NAMES:
        return ", ".join(names)
    sections = list(
        dict.fromkeys(f"{name.partition('.')[0]}.*" if "." in name else name for name in names)
    )
    return ", ".join(sections if 1 < len(sections) <= MOST_NAMES else [*names[:MOST_NAMES], "..."])


def matching(path: str, names: Iterable[str]) -> list[str]:
    """Find the paths that a pattern such as `actuators.*_knee.gear` stands for.

    Args:
        path: a dotted path, or a pattern in which `*` stands for any characters.
        names: paths that exist.

    Returns:
        The paths that match; the path itself where it is no pattern, or where none does.
    """
    matches = [name for name in names if fnmatchcase(name, path)] if "*" in path else []
    return matches or [path]


def leaves(instance: Any, path: str = "") -> dict[str, Any]:
    """Collect all leaves of a dataclass.

    Args:
        instance: the dataclass.
        path: dotted path of the instance, put before those of its leaves.

    Returns:
        Values by dotted path, in the order of declaration.
    """
    values: dict[str, Any] = {}
    for field in dataclasses.fields(instance):
        name = f"{path}.{field.name}" if path else field.name
        value = getattr(instance, field.name)
        if is_leaf(field):
            values[name] = value
        elif dataclasses.is_dataclass(value):
            values.update(leaves(value, name))
    return values


@cache
def rules(cls: type, path: str = "") -> Mapping[str, Rule]:
    """Collect the rules of all leaves of a dataclass.

    Args:
        cls: the dataclass.
        path: dotted path of the class, put before those of its leaves.

    Returns:
        Rules by dotted path.
    """
    rules_by_path: dict[str, Rule] = {}
    sections = section_types(cls)
    for field in dataclasses.fields(cls):
        name = f"{path}.{field.name}" if path else field.name
        if field.name in sections:
            rules_by_path.update(rules(sections[field.name], name))
        elif is_leaf(field):
            rules_by_path[name] = rule_of(field)
    return MappingProxyType(rules_by_path)


def with_values(
    instance: T, values: Mapping[str, Any], where: str, prefix: str = "", **others: Any
) -> T:
    """Copy a dataclass with other values of some leaves; values may be batches.

    Args:
        instance: the dataclass.
        values: by dotted path.
        where: what to name in errors.
        prefix: dotted path of `instance`, with a dot behind.
        others: fields that are neither leaves nor sections.

    Returns:
        The validated copy.

    Raises:
        InputError: a path that names no leaf, or a value that breaks its rule.
    """
    own: dict[str, Any] = {}
    inner: dict[str, dict[str, Any]] = {}
    sections = section_types(type(instance))
    fields = {f.name: f for f in dataclasses.fields(instance)}  # type: ignore[arg-type]
    for path, value in values.items():
        head, _, rest = str(path).partition(".")
        if head in sections and rest:
            inner.setdefault(head, {})[rest] = value
        elif head in fields and not rest and is_leaf(fields[head]):
            own[head] = checked(value, rule_of(fields[head]), where, prefix + head)
        elif head in sections:
            raise InputError(
                where,
                f"{prefix}{path}",
                value,
                f"is a section; name one of {some(rules(sections[head], prefix + head))}",
            )
        else:
            raise InputError(
                where,
                f"{prefix}{path}",
                value,
                unknown(f"{prefix}{path}", sorted(leaves(instance, prefix[:-1]))),
            )
    for head, part in inner.items():
        own[head] = with_values(getattr(instance, head), part, where, f"{prefix}{head}.")
    return dataclasses.replace(instance, **own, **others)  # type: ignore[type-var]
