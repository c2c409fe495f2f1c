"""Cooperative actuation: how the motors of a leg share its joints.

`joint_from_motor` M has a row a joint and a column a motor, in the order of `names`. Then

    joint_torque = M motor_torque          motor_velocity = M^T joint_velocity

so power is the same on both sides, and rotors of inertia J appear at the joints as `M diag(J) M^T`.
The paper's J_m is M^-T, and its Eq. (3) prints M where it means the inverse. Any leading batch
dimensions pass through.
"""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.motors import motor_arrays
from hyperleg_design.robot.names import ACTUATOR_OF_MOTOR, POSTURES
from hyperleg_design.robot.parameters.sections import LinkageScale
from hyperleg_design.robot.trees import limb_actuation, tree_limb
from hyperleg_design.robot.trees.tree_design import TreeDesign

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign
    from hyperleg_design.robot.parameters.hyperleg import HyperLeg

KNEE, ANKLE_PITCH, ANKLE_ROLL, TOE = 3, 4, 5, 6
"""Rows of M below the hip."""
M_KNEE, M_ANKLE_LEFT, M_ANKLE_RIGHT, M_TOE = 3, 4, 5, 6
"""Columns of M below the hip."""


def gear_ratios(design: HyperLeg) -> np.ndarray:
    """Compute the gears below the hip over those of the reference build; at the hip, the gears
    themselves.

    Args:
        design: a robot or batch.

    Returns:
        The ratios [-], `(..., 7)`.
    """
    reference = {"knee": "knee_gear", "ankle": "ankle_gear", "toe": "toe_gear"}
    parts = []
    for name in ACTUATOR_OF_MOTOR:
        gear = getattr(design.actuators, name).gear
        parts.append(
            gear / getattr(design.reference, reference[name]) if name in reference else gear
        )
    return np.stack(np.broadcast_arrays(*parts), -1).astype(float)


def full_joint_from_motor(design: HyperLeg, posture: str | None = None) -> np.ndarray:
    """Compute M of the leg with all joints and motors.

    Args:
        design: a robot or batch.
        posture: `walking` or `standing`; the design's own by default.

    Returns:
        M [-], `(..., 7, 7)`.

    Raises:
        InputError: no such posture.
    """
    posture = posture or design.transmission.posture
    if posture not in POSTURES:
        raise InputError("posture", "", posture, f"expects one of {', '.join(POSTURES)}")
    return _matrix(
        getattr(design.transmission, posture), design.transmission.scale, gear_ratios(design)
    )


def reference_joint_from_motor(design: HyperLeg, posture: str | None = None) -> np.ndarray:
    """Compute M of the reference build, for which friction and gears are declared.

    A reduction that the reference build leaves open is the design's own.

    Args:
        design: a robot or batch.
        posture: `walking` or `standing`; the design's own by default.

    Returns:
        M [-], `(..., 7, 7)`.
    """
    posture = posture or design.transmission.posture
    own = getattr(design.transmission, posture)
    stated = getattr(design.reference.transmission, posture)
    reductions = {}
    for item in dataclasses.fields(own):
        value = getattr(stated, item.name)
        reductions[item.name] = np.where(value == 0, getattr(own, item.name), value)
    gear = np.asarray(design.reference.hip_gear, float)[..., None] * np.ones(3)
    gears = np.concatenate([gear, np.ones((*gear.shape[:-1], 4))], -1)
    return _matrix(SimpleNamespace(**reductions), LinkageScale(), gears)


def _matrix(printed: Any, scale: LinkageScale, gears: np.ndarray) -> np.ndarray:
    """M from the reductions below the hip, the factors on them, and `gear_ratios`."""
    entries = {
        (KNEE, M_KNEE): -printed.knee * scale.knee,
        (KNEE, M_ANKLE_LEFT): -printed.knee * scale.knee,
        (KNEE, M_ANKLE_RIGHT): -printed.knee * scale.knee,
        (KNEE, M_TOE): -printed.knee * scale.knee,
        (ANKLE_PITCH, M_ANKLE_LEFT): printed.ankle_pitch * scale.ankle_pitch,
        (ANKLE_PITCH, M_ANKLE_RIGHT): printed.ankle_pitch * scale.ankle_pitch,
        (ANKLE_PITCH, M_TOE): printed.toe_ankle_pitch * scale.toe_ankle_pitch,
        (ANKLE_ROLL, M_ANKLE_LEFT): printed.ankle_roll * scale.ankle_roll,
        (ANKLE_ROLL, M_ANKLE_RIGHT): -printed.ankle_roll * scale.ankle_roll,
        (TOE, M_TOE): printed.toe * scale.toe,
    }
    batch = np.broadcast_shapes(gears.shape[:-1], *(np.shape(v) for v in entries.values()))
    matrix = np.zeros((*batch, 7, 7))
    matrix[..., range(3), range(3)] = 1.0
    for (row, column), value in entries.items():
        matrix[..., row, column] = value
    return matrix * gears[..., None, :]


