"""An axis of a sweep: which leaves of a design it moves, and through which values."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.motors import catalogue, find_motor
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.robot.parameters.described import RobotDesign
from hyperleg_design.robot.parameters.entries import check_keys, checked_number

_KEYS = ("paths", "values", "low", "high", "steps", "log", "scale")
_RANGE_KEYS = ("low", "high", "steps", "log")
_MAX_STEPS = 100_000


@dataclass(frozen=True)
class Axis:
    """One independent variable of a sweep, which may set several parameters together."""

    name: str
    """Its column in the table."""
    paths: tuple[str, ...]
    """Leaves that it sets, all to the same value or by the same factor."""
    levels: tuple[Any, ...]
    """Listed values; empty for a continuous range."""
    low: float = math.nan
    """Lower end of a continuous range."""
    high: float = math.nan
    """Upper end of a continuous range."""
    log: bool = False
    """Whether a range is spaced and drawn evenly in its logarithm."""
    scaled: bool = False
    """Whether values multiply each leaf's base value instead of replacing it."""
    unit: str = ""
    """Unit of the values; empty for factors, texts and ratios."""

    @property
    def numeric(self) -> bool:
        """Whether its column holds numbers (motors are texts)."""
        return not self.levels or isinstance(self.levels[0], float)

    @property
    def label(self) -> str:
        """Name with unit, for figures and tables."""
        if self.scaled:
            return f"{self.name} [x base]"
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    def at(self, position: np.ndarray) -> np.ndarray:
        """Compute values at positions along the axis.

        Args:
            position: in [0, 1), `(n,)`.

        Returns:
            Values, `(n,)`.
        """
        if self.levels:
            index = np.minimum((position * len(self.levels)).astype(int), len(self.levels) - 1)
            return np.asarray(self.levels)[index]
        drawn = (
            self.low * (self.high / self.low) ** position
            if self.log
            else self.low + position * (self.high - self.low)
        )
        return np.clip(drawn, self.low, self.high)

    def leaf_values(self, base: RobotDesign, values: np.ndarray) -> dict[str, Any]:
        """Compute what each leaf becomes.

        Args:
            base: the unchanged design.
            values: of this axis, `(n,)`.

        Returns:
            New values of the leaves by path.
        """
        if not self.scaled:
            return dict.fromkeys(self.paths, values)
        leaves = {}
        for path in self.paths:
            start = np.asarray(base[path], float)
            leaves[path] = values.reshape((-1, *(1,) * start.ndim)) * start
        return leaves

    def to_mapping(self) -> dict[str, Any]:
        """Write the axis as plain values, as JSON and YAML take them.

        Returns:
            Fields by name.
        """
        plain = {"paths": list(self.paths), "scaled": self.scaled, "unit": self.unit}
        if self.levels:
            return {**plain, "values": np.asarray(self.levels).tolist()}
        return {**plain, "low": self.low, "high": self.high, "log": self.log}


def read_axis(name: str, data: Any, base: RobotDesign, where: str, *, grid: bool) -> Axis:
    """Read an axis as a sweep file describes it.

    Args:
        name: key of the axis: a leaf's path or a pattern of such paths, or any name where `paths`
            lists paths and patterns.
        data: `{values: [...]}`, `{low, high, steps, log}`, or `{scale: ...}` with either inside;
            `steps` makes a range a list of levels, which a grid needs.
        base: design whose leaves it moves.
        where: file, for messages.
        grid: whether every range needs `steps`.

    Returns:
        The validated axis.

    Raises:
        InputError: it names no leaf, one that cannot vary within a sweep, or values that the leaf
        does not take.
    """
    place = f"axes.{name}"
    if not isinstance(data, Mapping):
        raise InputError(
            where, place, data, "expects a mapping with values, or with low, high and steps"
        )
    check_keys(data, where, place, (), _KEYS)
    paths = _paths(name, data, base, where, place)
    scaled = "scale" in data
    inner, inner_place = (data["scale"], f"{place}.scale") if scaled else (data, place)
    if scaled:
        if any(k in data for k in ("values", *_RANGE_KEYS)):
            raise InputError(
                where, place, dict(data), "expects values or a range inside scale, not beside it"
            )
        if isinstance(inner, list):
            inner = {"values": inner}
        if not isinstance(inner, Mapping):
            raise InputError(
                where, inner_place, inner, "expects values, or low, high and steps, of the factor"
            )
        check_keys(inner, where, inner_place, (), ("values", *_RANGE_KEYS))
    axis = (
        _listed(name, paths, inner, scaled, base, where, inner_place) if "values" in inner else None
    )
    axis = axis or _range(name, paths, inner, scaled, where, inner_place, grid)
    return _checked(axis, base, where, inner_place)


