"""Motors that are not shipped, put beside a design so that it can be read anywhere."""

from __future__ import annotations

from typing import Any

from hyperleg_design.errors import InputError
from hyperleg_design.robot.motors import own_file
from hyperleg_design.robot.parameters.motor_paths import motor_places

FOLDER = "own_motors"
"""Folder beside a design that holds the files of its motors."""


def motors_beside(mapping: dict[str, Any]) -> dict[str, bytes]:
    """Name the motors of a design that are not shipped by files beside it.

    Args:
        mapping: of a design, as its `to_mapping` gives it; the names of such motors are replaced by
            the paths of their files.

    Returns:
        The content of those files, by their path from the design's folder.

    Raises:
        InputError: two motors whose files differ have the same name.
    """
    files: dict[str, bytes] = {}
    for section, key in motor_places(mapping):
        name = section[key]
        path = own_file(name)
        if path is None:
            continue
        beside, content = f"{FOLDER}/{path.name}", path.read_bytes()
        if files.setdefault(beside, content) != content:
            remedy = "is the name of another motor of the design too; rename the file"
            raise InputError("motors", "", str(path), remedy)
        section[key] = beside
    return files
