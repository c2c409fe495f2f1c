"""LeRobot datasets (codebase v2.0 to v3.0): `meta/info.json` and Parquet tables under `data`, one
log an episode.

`observation.state` is taken as positions, `action` as their targets, `observation.velocity` and
`observation.effort` where a dataset has them, and so are `observation.base_position`,
`observation.base_orientation` and `observation.base_velocity` of a floating base, whose columns
must be named x, y, z (w, x, y, z). The source lacks gains, torques and, in most
datasets, velocities; its time stamps are the frame number over the frame rate, not measured. Arms
of the SO, Koch and similar families are in degrees with the gripper as 0 .. 100; a side file
`hyperleg.json` may say `units: {"position": "deg"}` or `"rad"`. Joints in normalised units (-100 ..
100) look like
degrees: only the dataset's author knows.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError, in_short
from hyperleg_design.gap.logs import blocks
from hyperleg_design.gap.logs.columns import columns_of
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.readers.source import (
    FOLDER_FILE,
    beside,
    build_log,
    joint_names,
    lacks,
)
from hyperleg_design.gap.logs.readers.units import FACTORS
from hyperleg_design.reading import read_json

IN_DEGREES = ("so100", "so101", "so_", "koch", "moss", "lekiwi", "omx", "bi_so")
"""Beginnings of `robot_type` whose joints are in degrees."""
SIGNALS = {
    "observation.state": "position",
    "action": "position_target",
    "observation.velocity": "velocity",
    "observation.effort": "joint_torque",
}
"""Signal of the log by feature of the dataset."""
BASE = {
    "observation.base_position": ("base_position", ["x", "y", "z"]),
    "observation.base_orientation": ("base_orientation", ["w", "x", "y", "z"]),
    "observation.base_velocity": ("base_velocity", ["x", "y", "z"]),
}
"""Signal of the log and names of its columns by feature of a floating base."""
LARGEST_ANGLE = 4 * math.pi
"""Positions beyond are not radians."""


def is_lerobot(path: Path) -> bool:
    """Decide whether a folder is a LeRobot dataset.

    Args:
        path: of the folder.

    Returns:
        True if it is.
    """
    return path.is_dir() and (path / "meta" / "info.json").is_file()


def read_lerobot(path: Path, metadata: Mapping[str, Any] | None = None) -> list[Log]:
    """Read a LeRobot dataset.

    Args:
        path: of the folder.
        metadata: fields that take precedence.

    Returns:
        A log of each episode, in order.

    Raises:
        InputError: no `observation.state`, unreadable tables, or positions whose unit is not known.
    """
    info = _info(path)
    user_metadata = beside(path, metadata)
    features = info.get("features", {})
    if "observation.state" not in features:
        where = f"{path.name}/meta/info.json"
        raise InputError(where, "features", sorted(features)[:6], "expects observation.state")
    motor_names = _names(features["observation.state"])
    joints = joint_names(user_metadata, motor_names, path.name)
    base = {
        feature: (signal, names)
        for feature, (signal, names) in BASE.items()
        if feature in features and _names(features[feature]) == names
    }
    table, rows_read, rows = _table(path, [*(f for f in SIGNALS if f in features), *base])
    scale, remarks = _scale(info, user_metadata, motor_names, table, path.name)
    remarks.append("time stamps are frame numbers over the frame rate, not measured")
    if rows_read < rows:
        remarks.append(blocks.shortened(rows, rows_read))
    lacking = lacks({signal for feature, signal in SIGNALS.items() if feature in features})
    if not user_metadata.get("gains"):
        lacking.append("gains")
    if lacking:
        remarks.append(f"the source lacks {', '.join(lacking)}")
    place = {
        feature: _columns(
            feature, _names(features[feature]), table[feature], motor_names, path.name
        )
        for feature in SIGNALS
        if feature in table
    }
    logs: list[Log] = []
    for episode in np.unique(table["episode_index"]):
        in_episode = table["episode_index"] == episode
        if in_episode.sum() < 2:
            continue
        signals: dict[str, np.ndarray] = {}
        for feature, columns in place.items():
            signal, logged = SIGNALS[feature], [joints[joint] for joint in columns]
            factors = scale[list(columns)] if signal != "joint_torque" else 1.0
            values = table[feature][in_episode][:, list(columns.values())]
            signals |= columns_of({signal: values * factors}, logged)
        for feature, (signal, names) in base.items():
            signals |= columns_of({signal: table[feature][in_episode]}, names)
        name = f"{path.name}_{int(episode):06d}"
        about: tuple[str, ...] = ("robot_type", "fps", "codebase_version")
        extra = {key: info[key] for key in about if key in info} | {"episode": int(episode)}
        time = table["timestamp"][in_episode]
        log = build_log(path, name, time, signals, {"extra": extra}, user_metadata, remarks)
        logs.append(dataclasses.replace(log, folder=str(path)))
    if not logs:
        raise InputError(path.name, "", None, "is an empty log: no episode has two frames")
    return logs


def _info(path: Path) -> dict[str, Any]:
    where = f"{path.name}/meta/info.json"
    info = read_json(path / "meta" / "info.json", where)
    if not isinstance(info, dict) or not isinstance(info.get("features", {}), dict):
        raise InputError(where, "", None, "expects a mapping with features")
    return info


def _names(feature: Mapping[str, Any]) -> list[str]:
    """Names of a feature's columns, numbers where it has none."""
    names = feature.get("names")
    if isinstance(names, dict):  # {"motors": [...]}
        names = next((v for v in names.values() if isinstance(v, list)), None)
    size = int((feature.get("shape") or [len(names or [])])[0])
    if names is None or len(names) != size:
        return [f"joint_{i}" for i in range(size)]
    return [str(name).removesuffix(".pos") for name in names]


