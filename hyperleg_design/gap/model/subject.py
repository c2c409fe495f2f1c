"""The robot that logs are diagnosed against: its nominal model, from a design of ours or from
anybody's MJCF or URDF.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError, meant
from hyperleg_design.gap.logs.metadata import STANDARD_GRAVITY, Metadata
from hyperleg_design.gap.model.body_inertia import add_mass
from hyperleg_design.gap.model.mechanism import Mechanism, mechanism_of
from hyperleg_design.robot.motors import motor_arrays
from hyperleg_design.robot.parameters.described import RobotDesign, prefixed
from hyperleg_design.robot.transmission import motor_names
from hyperleg_design.simulation.drives.actuation import motor_from_joint

if TYPE_CHECKING:
    import mujoco


@dataclass(frozen=True)
class Pad:
    """A place that may touch the ground."""

    name: str
    foot: int
    """Place of its foot in `Subject.feet`."""
    link: int
    """Place of its link in `Mechanism.links`."""
    position: tuple[float, float, float]
    """Of its centre in the link's frame [m]."""
    radius: float
    """Radius of the pad [m]."""


@dataclass(frozen=True, eq=False)
class Subject:
    """Nominal robot: `n` joints, `m` motors; tau_joint = joint_from_motor tau_motor, motor speed =
    its transpose times joint speed.
    """

    name: str
    path: str
    """File it was read from."""
    design: RobotDesign | None
    """Where it is one of ours."""
    base: str
    """How the base is held, `fixed` or `floating`."""
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
    """Joint torque over motor torque `(n, m)` [-]."""
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
    """Speed over which Coulomb friction turns over `(n,)` [rad/s]."""
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

    def motor_over_joint(self, motor: int) -> float:
        """Angle of a motor over that of the joint that it moves most [-].

        Args:
            motor: index of the motor.

        Returns:
            The ratio [-].
        """
        return float(np.abs(self.joint_from_motor[:, motor]).max())

    def main_joint(self, motor: int) -> int:
        """Index of the joint that a motor moves most.

        Args:
            motor: index of the motor.
        """
        return int(np.argmax(np.abs(self.joint_from_motor[:, motor])))

    @cached_property
    def driven(self) -> np.ndarray:
        """Motors that exist, which those of passive joints do not `(m,)`."""
        return ~self.passive if self.one_to_one else np.ones(len(self.motors), bool)

    @cached_property
    def one_to_one(self) -> bool:
        """Whether each motor drives the joint of its own name and counts at it."""
        return self.motors == self.joints and np.array_equal(
            self.joint_from_motor, np.eye(len(self.joints))
        )

    @cached_property
    def motor_from_joint(self) -> np.ndarray:
        """Motor torques that give joint torques with the least sum of squares `(m, n)`."""
        if (
            self.design is not None
            and self.joint_from_motor.shape[0] != self.joint_from_motor.shape[1]
        ):
            return _least_heat(self)
        return np.asarray(np.linalg.pinv(self.joint_from_motor))

    @property
    def known_gains(self) -> dict[str, tuple[float, float]]:
        """Stiffness [Nm/rad] and damping [Nms/rad] of the joints whose gains are known, by name."""
        return {
            joint: (float(stiffness), float(damping))
            for joint, (stiffness, damping) in zip(self.joints, self.gains, strict=True)
            if np.isfinite(stiffness + damping)
        }

    @cached_property
    def pad_foot(self) -> np.ndarray:
        """Index of the foot of each pad `(P,)`."""
        return np.array([pad.foot for pad in self.pads], int)

    def declare(self, metadata: Metadata) -> Subject:
        """Apply the gains, torque constants, supplies, payload and gravity that one log declares.

        Args:
            metadata: of the log.

        Returns:
            The same robot with these values.

        Raises:
            InputError: a joint, motor or link that the robot does not have.
        """
        keys = ("gains", "torque_constant", "supply", "torque_sensors", "payload", "gravity")
        if (
            all(getattr(self.declared, k) == getattr(metadata, k) for k in keys)
            and self.bare is not None
        ):
            return self
        return _declared(self.bare or self, metadata)


def _declared(bare: Subject, metadata: Metadata) -> Subject:
    gains, constant = np.array(bare.gains), np.array(bare.torque_constant)
    for joint, pair in metadata.gains.items():
        if joint in bare.unlogged:
            continue
        gains[index_of(joint, bare.joints, "gains", "joint")] = pair
    for motor, value in metadata.torque_constant.items():
        constant[motor_index(bare, motor, "torque_constant")] = value
    for joint in metadata.torque_sensors:
        index_of(joint, (*bare.joints, *bare.unlogged), "torque_sensors", "joint")
    supply = np.array(bare.supply)
    stall = np.array(bare.stall_torque)
    free = np.array(bare.no_load_speed)
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
            add_mass(model, bare.tree.links[link], numbers[0], np.array(numbers[1:]))
        if moved:
            model.opt.gravity[:] = metadata.gravity
            values["gravity"] = np.array(metadata.gravity)
        values |= {"model": model, "tree": mechanism_of(model)}
    return dataclasses.replace(bare, **values)


def motor_index(subject: Subject, motor: str, field: str) -> int:
    """Find a motor by its name or by that of its actuator in the file.

    Args:
        subject: the robot.
        motor: the name.
        field: of the metadata, for error messages.

    Returns:
        Index of the motor.

    Raises:
        InputError: no such motor.
    """
    if motor not in subject.motors and motor in subject.motor_aliases:
        return subject.motor_aliases.index(motor)
    return index_of(motor, subject.motors, field, "motor")


def index_of(name: str, names: Sequence[str], field: str, what: str) -> int:
    """Find a name among some.

    Args:
        name: the name.
        names: the names.
        field: of the metadata, for error messages.
        what: kind of thing that is named, for error messages.

    Returns:
        Its index.

    Raises:
        InputError: it is not among them.
    """
    if name in names:
        return names.index(name)
    raise InputError("log", field, name, f"is no {what} of this robot; {meant(name, names)}")


def _least_heat(subject: Subject) -> np.ndarray:
    design = subject.design
    assert design is not None
    constants = motor_arrays(design).power_constant
    cost = {
        prefixed(limb, name): constant
        for limb in design.copies
        for name, constant in zip(motor_names(design), constants, strict=False)
    }
    return motor_from_joint(subject.joint_from_motor, np.array([cost[m] for m in subject.motors]))
