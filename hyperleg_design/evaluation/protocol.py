"""Evaluation protocols: what is run and how it is measured, read from `sim/protocol_*.yaml` or a
user's file.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.protocols.course import course_length
from hyperleg_design.reading import given_path, read_yaml
from hyperleg_design.robot.parameters import fields as parameter_fields
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.robot.parameters.fields import number
from hyperleg_design.robot.parameters.values import Checked
from hyperleg_design.simulation.settings import Randomisation, Start

MOST_TRIALS = 4096
T_TEST_POINTS = {"A": (0.0, 0.0), "B": (9.14, 0.0), "C": (9.14, 4.57), "D": (9.14, -4.57)}
"""Points of the human agility T-test, x ahead and y to the left [m]; the run starts in A. The paper
does not print the size of its course."""
T_TEST_ORDER = ("A", "B", "C", "D", "B", "A")
"""Order in which the points are reached (paper, Section IV.B)."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Events(Checked):
    """How gait events are told; all assumed."""

    touchdown_load: Any = number("", 0.001, 1, default=0.05)
    """Vertical force, in body weights, above which a foot, its heel or its forefoot is loaded
    [-]."""
    lift_load: Any = number("", 0.0005, 1, default=0.02)
    """Vertical force, in body weights, below which it is unloaded [-]."""
    shortest: Any = number("s", 0, 0.5, default=0.04)
    """Contacts and gaps shorter than this are not counted [s]."""

    def __post_init__(self) -> None:
        Checked.__post_init__(self)
        if self.lift_load > self.touchdown_load:
            raise InputError(
                "events",
                "events.lift_load",
                self.lift_load,
                f"must not be above touchdown_load, {self.touchdown_load}",
            )


@dataclass(frozen=True, eq=False, kw_only=True)
class Impact(Checked):
    """How impacts are measured; the paper states neither window nor filter."""

    window: Any = number("s", 0.005, 0.5, default=0.05)
    """Time after touchdown in which peak and impulse are taken [s]."""
    cutoff: Any = number("Hz", 0, 1000, default=50.0)
    """Cutoff frequency of the low-pass filter [Hz]; 0 for no filter."""
    order: Any = number("", 2, 8, default=4)
    """Order of the Butterworth filter, forwards and backwards together: 2, 4, 6 or 8."""

    def __post_init__(self) -> None:
        Checked.__post_init__(self)
        if self.order not in (2, 4, 6, 8):
            raise InputError("impact", "impact.order", self.order, "expects 2, 4, 6 or 8")


@dataclass(frozen=True, eq=False, kw_only=True)
class Steady(Checked):
    """Part of a walk that counts as steady."""

    begin: Any = number("m", 0, 1e5, default=4.0)
    """Distance from the start at which steady walking begins [m]."""
    end: Any = number("m", 0, 1e5, default=0.0)
    """Up to so far [m]; 0 for the whole distance."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Protocol(Checked):
    """The settings that all evaluation protocols share."""

    name: str
    trials: Any = number("", 1, MOST_TRIALS, default=10)
    """Number of trials, which run side by side, each from its own starting state."""
    seed: Any = number("", 0, 2**31, default=0)
    """Seed of the starting states; the same seed gives the same trials."""
    time_limit: Any = number("s", 0.5, 3600, default=40.0)
    """Time after which a trial ends without arrival [s]."""
    start: Start = field(default_factory=Start)
    """Spread of the starting states."""
    randomisation: Randomisation = field(default_factory=Randomisation)
    """Differences between the trials' robots; none by default."""
    events: Events = field(default_factory=Events)
    impact: Impact = field(default_factory=Impact)

    def __post_init__(self) -> None:
        Checked.__post_init__(self)
        for name in ("trials", "seed"):
            value = getattr(self, name)
            if value != int(value):
                raise InputError(self.name, name, value, "expects a whole number")

    def changed(self: P, **fields: Any) -> P:
        """Copy the protocol with other values of some fields.

        Args:
            fields: new values by name.

        Returns:
            The validated copy.

        Raises:
            InputError: a field that makes no sense.
        """
        return dataclasses.replace(self, **fields)


