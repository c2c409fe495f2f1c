"""The robot that logs are diagnosed against: its nominal model, from a design of ours or from
anybody's MJCF or URDF.
"""

from __future__ import annotations

import dataclasses
import difflib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.metadata import STANDARD_GRAVITY, Metadata
from hyperleg_design.gap.model import robot_file
from hyperleg_design.gap.model.mechanism import Mechanism, mechanism_of, pinocchio_model

if TYPE_CHECKING:
    import mujoco
    import pinocchio

    from hyperleg_design.gap.logs.log import Log
    from hyperleg_design.robot.design import Design

FULL = 95.0
"""Percentile of a battery's voltage that stands for its largest."""


@dataclass(frozen=True)
class Pad:
    """A place that may touch the ground."""

    name: str
    foot: int
    """Of `Subject.feet`."""
    link: int
    """Of `Mechanism.links`."""
    position: tuple[float, float, float]
    """Of its centre in the link's frame [m]."""
    radius: float
    """[m]"""


@dataclass(frozen=True, eq=False)
class Subject:
    """Nominal robot: `n` joints, `m` motors; tau_joint = joint_from_motor tau_motor, motor speed =
    its transpose times joint speed.
    """

    name: str
    path: str
    """File it was read from."""
    design: Design | None
    """Where it is one of ours."""
    base: str
    """`fixed` or `floating`."""
    gravity: np.ndarray
    """In the world `(3,)` [m/s^2]."""
    joints: tuple[str, ...]
    motors: tuple[str, ...]
    """Named as the joints where they are one to one."""
    motor_aliases: tuple[str, ...]
    """Other names under which logs may know the motors, those of the file's actuators `(m,)`."""
    gear: np.ndarray
    """Of each motor over its joint in the file, where they are one to one: motors count at the
    joint; 1 of others `(m,)`."""
    feet: tuple[str, ...]
    pads: tuple[Pad, ...]
    joint_from_motor: np.ndarray
    """`(n, m)` [-]."""
    gains: np.ndarray
    """Stiffness and damping of the joint controllers, NaN where unknown `(n, 2)` [Nm/rad,
    Nms/rad]."""
    torque_limit: np.ndarray
    """Largest motor torque, infinite where unknown `(m,)` [Nm]."""
    stall_torque: np.ndarray
    """Of the DC-motor line, infinite where unknown `(m,)` [Nm]."""
    no_load_speed: np.ndarray
    """Of the DC-motor line, infinite where unknown `(m,)` [rad/s]."""
    rotor_inertia: np.ndarray
    """At the motors `(m,)` [kg m^2]."""
    armature: np.ndarray
    """Inertia that rotors add at the joints, coupling included `(n, n)` [kg m^2]."""
    coulomb: np.ndarray
    viscous: np.ndarray
    """Nominal friction of the joints `(n,)` [Nm, Nms/rad]: coulomb tanh(v / friction_speed) +
    viscous v."""
    friction_speed: np.ndarray
    """`(n,)` [rad/s]."""
    spring: np.ndarray
    spring_rest: np.ndarray
    """Springs of the file at the joints: stiffness and position at rest `(n,)` [Nm/rad, rad]."""
    torque_constant: np.ndarray
    """NaN where unknown `(m,)` [Nm/A]."""
    supply: np.ndarray
    """Nominal supply of motors without current control, whose torques follow the battery's voltage;
    NaN of all others `(m,)` [V]."""
    passive: np.ndarray
    """Joints without a drive `(n,)`."""
    position_low: np.ndarray
    position_high: np.ndarray
    """Range of motion, infinite where unlimited `(n,)` [rad]."""
    default: np.ndarray
    """Posture at rest `(n,)` [rad]."""
    model: mujoco.MjModel
    """Of the same robot without actuators and friction; torques go in through `qfrc_applied`.
    Rotors are in it."""
    tree: Mechanism
    imu_rotation: np.ndarray
    imu_position: np.ndarray
    """Where gyro and accelerometer sit: axes `(3, 3)` and place `(3,)` [m] in the base's frame."""
    unlogged: tuple[str, ...]
    """Joints that no log knows, held still where the file draws them."""
    notes: tuple[str, ...]
    declared: Metadata
    """What was declared of it: gains, torque constants, payload."""
    bare: Subject | None
    """The same before anything was declared."""
    voltage: float = float("nan")
    """Of the battery when all is well, where a design or reference logs tell [V]."""
    motor_scale: Mapping[str, np.ndarray] = field(default_factory=dict)
    """By kind of signal, what turns logged values into those of `motors`; see `gearing` `(m,)`
    each."""

    @property
    def links(self) -> tuple[str, ...]:
        """Links that can move."""
        return self.tree.links

    @property
    def floating(self) -> bool:
        """Whether the base floats."""
        return self.base == "floating"

    @property
    def one_to_one(self) -> bool:
        """Whether each motor drives the joint of its own name."""
        return self.motors == self.joints

    @cached_property
    def motor_from_joint(self) -> np.ndarray:
        """Motor torques that give joint torques with the least sum of squares `(m, n)`."""
        if (
            self.design is not None
            and self.joint_from_motor.shape[0] != self.joint_from_motor.shape[1]
        ):
            return _least_heat(self)
        return np.asarray(np.linalg.pinv(self.joint_from_motor))

    @cached_property
    def pinocchio(self) -> pinocchio.Model:
        """Pinocchio model of the same tree, see `mechanism.pinocchio_model`."""
        return pinocchio_model(self.tree, self.gravity)

    def declare(self, metadata: Metadata) -> Subject:
        """The same robot with the gains, torque constants, supplies, payload and gravity that one
        log declares.

        Raises:
            InputError: a joint, motor or link that the robot does not have.
        """
        keys = ("gains", "torque_constant", "supply", "payload", "gravity")
        if (
            all(getattr(self.declared, k) == getattr(metadata, k) for k in keys)
            and self.bare is not None
        ):
            return self
        return _declared(self.bare or self, metadata)


