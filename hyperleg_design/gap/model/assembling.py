"""A subject put together from a compiled model and from what is known of its drives."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.model import file_joints
from hyperleg_design.gap.model.mechanism import Mechanism
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.model.tendons import Tendon


def assembled(
    *,
    path: Path,
    model: Any,
    tree: Mechanism,
    joint_from_motor: np.ndarray,
    rotor_inertia: np.ndarray,
    armature: np.ndarray,
    friction_speed: float,
    couplings: Sequence[Tendon] = (),
    notes: Sequence[str] = (),
    unlogged: tuple[str, ...] = (),
    **fields: Any,
) -> Subject:
    """Put a subject together, before any log declared anything.

    Args:
        path: of the robot's file.
        model: compiled; its joint friction is taken out, as the subject has it.
        tree: of the same model.
        joint_from_motor: torque map of its n joints and m motors, `(n, m)` [-].
        rotor_inertia: at the motors, `(m,)` [kg m^2].
        armature: further inertia about each joint, `(n,)` [kg m^2].
        friction_speed: width of the tanh that stands for Coulomb friction [rad/s].
        couplings: tendons that couple joints by their inertia.
        notes: what a reader of the diagnosis must know of the model.
        unlogged: joints that are held still.
        fields: further fields of `Subject`, by its names.

    Returns:
        The subject; its arrays cannot be written.
    """
    count, motors = tree.count, joint_from_motor.shape[1]
    file_joints.take_out_friction(model)
    low, high = file_joints.limits(model)
    optional = {"gear": np.ones(motors), "spring": np.zeros(count), "spring_rest": np.zeros(count)}
    subject = Subject(
        path=str(path),
        gravity=np.array(model.opt.gravity),
        joints=tree.joints,
        joint_from_motor=joint_from_motor,
        rotor_inertia=rotor_inertia,
        armature=(joint_from_motor * rotor_inertia) @ joint_from_motor.T
        + np.diag(armature)
        + sum((tendon.inertia for tendon in couplings), np.zeros((count, count))),
        friction_speed=np.full(count, friction_speed),
        supply=np.full(motors, np.nan),
        position_low=low,
        position_high=high,
        model=model,
        tree=tree,
        unlogged=unlogged,
        notes=tuple(notes),
        declared=Metadata(),
        bare=None,
        **(optional | fields),
    )
    for value in vars(subject).values():
        if isinstance(value, np.ndarray):
            value.setflags(write=False)
    return subject


def add_rotors(
    spec: Any, joints: Sequence[str], motors: Sequence[str], matrix: np.ndarray, rotor: np.ndarray
) -> None:
    """Put the rotors of coupled motors into a model, one fixed tendon each.

    Args:
        spec: the specification, which is changed.
        joints: names of the n joints.
        motors: names of the m motors.
        matrix: joint torque of motor torque, `(n, m)` [-].
        rotor: inertia of the rotors, `(m,)` [kg m^2].
    """
    for column, motor in enumerate(motors):
        tendon = spec.add_tendon(name=motor, armature=rotor[column])
        for row in np.flatnonzero(matrix[:, column]).tolist():
            tendon.wrap_joint(joints[row], matrix[row, column])


def add_tendon(spec: Any, name: str, joints: Sequence[str], tendon: Tendon) -> None:
    """Put a tendon with its armature alone into a model.

    Args:
        spec: the specification, which is changed.
        name: of the tendon.
        joints: names of the n joints.
        tendon: with a coefficient for each joint.
    """
    added = spec.add_tendon(name=name, armature=tendon.armature)
    for row in np.flatnonzero(tendon.coefficients).tolist():
        added.wrap_joint(joints[row], float(tendon.coefficients[row]))