P = TypeVar("P", bound=Protocol)


@dataclass(frozen=True, eq=False, kw_only=True)
class WalkProtocol(Protocol):
    """Straight walks from standing, at a commanded speed, until a distance from the start."""

    name: str = "walk"
    speed: Any = number("m/s", 0.05, 10, default=1.33)
    """Commanded [m/s] (paper, Table III)."""
    distance: Any = number("m", 0.5, 1e4, default=20.0)
    """Distance from the start, straight ahead, at which a trial has arrived [m] (paper, Table
    III)."""
    heading_gain: Any = number("1/s", 0, 5, default=0.0)
    """Turning command over heading error; 0 leaves the policy to keep its heading by itself."""
    steady: Steady = field(default_factory=Steady)

    def __post_init__(self) -> None:
        Protocol.__post_init__(self)
        if self.distance > self.speed * self.time_limit:
            least = self.distance / self.speed
            raise InputError(
                self.name,
                "distance",
                self.distance,
                f"cannot be reached at {self.speed:g} m/s in time_limit; that takes {least:.1f} s",
            )
        if not self.steady.begin < self.steady_end <= self.distance:
            remedy = (
                f"expects begin below end, and end within distance, {self.distance:g} m; "
                f"set steady, such as {{begin: {self.distance / 5:g}}}"
            )
            raise InputError(self.name, "steady", [self.steady.begin, self.steady_end], remedy)

    @property
    def steady_end(self) -> float:
        """Distance from the start at which the steady part ends [m]."""
        return float(self.steady.end or self.distance)


@dataclass(frozen=True, eq=False, kw_only=True)
class TTestProtocol(Protocol):
    """Runs over a course of waypoints, given one after the other; the torso may turn as it
    likes.
    """

    name: str = "t_test"
    arrival: Any = number("m", 0.01, 5, default=0.5)
    """Distance that counts as reached [m]; the paper does not print it."""
    speed_cap: Any = number("m/s", 0.1, 10, default=3.4)
    """Speed that is asked for [m/s]."""
    lost: Any = number("m", 0.1, 1000, default=4.0)
    """Farther than this from the leg being run a trial ends [m]."""
    points: Mapping[str, tuple[float, float]] = field(default_factory=lambda: dict(T_TEST_POINTS))
    """Places by name, x ahead of the robot at the start, y to its left [m]."""
    order: tuple[str, ...] = T_TEST_ORDER
    """Points one after the other; the robot starts on the first."""

    def __post_init__(self) -> None:
        Protocol.__post_init__(self)
        if len(self.order) < 2:
            raise InputError(self.name, "order", list(self.order), "expects at least two points")
        for name in self.order:
            if name not in self.points:
                raise InputError(
                    self.name, "order", name, f"is not among points: {', '.join(self.points)}"
                )
        for before, after in zip(self.order[:-1], self.order[1:], strict=True):
            length = float(np.hypot(*np.subtract(self.points[after], self.points[before])))
            if length <= self.arrival:
                remedy = (
                    f"is unreachable: its leg of {length:g} m is no longer than arrival, "
                    f"{self.arrival:g} m"
                )
                raise InputError(self.name, "order", f"{before} to {after}", remedy)
        least = (course_length(self.course) - self.arrival * (len(self.order) - 1)) / self.speed_cap
        if least > self.time_limit:
            raise InputError(
                self.name,
                "time_limit",
                self.time_limit,
                f"is too short to reach all points; {least:.1f} s are needed at speed_cap",
            )

    @property
    def course(self) -> np.ndarray:
        """Waypoints from the start on, the first at the origin, `(k, 2)` [m]."""
        places = np.array([self.points[name] for name in self.order], float)
        return places - places[0]


_KINDS: dict[str, type[Protocol]] = {"walk": WalkProtocol, "t_test": TTestProtocol}


