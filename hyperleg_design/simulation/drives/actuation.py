"""Cooperative actuation in simulation: from joint targets to what the joints feel, pure and
batched.

One simulation step, as in Section III of the paper:

    tau_joint = stiffness (target - q) - damping q_dot             joint controller
    tau_motor = M^-1 tau_joint                                     least heat where motors outnumber joints
    tau_motor = clip(tau_motor) at motor_velocity = M^T q_dot      four-quadrant envelope
    tau_cmd   = M tau_motor - (f_c tanh(q_dot / v_m) + f_v q_dot)  Eq. (4)

Motor torques go to MuJoCo as controls on the tendons whose coefficients are the columns of M, which
multiplies by M. Friction goes in explicitly as that formula prints it, or implicitly, the default:
with `D = f_c tanh(|q_dot| / v_m) / |q_dot| + f_v` of the velocity before the step as a damping, `D
q_dot` of the velocity after it. Both tend to the same friction as the step shrinks. At 200 Hz the
explicit one is unstable on the light distal joints: f_c h / (v_m I) is 24 at the toe, where 2 is
the bound, and foot and toe chatter in the air.

Arrays are `(..., legs, joints)` and `(..., legs, motors)`; those of the model broadcast against
them.
"""  # noqa: E501

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.robot import transmission
from hyperleg_design.robot.laws.friction import joint_friction
from hyperleg_design.robot.motors import motor_arrays
from hyperleg_design.sizing.envelope import MotorEnvelope, motor_envelope

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign


@dataclass(frozen=True, eq=False)
class ActuationModel:
    """Constants of one leg's actuation; of a batch of designs with `(n, 1)` in front."""

    joint_from_motor: np.ndarray
    """M, `(..., joints, motors)` [-]."""
    motor_from_joint: np.ndarray
    """M^-1, or the map of least Joule heat, `(..., motors, joints)` [-]."""
    envelope: MotorEnvelope
    """Torque-speed envelopes of the motors, `(..., motors)` each."""
    rated_torque: np.ndarray
    """Continuous torque [Nm], `(..., motors)`."""
    stiffness: np.ndarray
    """Position gains of the controller [Nm/rad], `(..., joints)`."""
    damping: np.ndarray
    """Velocity gains of the controller [Nms/rad], `(..., joints)`."""
    coulomb: np.ndarray
    """Coulomb friction [Nm], `(..., joints)`."""
    viscous: np.ndarray
    """Viscous friction [Nms/rad], `(..., joints)`."""


def actuation_model(design: RobotDesign) -> ActuationModel:
    """Collect the constants of a robot's actuation.

    Args:
        design: a robot or batch.

    Returns:
        Constants of one leg; for a batch, `(n, legs, ...)` each.
    """
    joints, motors = transmission.joint_names(design), transmission.motor_names(design)
    batched = bool(design.batch_shape)
    arrays = motor_arrays(design)

    def legs(values: np.ndarray, core: int) -> np.ndarray:
        return (
            np.expand_dims(
                np.broadcast_to(values, (*design.batch_shape, *values.shape[values.ndim - core :])),
                -core - 1,
            )
            if batched
            else values
        )

    def of_joints(field: str) -> np.ndarray:
        values = [getattr(design.joint_sections[joint], field) for joint in joints]
        return legs(np.stack(np.broadcast_arrays(*values), -1).astype(float), 1)

    envelope = motor_envelope(design)
    limits = {
        n: legs(getattr(envelope, n), 1)
        for n in ("no_load_speed", "stall_torque", "peak_torque", "power_constant")
    }
    matrix = transmission.joint_from_motor(design)
    coulomb, viscous = joint_friction(design)
    return ActuationModel(
        joint_from_motor=legs(matrix, 2),
        motor_from_joint=legs(motor_from_joint(matrix, envelope.power_constant), 2),
        envelope=dataclasses.replace(envelope, **limits),
        rated_torque=legs(arrays.rated_torque[..., : len(motors)], 1),
        stiffness=of_joints("stiffness"),
        damping=of_joints("damping"),
        coulomb=legs(coulomb[..., : len(joints)], 1),
        viscous=legs(viscous[..., : len(joints)], 1),
    )


def motor_from_joint(matrix: np.ndarray, power_constant: np.ndarray) -> np.ndarray:
    """Compute the linear map from joint torques to motor torques, C^-1 M^T (M C^-1 M^T)^-1.

    It is M^-1 where there are as many motors as joints. Where motors outnumber joints, it gives the
    motor torques of least Joule heat. It is zero for a joint that no motor moves.

    Args:
        matrix: M [-], `(..., joints, motors)`.
        power_constant: C, Joule heat over squared torque [W/Nm^2], `(..., motors)`.

    Returns:
        The map [-], `(..., motors, joints)`.
    """
    moved = transmission.driven_rows(matrix)
    if not moved.all():
        inverse = np.zeros((*matrix.shape[:-2], matrix.shape[-1], matrix.shape[-2]))
        inverse[..., moved] = motor_from_joint(matrix[..., moved, :], power_constant)
        return inverse
    if matrix.shape[-1] == matrix.shape[-2]:
        return np.linalg.inv(matrix)
    weighted = matrix / np.asarray(power_constant)[..., None, :]
    return np.swapaxes(np.linalg.solve(weighted @ np.swapaxes(matrix, -1, -2), weighted), -1, -2)