def load_subject(
    robot: str | Path | None = None,
    logs: Sequence[Log] = (),
    *,
    overrides: Iterable[str] | None = None,
) -> Subject:
    """Nominal model of a robot, made to fit logs.

    Args:
        robot: a design of ours (`hyperleg`, or a YAML file), or any MJCF or URDF file; by default
            what the logs' metadata name.
        logs: whose metadata say what holds the base, gains, torque constants and payload; joints
            that none of them knows are held still. What differs between logs is taken from the
            first here, and from each in `conditioning.condition`.
        overrides: of our design, `path=value` each; by default those of the logs.

    Raises:
        InputError: no such robot, a joint or motor of a log that it does not have, logs that
        contradict each other, a file that
            cannot be understood.
    """
    metadata = [log.metadata for log in logs]
    named = not robot
    robot = str(robot) if robot else _agreed([m.robot for m in metadata], "robot", logs)
    base = _agreed([m.base for m in metadata], "base", logs)
    if not robot:
        raise InputError(
            "robot",
            "",
            None,
            "is not named: give --robot a design, an MJCF or a URDF, or name it in the logs' "
            "metadata",
        )
    chosen = (
        tuple(overrides)
        if overrides is not None
        else next((m.overrides for m in metadata if m.overrides), ())
    )
    from hyperleg_design.gap.model.subject_build import of_design, of_file
    from hyperleg_design.gap.signals.gearing import on_the_joints_side
    from hyperleg_design.robot.design import load_design

    path = _find(robot, logs, named)
    known = set().union(*(log.joints for log in logs)) if logs else None
    if path.suffix.lower() in (".yaml", ".yml"):
        bare = of_design(load_design(path, overrides=chosen), path, base or "floating", known)
    else:
        if chosen:
            raise InputError(
                robot, "overrides", chosen[0], "belong to designs of ours; edit the file instead"
            )
        bare = of_file(path, base or None, known)
    for log in logs:
        _check_names(log, bare)
    bare = (
        dataclasses.replace(bare, voltage=_healthy_voltage(logs))
        if np.isnan(bare.voltage)
        else bare
    )
    bare = on_the_joints_side(bare, logs)
    return bare.declare(metadata[0]) if metadata else dataclasses.replace(bare, bare=bare)