def load_protocol(name: str | Path) -> Protocol:
    """Read an evaluation protocol from a shipped file or a file of the user.

    Args:
        name: a shipped name, `walk` or `t_test`, or a YAML file.

    Returns:
        A `WalkProtocol` or a `TTestProtocol`, validated.

    Raises:
        InputError: names file, field, value and remedy.
    """
    path = resources.find_sim("protocol", name)
    return protocol_from_mapping(read_yaml(path), given_path(path))


def protocol_from_mapping(data: Mapping[str, Any], where: str) -> Protocol:
    """Build a protocol from nested mappings, as YAML gives them.

    Args:
        data: fields by name; `kind` is `walk` or `t_test`.
        where: name of the file, for error messages.

    Returns:
        The validated protocol.

    Raises:
        InputError: unknown or missing field, or a value that makes no sense, such as a waypoint
        that cannot be reached.
    """
    rest = dict(data)
    rest.pop("description", None)
    kind = rest.pop("kind", None)
    if kind not in _KINDS:
        raise InputError(where, "kind", kind, f"expects one of {', '.join(_KINDS)}")
    cls = _KINDS[kind]
    given: dict[str, Any] = {"name": rest.pop("name", kind)}
    if not isinstance(given["name"], str):
        raise InputError(where, "name", given["name"], "expects a text")
    if cls is TTestProtocol:
        if "points" in rest:
            given["points"] = _points(rest.pop("points"), where)
        if "order" in rest:
            given["order"] = _order(rest.pop("order"), where)
    sections = parameter_fields.section_types(cls)
    fields = {f.name: f for f in dataclasses.fields(cls)}
    known = [
        *(n for n, f in fields.items() if n in sections or parameter_fields.is_leaf(f)),
        *(("points", "order") if cls is TTestProtocol else ()),
    ]
    try:
        for key, value in rest.items():
            if key not in known:
                raise InputError(
                    where, str(key), value, parameters.unknown(str(key), sorted(known))
                )
            if key in sections:
                given[key] = parameters.from_mapping(sections[key], value, where, key)
            else:
                plain, _ = parameters.labelled(value, where, key)
                given[key] = parameters.checked(
                    plain, parameter_fields.rule_of(fields[key]), where, key
                )
        return cls(**given)
    except InputError as error:
        raise InputError(where, error.field, error.value, error.remedy) from None


def protocol_mapping(protocol: Protocol) -> dict[str, Any]:
    """Write a protocol out as nested mappings, with every value.

    Args:
        protocol: the protocol.

    Returns:
        A mapping from which `protocol_from_mapping` builds the same protocol.
    """
    kind = next(k for k, cls in _KINDS.items() if type(protocol) is cls)
    mapping: dict[str, Any] = {"kind": kind, "name": protocol.name}
    for item in dataclasses.fields(protocol):
        value = getattr(protocol, item.name)
        if parameter_fields.is_leaf(item):
            mapping[item.name] = value
        elif dataclasses.is_dataclass(value):
            mapping[item.name] = parameters.leaves(value)
    if isinstance(protocol, TTestProtocol):
        mapping |= {
            "points": {name: list(place) for name, place in protocol.points.items()},
            "order": list(protocol.order),
        }
    return mapping


def _points(data: Any, where: str) -> dict[str, tuple[float, float]]:
    if not isinstance(data, Mapping) or not data:
        raise InputError(where, "points", data, "expects names with places [x, y] in metres")
    rule = parameter_fields.Rule("number", "m", -1e4, 1e4, size=2)
    points = {}
    for name, value in data.items():
        x, y = parameters.checked(value, rule, where, f"points.{name}")
        points[str(name)] = (float(x), float(y))
    return points


def _order(data: Any, where: str) -> tuple[str, ...]:
    if not isinstance(data, list) or not all(isinstance(name, str) for name in data):
        raise InputError(where, "order", data, "expects a list of names of points")
    return tuple(data)
