"""PACE's `.pt` files: `time` (t,), `dof_pos` (t, n), `des_dof_pos` (t, n), saved by torch.

Also read where present: `dof_vel` or `velocity`, `dof_torque`, `torque` or `tau`, `joint_names`.
The source lacks names of the joints, gains, torques and the robot's name; a side file may say them
(`joints`, `gains`, `robot`).
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.columns import columns_of
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.readers.pickle_tensors import read_tensors
from hyperleg_design.gap.logs.readers.source import beside, build_log, joint_names, lacks

SIGNALS = {
    "dof_pos": "position",
    "des_dof_pos": "position_target",
    "dof_vel": "velocity",
    "velocity": "velocity",
    "dof_torque": "joint_torque",
    "torque": "joint_torque",
    "tau": "joint_torque",
}
"""Signal by key of the file."""


def read_pace(path: Path, metadata: Mapping[str, Any] | None = None) -> list[Log]:
    """Read a PACE file.

    Args:
        path: of the file.
        metadata: fields that take precedence.

    Returns:
        One log.

    Raises:
        InputError: damaged, without time or positions, or tensors of other lengths.
    """
    content = read_tensors(path)
    user_metadata = beside(path, metadata)
    for key in ("time", "dof_pos"):
        if not isinstance(content.get(key), np.ndarray):
            remedy = "is missing: expects PACE's tensors time, dof_pos, des_dof_pos"
            raise InputError(path.name, key, sorted(map(str, content))[:8], remedy)
    time = np.asarray(content["time"], float).reshape(-1)
    shape = content["dof_pos"].shape
    if len(shape) != 2 or shape[0] != len(time):
        raise InputError(path.name, "dof_pos", shape, f"expects ({len(time)}, joints)")
    stated_names = content.get("joint_names")
    named = isinstance(stated_names, list | tuple) and len(stated_names) == shape[1]
    names = list(map(str, stated_names or ())) if named else [f"joint_{i}" for i in range(shape[1])]
    joints = joint_names(user_metadata, names, path.name)
    signals: dict[str, np.ndarray] = {}
    for key, signal in SIGNALS.items():
        if key in content:
            values = np.asarray(content[key], float)
            if values.shape != shape:
                raise InputError(path.name, key, values.shape, f"expects {shape}, as dof_pos")
            signals |= columns_of({signal: values}, joints)
    remarks = []
    if "joints" not in user_metadata and not named:
        remarks.append(
            "the source names no joints: joint_0, joint_1, ... in its order; say `joints` in a "
            "side file"
        )
    if lacking := lacks({column.partition("/")[0] for column in signals}):
        remarks.append(f"the source lacks {', '.join(lacking)}")
    if not user_metadata.get("gains"):
        remarks.append(
            "the source lacks the controller's gains: without them targets say nothing; say "
            "`gains` in a side file"
        )
    return [build_log(path, path.stem, time, signals, {}, user_metadata, remarks)]