def smoothed_action(previous: np.ndarray, action: np.ndarray, weight: float) -> np.ndarray:
    """Compute the exponential moving average of actions, weight * action + (1 - weight) * previous,
    once a policy step.

    Args:
        previous: average of the step before, `(..., J)`.
        action: of this step, `(..., J)`.
        weight: of the new action [-].

    Returns:
        The new average, `(..., J)`.
    """
    return previous + weight * (action - previous)


def controller_torque(
    model: ActuationModel, target: np.ndarray, position: np.ndarray, velocity: np.ndarray
) -> np.ndarray:
    """Compute the joint torque that the joint controller asks for.

    Args:
        model: gives stiffness and damping.
        target: joint positions to reach [rad], `(..., legs, joints)`.
        position: joint positions [rad], `(..., legs, joints)`.
        velocity: joint velocities [rad/s], `(..., legs, joints)`.

    Returns:
        The torque [Nm], `(..., legs, joints)`.
    """
    return model.stiffness * (target - position) - model.damping * velocity


def motor_speed(matrix: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Compute motor velocities, M^T q_dot.

    Args:
        matrix: M [-], `(joints, motors)` or with the leading axes of `velocity`.
        velocity: joint velocities [rad/s], `(..., legs, joints)`.

    Returns:
        Motor velocities [rad/s], `(..., legs, motors)`.
    """
    return applied(np.swapaxes(matrix, -1, -2), velocity)


def driven_torque(
    model: ActuationModel, wanted: np.ndarray, speed: np.ndarray, to_motor: np.ndarray | None = None
) -> np.ndarray:
    """Compute the motor torques that the drives give, inside their envelopes.

    Args:
        model: the actuation.
        wanted: joint torques [Nm], `(..., legs, joints)`.
        speed: motor velocities [rad/s], `(..., legs, motors)`.
        to_motor: map from joint to motor torques in place of the model's, `(..., motors, joints)`.

    Returns:
        The torques [Nm], `(..., legs, motors)`.
    """
    torque = applied(model.motor_from_joint if to_motor is None else to_motor, wanted)
    # `sizing.envelope.clip_torque` with the bounds taken one after the other, in place: this runs
    # in every simulation step.
    stall, peak = model.envelope.stall_torque, model.envelope.peak_torque
    droop = stall / model.envelope.no_load_speed * speed
    np.minimum(torque, stall - droop, out=torque)
    droop += stall
    np.maximum(torque, np.negative(droop, out=droop), out=torque)
    np.minimum(torque, peak, out=torque)
    return np.maximum(torque, -peak, out=torque)


def friction_torque(
    coulomb: np.ndarray, viscous: np.ndarray, velocity: np.ndarray, width: Any
) -> np.ndarray:
    """Compute joint friction, f_c tanh(v / v_m) + f_v v, the part that is subtracted in Eq. (4).

    Args:
        coulomb: f_c [Nm], `(...)`.
        viscous: f_v [Nms/rad], `(...)`.
        velocity: v [rad/s], `(...)`.
        width: v_m [rad/s].

    Returns:
        The friction torque [Nm], `(...)`.
    """
    return coulomb * np.tanh(velocity / width) + viscous * velocity


def friction_damping(
    coulomb: np.ndarray, viscous: np.ndarray, velocity: np.ndarray, width: Any
) -> np.ndarray:
    """Compute the damping D with D v = `friction_torque`; at rest it is f_c / v_m + f_v.

    Args:
        coulomb: f_c [Nm], `(...)`.
        viscous: f_v [Nms/rad], `(...)`.
        velocity: v [rad/s], `(...)`.
        width: v_m [rad/s].

    Returns:
        The damping [Nms/rad], `(...)`.
    """
    ratio = np.abs(velocity)
    ratio /= width
    np.maximum(ratio, 1e-9, out=ratio)
    damping = np.tanh(ratio)
    damping /= ratio
    damping *= coulomb / width
    damping += viscous
    return damping


def motor_friction(design: RobotDesign) -> tuple[np.ndarray, np.ndarray]:
    """Fit friction at the motors that comes nearest to the printed friction at the joints.

    Table I prints friction for each joint, measured with motors that move several joints.
    Non-negative Coulomb torques f and viscous coefficients d at the motors are fitted in least
    squares, so that each joint moving alone meets `sum |M| f` and `sum M^2 d`. They cannot meet all
    of them exactly.

    Args:
        design: one robot.

    Returns:
        Coulomb [Nm] and viscous [Nms/rad], `(motors,)` each, of one robot.
    """
    from scipy.optimize import nnls

    matrix, model = transmission.joint_from_motor(design), actuation_model(design)
    return nnls(np.abs(matrix), model.coulomb)[0], nnls(matrix**2, model.viscous)[0]


def motor_friction_width(matrix: np.ndarray, width: float) -> np.ndarray:
    """Compute the motor speeds that match the joints' v_m: v_m times each motor's largest
    reduction.

    Args:
        matrix: M [-], `(..., joints, motors)`.
        width: v_m [rad/s].

    Returns:
        The speeds [rad/s], `(..., motors)`.
    """
    return np.asarray(width * np.max(np.abs(matrix), -2))


def applied(matrix: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Multiply a matrix and a vector over the last axes.

    Args:
        matrix: `(rows, columns)`, shared by all vectors, or `(..., rows, columns)`.
        vector: `(..., columns)`.

    Returns:
        The product, `(..., rows)`.
    """
    if matrix.ndim == 2:
        return (vector.reshape(-1, matrix.shape[1]) @ matrix.T).reshape(
            *vector.shape[:-1], matrix.shape[0]
        )
    return np.matmul(matrix, vector[..., None])[..., 0]