def joint_names(design: RobotDesign) -> tuple[str, ...]:
    """List the joints of one limb that move.

    Args:
        design: a robot or batch.

    Returns:
        Names without the limb's; for HyperLeg `JOINTS`, without the toe where that is locked.
    """
    return tuple(design.joint_sections)


def motor_names(design: RobotDesign) -> tuple[str, ...]:
    """List the motors of one limb that are there.

    Args:
        design: a robot or batch.

    Returns:
        Names without the limb's; for HyperLeg `MOTORS`, without the toe's where that is not
        installed.
    """
    return tuple(design.actuator_sections)


def joint_from_motor(design: RobotDesign, posture: str | None = None) -> np.ndarray:
    """M over the joints that move and the motors that are there, `(..., joints, motors)` [-].

    A locked toe whose motor stays gives a 6 x 7 matrix: that motor still helps knee and ankle. A
    design that writes its tree out has one posture, its default, which all names mean.

    Args:
        design: a robot, or a batch of `n` robots.
        posture: `standing` or `walking`, the paper's two, or `default` of a design that writes its
            tree out; the design's own by default.

    Returns:
        M with tau_joint = M tau_motor and motor_velocity = M^T joint_velocity; power is the
        same on both sides.

    Raises:
        InputError: no such posture.
    """
    if isinstance(design, TreeDesign):
        if posture not in (None, "default", *POSTURES):
            remedy = f"expects default, which is all that {design.name} has; or leave it out"
            raise InputError("posture", "", posture, remedy)
        return limb_actuation.joint_from_motor(design)
    return full_joint_from_motor(cast("HyperLeg", design), posture)[
        ..., : len(joint_names(design)), : len(motor_names(design))
    ]


def joint_torque(matrix: np.ndarray, motor_torque: np.ndarray) -> np.ndarray:
    """Compute joint torques from motor torques, M tau_motor.

    Args:
        matrix: M [-], `(..., joints, motors)`.
        motor_torque: [Nm], `(..., motors)`.

    Returns:
        Joint torques [Nm], `(..., joints)`.
    """
    return np.einsum("...jm,...m->...j", matrix, motor_torque)


def motor_velocity(matrix: np.ndarray, joint_velocity: np.ndarray) -> np.ndarray:
    """Compute motor velocities from joint velocities, M^T q_dot.

    Args:
        matrix: M [-], `(..., joints, motors)`.
        joint_velocity: [rad/s], `(..., joints)`.

    Returns:
        Motor velocities [rad/s], `(..., motors)`.
    """
    return np.einsum("...jm,...j->...m", matrix, joint_velocity)


def motor_torque(
    matrix: np.ndarray, torque: np.ndarray, power_constant: np.ndarray | None = None
) -> np.ndarray:
    """Compute motor torques that give the joint torques.

    A joint that no motor moves, such as a passive toe, is left to its spring: its torque has no
    effect. Where motors outnumber joints, the motor torques are those of least Joule heat: tau =
    C^-1 M^T (M C^-1 M^T)^-1 tau_joint.

    Args:
        matrix: M [-], `(..., joints, motors)`.
        torque: joint torques [Nm], `(..., joints)`.
        power_constant: C, Joule heat over squared torque [W/Nm^2], `(..., motors)`; equal ones by
            default.

    Returns:
        Motor torques [Nm], `(..., motors)`.
    """
    moved = driven_rows(matrix)
    if not moved.all():
        return motor_torque(matrix[..., moved, :], torque[..., moved], power_constant)
    if matrix.shape[-1] == matrix.shape[-2]:
        return np.linalg.solve(matrix, torque[..., None])[..., 0]
    ease = 1.0 / (
        np.ones(matrix.shape[-1]) if power_constant is None else np.asarray(power_constant)
    )
    weighted = matrix * ease[..., None, :]
    return np.einsum(
        "...jm,...j->...m",
        weighted,
        np.linalg.solve(weighted @ np.swapaxes(matrix, -1, -2), torque[..., None])[..., 0],
    )


