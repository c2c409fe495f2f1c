"""What a log says about its robot besides the signals: gains, torque constants, payload, base,
session.
"""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hyperleg_design.errors import InputError
from hyperleg_design.reading import read_json

STANDARD_GRAVITY = (0.0, 0.0, -9.81)
"""Where nothing else is said; the value MuJoCo uses [m/s^2]."""
MAX_GRAVITY = 30.0
"""Above that of any planet a robot stands on [m/s^2]: another unit."""
BASES = ("", "fixed", "floating")
"""What holds the robot's base; empty, what its model says."""
TARGETS = ("", "kept", "moving")
"""What position targets do from row to row: stay until the next one, as where a policy or a script
sets them, or move evenly, as where a faster controller makes them; empty, `KEPT_FROM` decides."""
KEPT_FROM = 0.008
"""Time between rows from which targets are taken to be kept [s] (assumed)."""
ROLES = ("test", "reference")
"""A reference log is of the same robot in a state known to be well modelled."""


@dataclass(frozen=True)
class Metadata:
    """Beside the signals of one log; checked when made.

    Raises:
        InputError: a value of the wrong kind or out of range.
    """

    robot: str = ""
    """Name of a design, or an MJCF or URDF file; empty, what the command line says."""
    overrides: tuple[str, ...] = ()
    """Of the design, `PATH=VALUE` each."""
    base: str = ""
    """How the base is held, one of `BASES`."""
    gravity: tuple[float, float, float] = STANDARD_GRAVITY
    """In the world, z up, unless the base stands tilted [m/s^2]."""
    gains: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Of the position controller by joint: stiffness [Nm/rad], damping [Nms/rad], at the joint."""
    torque_constant: Mapping[str, float] = field(default_factory=dict)
    """By motor [Nm/A], of the torque that `motor_torque` means."""
    supply: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    """By motor without current control, whose duty cycle follows the gains: nominal supply [V], and
    stall torque [Nm] and no-load speed [rad/s] at it. Their stiffness and their limits follow the
    logged voltage of the battery."""
    targets: str = ""
    """What targets do between rows, one of `TARGETS`."""
    torque_sensors: tuple[str, ...] = ()
    """Joints whose `joint_torque` a sensor between gear and link measures, so that friction and
    rotors act before it."""
    payload: Mapping[str, tuple[float, float, float, float]] = field(default_factory=dict)
    """What hangs on the robot by link: mass [kg], centre of mass in the link's frame x, y, z
    [m]."""
    session: str = ""
    """Logs of one session share one assembly, calibration and temperature; empty, a session of its
    own."""
    role: str = "test"
    """What the log is for, one of `ROLES`."""
    notes: str = ""
    """Free text for people."""
    remarks: tuple[str, ...] = ()
    """What the source lacks and what a reader changed; the answer is weaker by these."""
    extra: Mapping[str, Any] = field(default_factory=dict)
    """Keys that this format does not know, as found."""

    def __post_init__(self) -> None:
        """Check."""
        checked = _checked({k: getattr(self, k) for k in FIELDS}, "metadata")
        for key, value in checked.items():
            object.__setattr__(self, key, value)
        object.__setattr__(self, "extra", _mapping(self.extra, "metadata", "extra"))

    def changed(self, **values: Any) -> Metadata:
        """Copy the metadata with other values of some fields.

        Args:
            values: new values by field.

        Returns:
            The validated copy.
        """
        return dataclasses.replace(self, **values)

    def remarked(self, *remarks: str) -> Metadata:
        """Copy the metadata with remarks added, each once.

        Args:
            remarks: the remarks.

        Returns:
            The copy.
        """
        return self.changed(remarks=tuple(dict.fromkeys((*self.remarks, *remarks))))

    def mapping(self) -> dict[str, Any]:
        """Write the metadata as JSON holds them.

        Returns:
            Fields by name; those at their defaults are left out, and unknown keys lie beside the
            known ones.
        """
        default = Metadata()
        known = {
            k: getattr(self, k)
            for k in FIELDS
            if k != "extra" and getattr(self, k) != getattr(default, k)
        }
        plain: dict[str, Any] = json.loads(json.dumps(known, allow_nan=False))
        return {**self.extra, **plain}


FIELDS = tuple(f.name for f in dataclasses.fields(Metadata))
NUMBERS: dict[str, tuple[int, Callable[[Any], bool], str]] = {
    "gains": (
        2,
        lambda pair: min(pair) >= 0,
        "expects [stiffness Nm/rad, damping Nms/rad], neither negative",
    ),
    "torque_constant": (
        0,
        lambda constant: constant > 0,
        "expects Nm/A, above 0; change the sign of a current that counts the other way",
    ),
    "supply": (
        3,
        lambda line: min(line) > 0,
        "expects [supply V, stall torque Nm, no-load speed rad/s], all above 0",
    ),
    "payload": (4, lambda load: load[0] >= 0, "expects [mass kg, x, y, z m], mass not negative"),
}
"""Fields with numbers by name of a joint, motor or link: how many there are, 0 for a single one,
which of them can be, and what is expected."""


def metadata_from_mapping(content: Mapping[str, Any], where: str) -> Metadata:
    """Build metadata from what a JSON file holds; unknown keys go to `extra`.

    Args:
        content: fields by name.
        where: file, for error messages.

    Returns:
        The validated metadata.

    Raises:
        InputError: a value of the wrong kind or out of range, with its place.
    """
    content = _mapping(content, where, "")
    extra = {
        **_mapping(content.get("extra", {}), where, "extra"),
        **{k: v for k, v in content.items() if k not in FIELDS},
    }
    return Metadata(**_checked(content, where), extra=extra)


def _checked(content: Mapping[str, Any], where: str) -> dict[str, Any]:
    checks: dict[str, Callable[[Any, str, str], Any]] = {
        **dict.fromkeys(("robot", "base", "targets", "session", "role", "notes"), _text),
        **dict.fromkeys(NUMBERS, _numbers_by_name),
        "overrides": _overrides,
        "gravity": _gravity,
        **dict.fromkeys(("remarks", "torque_sensors"), _texts),
    }
    values = {
        key: check(content[key], where, key) for key, check in checks.items() if key in content
    }
    for key, allowed in (("base", BASES), ("targets", TARGETS), ("role", ROLES)):
        if key in values and values[key] not in allowed:
            remedy = f"expects {' or '.join(a for a in allowed if a)}"
            raise InputError(where, key, values[key], remedy)
    return values


def read_metadata_mapping(path: Path) -> dict[str, Any]:
    """Read the mapping of a side file with metadata.

    Args:
        path: of the file.

    Returns:
        Fields by name.

    Raises:
        InputError: unreadable, no JSON, or no mapping.
    """
    return _mapping(read_json(path, path.name), path.name, "")


def _mapping(value: Any, where: str, name: str) -> dict[str, Any]:
    if not isinstance(value, Mapping) or not all(isinstance(k, str) for k in value):
        raise InputError(where, name, value, "expects names with values, { ... }")
    return dict(value)


def _text(value: Any, where: str, name: str) -> str:
    if not isinstance(value, str):
        raise InputError(where, name, value, "expects a text")
    return value


def _texts(value: Any, where: str, name: str) -> tuple[str, ...]:
    if isinstance(value, str) or not isinstance(value, list | tuple):
        raise InputError(where, name, value, "expects a list of texts")
    return tuple(_text(v, where, name) for v in value)


def _overrides(value: Any, where: str, name: str) -> tuple[str, ...]:
    if isinstance(value, Mapping):
        return tuple(f"{key}={v}" for key, v in _mapping(value, where, name).items())
    return _texts(value, where, name)


def _number(value: Any, where: str, name: str) -> float:
    number = value.item() if hasattr(value, "item") and getattr(value, "size", 1) == 1 else value
    if isinstance(number, bool) or not isinstance(number, int | float) or not math.isfinite(number):
        raise InputError(where, name, value, "expects a finite number")
    return float(number)


def _numbers(value: Any, count: int, where: str, name: str) -> tuple[float, ...]:
    values = value.tolist() if hasattr(value, "tolist") else value
    if not isinstance(values, list | tuple) or len(values) != count:
        raise InputError(where, name, value, f"expects {count} numbers")
    return tuple(_number(v, where, name) for v in values)


def _gravity(value: Any, where: str, name: str) -> tuple[float, ...]:
    gravity = _numbers(value, 3, where, name)
    if math.hypot(*gravity) > MAX_GRAVITY:
        raise InputError(where, name, value, "expects m/s^2, such as [0, 0, -9.81]")
    return gravity


def _numbers_by_name(value: Any, where: str, name: str) -> dict[str, Any]:
    count, fits, remedy = NUMBERS[name]
    numbers_by_name = {}
    for key, numbers in _mapping(value, where, name).items():
        place, flat = f"{name}.{key}", numbers
        if name == "payload" and isinstance(flat, list | tuple) and len(flat) == 2:
            mass, com = flat
            flat = [mass, *com] if isinstance(com, list | tuple) else flat
        numbers_by_name[key] = (
            _numbers(flat, count, where, place) if count else _number(flat, where, place)
        )
        if not fits(numbers_by_name[key]):
            raise InputError(where, place, numbers, remedy)
    return numbers_by_name
