"""The nominal model of a robot, made to fit its logs."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Iterable, Sequence
from pathlib import Path

import numpy as np

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.design_subject import of_design
from hyperleg_design.gap.model.file_subject import of_file
from hyperleg_design.gap.model.subject import Subject, index_of, motor_index
from hyperleg_design.gap.signals.gearing import on_the_joints_side
from hyperleg_design.robot.load import load_robot

FULL = 95.0
"""Percentile of a battery's voltage that stands for its largest."""


def load_subject(
    robot: str | Path | None = None,
    logs: Sequence[Log] = (),
    *,
    overrides: Iterable[str] | None = None,
    base: str = "",
    joints: Collection[str] = (),
) -> Subject:
    """Load the nominal model of a robot and make it fit logs.

    Args:
        robot: a design of ours (`hyperleg`, or a YAML file), or any MJCF or URDF file; by default
            what the logs' metadata name.
        logs: whose metadata say what holds the base, gains, torque constants and payload; joints
            that none of them knows are held still. What differs between logs is taken from the
            first here, and from each in `conditioning.condition`.
        overrides: of our design, `path=value` each; by default those of the logs.
        base: `fixed` or `floating`; by default as the logs say, else as in the file.
        joints: that move, where there are no logs; all by default.

    Returns:
        The robot.

    Raises:
        InputError: no such robot, a joint or motor of a log that it does not have, logs that
        contradict each other, a file that
            cannot be understood.
    """
    metadata = [log.metadata for log in logs]
    named = not robot
    robot = str(robot) if robot else _agreed([m.robot for m in metadata], "robot", logs)
    base = base or _agreed([m.base for m in metadata], "base", logs)
    if not robot:
        remedy = (
            "is not named: give --robot a design, an MJCF or a URDF, or name it in the logs' "
            "metadata"
        )
        raise InputError("robot", "", None, remedy)
    stated = next((m.overrides for m in metadata if m.overrides), ())
    chosen = stated if overrides is None else tuple(overrides)
    path = _find(robot, logs, named)
    known = set(joints).union(*(log.joints for log in logs)) if joints or logs else None
    if path.suffix.lower() in (".yaml", ".yml"):
        bare = of_design(load_robot(path, overrides=chosen), path, base, known)
    else:
        if chosen:
            raise InputError(
                robot, "overrides", chosen[0], "belong to designs of ours; edit the file instead"
            )
        bare = of_file(path, base or None, known)
    for log in logs:
        _check_names(log, bare)
    if np.isnan(bare.voltage):
        bare = dataclasses.replace(bare, voltage=_healthy_voltage(logs))
    bare = on_the_joints_side(bare, logs)
    return bare.declare(metadata[0]) if metadata else dataclasses.replace(bare, bare=bare)


def _healthy_voltage(logs: Sequence[Log]) -> float:
    """Largest that reference logs show, but for spikes; NaN where none does."""
    known = [log.column("battery_voltage") for log in logs if log.metadata.role == "reference"]
    full = [float(np.nanpercentile(v, FULL)) for v in known if np.isfinite(v).any()]
    return max(full, default=float("nan"))


def _agreed(values: Sequence[str], field: str, logs: Sequence[Log]) -> str:
    stated = {v: log.name for v, log in zip(values, logs, strict=True) if v}
    if len(stated) > 1:
        values_by_log = ", ".join(f"{v} ({name})" for v, name in stated.items())
        raise InputError(
            "logs", field, values_by_log, "differ: diagnose logs of one robot at a time"
        )
    return next(iter(stated), "")


def _find(robot: str, logs: Sequence[Log], named: bool) -> Path:
    """File of a robot: as it stands, beside the logs, which come first where it is they that
    `named` it, or a shipped design.
    """
    path = Path(robot)
    beside = [Path(log.folder) / path for log in logs if log.folder]
    for place in (*beside, path) if named else (path, *beside):
        if place.suffix.lower() in (".xml", ".mjcf", ".urdf", ".yaml", ".yml") and place.is_file():
            return place
    if path.suffix.lower() in (".xml", ".mjcf", ".urdf"):
        raise InputError("robot", "", robot, "no such file")
    return resources.find("descriptions", robot)


def _check_names(log: Log, subject: Subject) -> None:
    for joint in log.names("position", "position_target", "velocity", "joint_torque"):
        if joint not in subject.unlogged:
            index_of(joint, subject.joints, f"{log.name}: position", "joint")
    for joint in log.metadata.gains:
        if joint not in subject.unlogged:
            index_of(joint, subject.joints, f"{log.name}: gains", "joint")
    for joint in log.metadata.torque_sensors:
        index_of(
            joint, (*subject.joints, *subject.unlogged), f"{log.name}: torque_sensors", "joint"
        )
    for field in ("torque_constant", "supply"):
        for motor in getattr(log.metadata, field):
            motor_index(subject, motor, f"{log.name}: {field}")
    motors = {*subject.motors, *subject.motor_aliases, *subject.unlogged}
    for motor in log.motors:
        if motor not in motors and subject.unlogged:
            remedy = (
                f"drives nothing that is logged; without positions, these joints are held still: "
                f"{', '.join(subject.unlogged)}"
            )
            raise InputError(log.name, "motor", motor, remedy)
        if motor not in subject.unlogged:
            motor_index(subject, motor, f"{log.name}: motor")