def driven_rows(matrix: np.ndarray) -> np.ndarray:
    """Find the joints that any motor moves, in any robot of the batch.

    Args:
        matrix: M [-], `(..., joints, motors)`.

    Returns:
        True for each such joint, `(joints,)`.
    """
    reached = np.any(matrix != 0, -1)
    return np.asarray(reached.reshape(-1, reached.shape[-1]).any(0))


def reflected_inertia(matrix: np.ndarray, rotor_inertia: np.ndarray) -> np.ndarray:
    """Compute the inertia of the rotors at the joints, M diag(J) M^T.

    Args:
        matrix: M [-], `(..., joints, motors)`.
        rotor_inertia: J [kg m^2], `(..., motors)`.

    Returns:
        The reflected inertia [kg m^2], `(..., joints, joints)`.
    """
    return (matrix * np.asarray(rotor_inertia)[..., None, :]) @ np.swapaxes(matrix, -1, -2)


def derate(design: RobotDesign) -> np.ndarray:
    """Collect the fraction of the motors' torques that is counted on at each joint that moves.

    Args:
        design: a robot or batch.

    Returns:
        The fractions [-], `(..., joints)`.
    """
    if isinstance(design, TreeDesign):
        return tree_limb.of_joints(design, "derate")
    actuators = cast("HyperLeg", design).actuators
    of_joint = {"ankle_pitch": "ankle", "ankle_roll": "ankle"}
    parts = [getattr(actuators, of_joint.get(j, j)).derate for j in joint_names(design)]
    return np.stack(np.broadcast_arrays(*parts), -1).astype(float)


def max_joint_torque(design: RobotDesign, posture: str = "standing") -> np.ndarray:
    """Largest torque of each joint alone, derated as in Table I, `(..., joints)` [Nm]: derate * sum
    |M| tau, with tau of each motor at standstill, its peak torque or its stall torque if that is
    smaller.

    Args:
        design: a robot, or a batch of `n` robots.
        posture: `standing` or `walking`, the paper's two; Table I prints the standing one.

    Returns:
        Torques, each reached only while every motor of the joint pulls for it [Nm].
    """
    limit = motor_arrays(design).standstill_torque[..., : len(motor_names(design))]
    return derate(design) * joint_torque(np.abs(joint_from_motor(design, posture)), limit)


def single_joint_speed(design: RobotDesign, posture: str = "walking") -> np.ndarray:
    """No-load speed of each joint while the others stand still, `(..., joints)` [rad/s]: min over
    motors of omega_0 / |M|.

    Args:
        design: a robot, or a batch of `n` robots.
        posture: `standing` or `walking`, the paper's two; Table I prints the walking one.

    Returns:
        Speeds at the joints [rad/s]; infinite where no motor moves a joint.
    """
    free = motor_arrays(design).no_load_speed[..., : len(motor_names(design))]
    matrix = np.abs(joint_from_motor(design, posture))
    with np.errstate(divide="ignore"):
        return np.min(np.where(matrix > 0, free[..., None, :] / matrix, np.inf), -1)


def check_invertible(design: HyperLeg, where: str) -> None:
    """Check that the motors reach every joint.

    Args:
        design: a robot or batch.
        where: file, for error messages.

    Raises:
        InputError: M is singular, or a conditioning no gearbox has.
    """
    for posture in ("walking", "standing"):
        condition: Any = np.linalg.cond(joint_from_motor(design, posture))
        if np.any(~(condition < 1e6)):
            worst = float(np.max(condition))
            remedy = (
                "is the condition number of joint_from_motor, as good as singular: some "
                "joint "
                "has no drive; check reductions, scale, gears"
            )
            raise InputError(
                where, f"transmission.{posture}", worst, remedy, bad=~(condition < 1e6)
            )
