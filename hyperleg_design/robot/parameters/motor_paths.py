"""Motors that a file names by the paths of their own files."""

from __future__ import annotations

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
    replaced = dict(data)
    for name in SECTIONS:
        section = data.get(name)
        if isinstance(section, Mapping):
            replaced[name] = {
                part: _part(entry, folder) if isinstance(entry, Mapping) else entry
                for part, entry in section.items()
            }
    return replaced


def _part(entry: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    motor = entry.get("motor")
    if isinstance(motor, Mapping):
        return {**entry, "motor": {**motor, "value": path_from_here(motor.get("value"), folder)}}
    return {**entry, "motor": path_from_here(motor, folder)} if "motor" in entry else dict(entry)


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