def _columns(
    feature: str, names: list[str], values: np.ndarray, joints: list[str], where: str
) -> dict[int, int]:
    """Column of a feature by place of the joint: by its name, or by its place where the feature
    names no joint.

    Raises:
        InputError: no names tell which column is which joint's, and the number of columns differs.
    """
    width = values.shape[1] if values.ndim == 2 else 1
    by_name = {place: names.index(joint) for place, joint in enumerate(joints) if joint in names}
    if by_name and len(names) == width:
        return by_name
    if width != len(joints):
        remedy = f"expects a column for each of {len(joints)} joints, or names of its columns"
        raise InputError(f"{where}/meta/info.json", f"features.{feature}", width, remedy)
    return {place: place for place in range(width)}


def _table(path: Path, features: list[str]) -> tuple[dict[str, np.ndarray], int, int]:
    """Columns of all tables `(t,)` or `(t, n)`, rows read and rows there are."""
    import pyarrow
    import pyarrow.parquet

    files = sorted((path / "data").rglob("*.parquet"))
    if not files:
        remedy = "holds no Parquet tables: download the dataset with its data"
        raise InputError(f"{path.name}/data", "", None, remedy)
    columns = ["timestamp", "episode_index", *features]
    parts: dict[str, list[np.ndarray]] = {c: [] for c in columns}
    read, rows, held = 0, 0, 0
    for file in files:
        try:
            with pyarrow.parquet.ParquetFile(file) as source:
                rows += source.metadata.num_rows
                if held > blocks.MAX_VALUES:
                    continue
                for batch in source.iter_batches(
                    blocks.BLOCK_ROWS, columns=columns, use_threads=False
                ):
                    for column in columns:
                        parts[column].append(
                            _array(batch.column(column), f"{path.name}/{file.name}", column)
                        )
                        held += parts[column][-1].size
                    read += batch.num_rows
        except (pyarrow.ArrowException, OSError, KeyError) as error:
            raise InputError(
                f"{path.name}/{file.name}", "", None, f"is no whole table ({in_short(error, 80)})"
            ) from None
    try:
        return {c: np.concatenate(p) for c, p in parts.items()}, read, rows
    except ValueError:
        raise InputError(path.name, features[0], None, "has another size in some tables") from None


def _array(column: Any, where: str, name: str) -> np.ndarray:
    import pyarrow

    if pyarrow.types.is_nested(column.type):
        flat = np.asarray(column.flatten().to_numpy(zero_copy_only=False), float)
        if len(column) and len(flat) % len(column):
            raise InputError(where, name, None, "has another size in some rows")
        return flat.reshape(len(column), -1)
    return np.asarray(column.to_numpy(zero_copy_only=False), float)


def _scale(
    info: Mapping[str, Any],
    user_metadata: Mapping[str, Any],
    names: list[str],
    table: Mapping[str, np.ndarray],
    where: str,
) -> tuple[np.ndarray, list[str]]:
    """Factor of each joint to rad, and what was assumed."""
    units = user_metadata.get("units", {})
    unit = units.get("position") if isinstance(units, Mapping) else None
    kind = str(info.get("robot_type") or "")
    remarks = []
    if unit is None:
        if kind.startswith(IN_DEGREES):
            unit = "deg"
            remarks.append(f"positions are taken as degrees, as {kind} has them by default")
        elif np.nanmax(np.abs(table["observation.state"]), initial=0) > LARGEST_ANGLE:
            largest = round(float(np.nanmax(np.abs(table["observation.state"]))), 3)
            remedy = (
                f'is no angle in rad: say `"units": {{"position": "deg"}}` in {where}/{FOLDER_FILE}'
            )
            raise InputError(where, "units.position", largest, remedy)
        else:
            unit = "rad"
            remarks.append("positions are taken as rad: the source does not say")
    if unit not in FACTORS["rad"]:
        raise InputError(
            where, "units.position", unit, f"expects one of {', '.join(FACTORS['rad'])}"
        )
    scale = np.full(len(names), FACTORS["rad"][unit])
    grippers = [i for i, name in enumerate(names) if "gripper" in name]
    if kind.startswith(IN_DEGREES) and grippers:
        scale[grippers] = 0.01
        remarks.append(
            "the gripper is logged as 0 .. 100 and given as 0 .. 1, not as an angle: leave it out "
            "of the robot"
        )
    return scale, remarks