def subject_of(design: Design, base: str = "floating") -> Subject:
    """Subject of a design of ours, all joints free to move.

    Raises:
        InputError: a batch of designs.
    """
    from hyperleg_design.gap.model.subject_build import of_design

    bare = of_design(design, Path(design.source or f"{design.name}.yaml"), base, None)
    return dataclasses.replace(bare, bare=bare)


def _healthy_voltage(logs: Sequence[Log]) -> float:
    """Largest that reference logs show, but for spikes; NaN where none does."""
    known = [log.column("battery_voltage") for log in logs if log.metadata.role == "reference"]
    full = [float(np.nanpercentile(v, FULL)) for v in known if np.isfinite(v).any()]
    return max(full, default=float("nan"))


def _agreed(values: Sequence[str], field: str, logs: Sequence[Log]) -> str:
    stated = {v: log.name for v, log in zip(values, logs, strict=True) if v}
    if len(stated) > 1:
        found = ", ".join(f"{v} ({name})" for v, name in stated.items())
        raise InputError("logs", field, found, "differ: diagnose logs of one robot at a time")
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


def _declared(bare: Subject, metadata: Metadata) -> Subject:
    gains, constant = np.array(bare.gains), np.array(bare.torque_constant)
    for joint, pair in metadata.gains.items():
        if joint in bare.unlogged:
            continue
        gains[_index(joint, bare.joints, "gains", "joint")] = pair
    for motor, value in metadata.torque_constant.items():
        constant[motor_index(bare, motor, "torque_constant")] = value
    supply, stall, free = (
        np.array(bare.supply),
        np.array(bare.stall_torque),
        np.array(bare.no_load_speed),
    )
    for motor, line in metadata.supply.items():
        index = motor_index(bare, motor, "supply")
        supply[index], stall[index], free[index] = line
    values: dict[str, Any] = {
        "gains": gains,
        "torque_constant": constant,
        "declared": metadata,
        "bare": bare,
    }
    values |= {"supply": supply, "stall_torque": stall, "no_load_speed": free}
    moved = metadata.gravity != STANDARD_GRAVITY
    if metadata.payload or moved:
        import copy

        model = copy.copy(bare.model)
        for place, numbers in metadata.payload.items():
            link = bare.tree.link(place)
            robot_file.add_mass(model, bare.tree.links[link], numbers[0], np.array(numbers[1:]))
        if moved:
            model.opt.gravity[:] = metadata.gravity
            values["gravity"] = np.array(metadata.gravity)
        values |= {"model": model, "tree": mechanism_of(model)}
    return dataclasses.replace(bare, **values)


def motor_index(subject: Subject, motor: str, field: str) -> int:
    """Place of a motor, by its name or the name of its actuator in the file.

    Raises:
        InputError: no such motor.
    """
    if motor not in subject.motors and motor in subject.motor_aliases:
        return subject.motor_aliases.index(motor)
    return _index(motor, subject.motors, field, "motor")


def _index(name: str, names: Sequence[str], field: str, what: str) -> int:
    if name in names:
        return names.index(name)
    near = difflib.get_close_matches(name, names, n=1)
    remedy = f"did you mean {near[0]}?" if near else f"there are {', '.join(names)}"
    raise InputError("log", field, name, f"is no {what} of this robot; {remedy}")


def _check_names(log: Log, subject: Subject) -> None:
    for joint in log.names("position", "position_target", "velocity", "joint_torque"):
        if joint not in subject.unlogged:
            _index(joint, subject.joints, f"{log.name}: position", "joint")
    for motor in log.motors:
        if motor not in subject.unlogged:
            motor_index(subject, motor, f"{log.name}: motor")


def _least_heat(subject: Subject) -> np.ndarray:
    from hyperleg_design.robot.motors import motor_arrays
    from hyperleg_design.robot.transmission import motor_names
    from hyperleg_design.simulation.actuation import motor_from_joint

    assert subject.design is not None
    names = motor_names(subject.design)
    cost = [
        motor_arrays(subject.design).power_constant[names.index(m.split("_", 1)[1])]
        for m in subject.motors
    ]
    return motor_from_joint(subject.joint_from_motor, np.array(cost))