def _paths(
    name: str, data: Mapping[str, Any], base: RobotDesign, where: str, place: str
) -> tuple[str, ...]:
    rules = base.rules
    if "paths" not in data:
        paths = parameters.matching(name, rules)
        if paths[0] not in rules:
            remedy = (
                parameters.unknown(name, sorted(rules))
                if "." in name
                else "names no leaf of a design; list the leaves it moves under paths"
            )
            raise InputError(where, place, dict(data), remedy)
    else:
        paths = data["paths"]
        if (
            not isinstance(paths, list)
            or not paths
            or not all(isinstance(p, str) for p in paths)
            or len(set(paths)) < len(paths)
        ):
            raise InputError(
                where,
                f"{place}.paths",
                paths,
                "expects a list of different leaves such as [thigh.length, shank.length]",
            )
        paths = list(dict.fromkeys(p for path in paths for p in parameters.matching(path, rules)))
        for path in paths:
            if path not in rules:
                raise InputError(
                    where, f"{place}.paths", path, parameters.unknown(path, sorted(rules))
                )
    for path in paths:
        if rules[path].kind == "flag" or (rules[path].kind == "text" and not _is_motor(path)):
            remedy = (
                "cannot vary within a sweep; give it under set, one sweep for each value, or "
                "use variants"
            )
            raise InputError(where, place, path, remedy)
    return tuple(paths)


def _is_motor(path: str) -> bool:
    return path.startswith("actuators.") and path.endswith(".motor")


def _listed(
    name: str,
    paths: tuple[str, ...],
    data: Mapping[str, Any],
    scaled: bool,
    base: RobotDesign,
    where: str,
    place: str,
) -> Axis:
    for key in _RANGE_KEYS:
        if key in data:
            raise InputError(
                where,
                f"{place}.{key}",
                data[key],
                "stands beside values; give a list or a range, not both",
            )
    values = data["values"]
    if values == "catalogue" and all(_is_motor(p) for p in paths):
        values = sorted(catalogue())
    if not isinstance(values, list) or not values:
        raise InputError(where, f"{place}.values", values, "expects a list of at least one value")
    if any(values.count(v) > 1 for v in values):
        raise InputError(where, f"{place}.values", values, "names a value twice")
    levels: list[Any] = []
    for value in values:
        if scaled:
            levels.append(checked_number(value, where, f"{place}.values"))
        elif _is_motor(paths[0]):
            find_motor(str(value), where, f"{place}.values")
            levels.append(str(value))
        else:
            levels.append(checked_number(value, where, f"{place}.values"))
    return Axis(name, paths, tuple(levels), scaled=scaled)


def _range(
    name: str,
    paths: tuple[str, ...],
    data: Mapping[str, Any],
    scaled: bool,
    where: str,
    place: str,
    grid: bool,
) -> Axis:
    for key in ("low", "high"):
        if key not in data:
            raise InputError(
                where, f"{place}.{key}", None, "is missing; give values, or low and high"
            )
    low, high = (
        checked_number(data["low"], where, f"{place}.low"),
        checked_number(data["high"], where, f"{place}.high"),
    )
    if not low < high:
        raise InputError(where, f"{place}.low", low, f"must lie below high, {high:g}")
    log = data.get("log", False)
    if not isinstance(log, bool):
        raise InputError(where, f"{place}.log", log, "expects true or false")
    if log and low <= 0:
        raise InputError(where, f"{place}.low", low, "must be positive where log is true")
    steps = data.get("steps")
    if steps is None:
        if grid:
            raise InputError(
                where,
                f"{place}.steps",
                None,
                "is missing; a grid needs the number of levels of each range",
            )
        return Axis(name, paths, (), low, high, log, scaled)
    if isinstance(steps, bool) or not isinstance(steps, int) or not 2 <= steps <= _MAX_STEPS:
        raise InputError(
            where, f"{place}.steps", steps, f"expects a whole number within 2 .. {_MAX_STEPS}"
        )
    levels = np.geomspace(low, high, steps) if log else np.linspace(low, high, steps)
    return Axis(name, paths, tuple(float(v) for v in levels), log=log, scaled=scaled)


def _checked(axis: Axis, base: RobotDesign, where: str, place: str) -> Axis:
    """The axis with its unit, after all its leaves have taken all its values (of a range, its
    ends).
    """
    rules = base.rules
    if axis.scaled and any(rules[p].kind == "text" for p in axis.paths):
        raise InputError(
            where, place, list(axis.paths), "names a motor, which has nothing to scale; use values"
        )
    if not axis.scaled:
        if len({(rules[p].kind, rules[p].unit) for p in axis.paths}) > 1:
            raise InputError(
                where,
                place,
                list(axis.paths),
                "sets leaves of different units to one value; use scale, or an axis each",
            )
        vector = next((p for p in axis.paths if rules[p].size), None)
        if vector:
            raise InputError(where, place, vector, "is a vector; use scale")
    if not axis.numeric:
        return axis
    ends = np.asarray(axis.levels if axis.levels else (axis.low, axis.high))
    for path, values in axis.leaf_values(base, ends).items():
        outside = (values < rules[path].low) | (values > rules[path].high)
        if np.any(outside):
            unit = f" {rules[path].unit}" if rules[path].unit else ""
            remedy = (
                f"{path} takes {rules[path].low:g} .. {rules[path].high:g}{unit}; check unit "
                f"and sign"
            )
            raise InputError(where, place, float(np.asarray(values)[outside][0]), remedy)
    return axis if axis.scaled else dataclasses.replace(axis, unit=rules[axis.paths[0]].unit)
