"""What all readers share: metadata from beside a source, joints renamed, clocks that start at
zero.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Set
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.log import Log, finished_log
from hyperleg_design.gap.logs.metadata import Metadata, metadata_from_mapping, read_metadata_mapping

FOLDER_FILE = "hyperleg.json"
"""Side file inside a folder that is one recording."""
WANTED = {"position_target": "targets", "velocity": "velocities", "joint_torque": "torques"}
"""Signals of joints that a diagnosis wants beside positions."""
LATEST_START = 1e6
"""Clocks that start later count from the epoch and are shifted to start at zero [s]."""


def side_file(path: Path) -> Path:
    """Name the file in which a user writes metadata of a source: `hyperleg.json` in a folder, else
    `NAME.json` beside it; `NAME.json` beside a file, or `NAME.meta.json` beside a JSON file.

    Args:
        path: of the source.

    Returns:
        The path of the side file, which need not exist.
    """
    if path.is_dir():
        outside = path.parent / f"{path.name}.json"
        inside = path / FOLDER_FILE
        return outside if outside.is_file() and not inside.is_file() else inside
    return path.with_suffix(".meta.json" if path.suffix.lower() == ".json" else ".json")


def beside(path: Path, given: Mapping[str, Any] | None) -> dict[str, Any]:
    """Collect what a user states about a source: its side file, and what was given to the reader,
    which takes precedence.

    Args:
        path: of the source.
        given: fields given to the reader.

    Returns:
        Fields by name.
    """
    side = side_file(path)
    return {**(read_metadata_mapping(side) if side.is_file() else {}), **(given or {})}


def joint_names(user_metadata: Mapping[str, Any], source_names: list[str], where: str) -> list[str]:
    """Choose the names of a source's joints: those that a user gives as `joints`, else the
    source's own.

    Args:
        user_metadata: fields that the user states.
        source_names: names in the source's order.
        where: source, for error messages.

    Returns:
        The names in the source's order.

    Raises:
        InputError: another number of names.
    """
    names = user_metadata.get("joints", source_names)
    if (
        not isinstance(names, list | tuple)
        or len(names) != len(source_names)
        or not all(isinstance(n, str) for n in names)
    ):
        remedy = f"expects a list of {len(source_names)} names, in the order of the source"
        raise InputError(where, "joints", names, remedy)
    if len(set(names)) != len(names):
        raise InputError(where, "joints", names, "expects different names")
    return list(names)


def lacks(signals: Set[str]) -> list[str]:
    """Name what a source of joints lacks, for its remarks.

    Args:
        signals: that it has.

    Returns:
        Their names in the plural.
    """
    return [name for signal, name in WANTED.items() if signal not in signals]


def build_log(
    path: Path,
    name: str,
    time: np.ndarray,
    signals: Mapping[str, np.ndarray],
    source_metadata: Mapping[str, Any],
    user_metadata: Mapping[str, Any],
    remarks: Iterable[str],
) -> Log:
    """Build a log from a source; what the user states takes precedence over what the source states.

    Args:
        path: of the source.
        name: of the log.
        time: [s], `(t,)`.
        signals: by column, `(t,)` each.
        source_metadata: metadata that the source states.
        user_metadata: metadata that the user states.
        remarks: of the reader.

    Returns:
        The log.

    Raises:
        InputError: an unusable clock, no position, or bad metadata.
    """
    user_metadata = {
        key: value
        for key, value in user_metadata.items()
        if key not in ("joints", "columns", "units")
    }
    time = np.asarray(time, float)
    extra = dict(source_metadata.get("extra", {}))
    if len(time) and np.isfinite(time[0]) and abs(time[0]) > LATEST_START:
        extra["start_time"] = float(time[0])
        time = time - time[0]
    metadata: Metadata = metadata_from_mapping(
        {**source_metadata, "extra": extra, **user_metadata},
        side_file(path).name if user_metadata else path.name,
    )
    return finished_log(path, time, signals, metadata, remarks, name)
