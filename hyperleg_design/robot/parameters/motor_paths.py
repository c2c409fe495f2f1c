"""Motors that a file names by the paths of their own files."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from pathlib import Path
from typing import Any

SECTIONS = ("actuators", "reference")
"""Sections of a design in which motors are named."""


def with_motor_paths(data: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Make paths of motors in a file count from the working directory.

    A path that is no file there, but one from the folder of the file, is meant from that folder.

    Args:
        data: what the file holds, nested.
        folder: in which the file lies.

    Returns:
        The same with such paths replaced; values of any other kind are left to later checks.
    """
    named = {name: copy.deepcopy(data[name]) for name in SECTIONS if name in data}
    for section, key in motor_places(named):
        section[key] = path_from_here(section[key], folder)
    return {**data, **named}


def motor_places(data: dict[str, Any]) -> list[tuple[dict[str, Any], str]]:
    """List where a design names its motors.

    Args:
        data: what its file holds, nested.

    Returns:
        Mappings within `data` and the keys in them that hold the names.
    """
    places = []
    for key, value in data.items():
        inner = isinstance(value, dict)
        if str(key).split("_")[-1] == "motor" and (not inner or "value" in value):
            places.append((value, "value") if inner else (data, key))
        elif inner:
            places += motor_places(value)
    return places


def path_from_here(named: Any, folder: Path) -> Any:
    """Find a YAML file, of a motor or a design, that another file names.

    Args:
        named: a name or a path, as the file holds it.
        folder: in which the file lies.

    Returns:
        The path from the working directory, where it is that of a file from the folder only; else
        what the file holds.
    """
    if not isinstance(named, str) or not named.endswith(".yaml") or Path(named).is_file():
        return named
    beside = folder / named
    return str(beside) if beside.is_file() else named
