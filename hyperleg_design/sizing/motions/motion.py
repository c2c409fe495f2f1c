"""A planned motion: states of a robot over time, and which pads bear load when."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.names import SIDES
from hyperleg_design.sizing.contacts import sole_pads
from hyperleg_design.sizing.kinematics import (
    about_x,
    about_y,
    check_range,
    has_toe_joint,
    hip_center,
    leg_angles,
)
from hyperleg_design.sizing.motions.foot_path import FootPath

if TYPE_CHECKING:
    from hyperleg_design.robot.models import RigidBodyModel


@dataclass(frozen=True, eq=False)
class PelvisPath:
    """Pelvis over time, turned by `Rx(roll) Ry(pitch)`; it does not yaw."""

    position: np.ndarray
    """Position of the pelvis's origin in the world, with rate and acceleration [m, m/s, m/s^2],
    `(3, n, 3)`."""
    pitch: np.ndarray
    """Nose down, with rate and acceleration [rad, rad/s, rad/s^2], `(3, n)`."""
    roll: np.ndarray
    """Left side up, with rate and acceleration, `(3, n)`."""


@dataclass(frozen=True, eq=False)
class Motion:
    """A planned motion of one robot, in Pinocchio's coordinates."""

    name: str
    model: RigidBodyModel = field(repr=False)
    time: np.ndarray
    """Times of the samples [s], `(n,)`, evenly spaced; a periodic motion ends one step before it
    repeats."""
    q: np.ndarray
    """Generalised positions in Pinocchio's order, `(n, nq)`."""
    v: np.ndarray
    """Generalised velocities in Pinocchio's order, `(n, nv)`."""
    a: np.ndarray
    """Generalised accelerations in Pinocchio's order, `(n, nv)`."""
    contact: np.ndarray
    """Whether a pad may bear load, `(n, pads)`, pads as in `contacts.sole_pads`."""
    feet: tuple[FootPath, FootPath]
    """Planned feet, left and right."""
    pressure: np.ndarray
    """Planned centre of pressure in the world [m], `(n, 3)`; NaN in flight."""
    periodic: bool
    distance: float
    """Travelled forward in all [m]."""
    assumptions: Mapping[str, str]
    """What was chosen and why, by name."""

    @property
    def time_step(self) -> float:
        """Time between two samples [s]."""
        return float(self.time[1] - self.time[0])

    @property
    def duration(self) -> float:
        """Duration of the motion; of one period where it is periodic [s]."""
        return (
            float(len(self.time) * self.time_step)
            if self.periodic
            else float(self.time[-1] - self.time[0])
        )

    @property
    def joint_position(self) -> np.ndarray:
        """Joint angles [rad], `(n, 2, joints)`, left leg first."""
        return self.q[:, 7:].reshape(len(self.time), 2, -1)

    @property
    def joint_velocity(self) -> np.ndarray:
        """Joint speeds [rad/s], `(n, 2, joints)`, left leg first."""
        return self.v[:, 6:].reshape(len(self.time), 2, -1)


def joint_states(
    model: RigidBodyModel, pelvis: PelvisPath, feet: tuple[FootPath, FootPath]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Find states that carry pelvis and feet along their paths, with exact velocities and
    accelerations.

    Positions are inverse kinematics. Velocities solve `J_leg q_dot = twist of the foot - what the
    base brings`, and accelerations the same equation differentiated, so that a foot planned to
    stand has none of either.

    Args:
        model: floating robot.
        pelvis: its path.
        feet: left and right path.

    Returns:
        `q (n, nq)`, `v (n, nv)`, `a (n, nv)`.

    Raises:
        InfeasibleError: a leg does not reach. Ranges of motion are `check_ranges`'s business.
    """
    import pinocchio as pin

    design, count = model.design, pelvis.position.shape[1]
    joints = (model.model.nv - 6) // 2
    toe = has_toe_joint(design)
    q, v, a = (
        np.zeros((count, model.model.nq)),
        np.zeros((count, model.model.nv)),
        np.zeros((count, model.model.nv)),
    )
    place, speed, thrust = pelvis.position
    pitch, roll = pelvis.pitch, pelvis.roll
    rotation = about_x(roll[0]) @ about_y(pitch[0])
    to_body = np.swapaxes(rotation, -1, -2)
    half_pitch, half_roll = pitch[0] / 2, roll[0] / 2
    q[:, :3] = place
    q[:, 3], q[:, 4] = (
        np.sin(half_roll) * np.cos(half_pitch),
        np.cos(half_roll) * np.sin(half_pitch),
    )
    q[:, 5], q[:, 6] = (
        np.sin(half_roll) * np.sin(half_pitch),
        np.cos(half_roll) * np.cos(half_pitch),
    )
    cosine, sine = np.cos(pitch[0]), np.sin(pitch[0])
    v[:, :3] = np.einsum("nij,nj->ni", to_body, speed)
    v[:, 3], v[:, 4], v[:, 5] = cosine * roll[1], pitch[1], sine * roll[1]
    a[:, :3] = np.einsum("nij,nj->ni", to_body, thrust) - np.cross(v[:, 3:6], v[:, :3])
    a[:, 3], a[:, 4] = cosine * roll[2] - sine * pitch[1] * roll[1], pitch[2]
    a[:, 5] = sine * roll[2] + cosine * pitch[1] * roll[1]
    for leg, side in enumerate(SIDES):
        start, path = 7 + leg * joints, feet[leg]
        offset = np.einsum("nij,nj->ni", to_body, path.position[0] - place) - hip_center(
            design, side
        )
        q[:, start : start + 6] = leg_angles(
            design, side, offset, to_body @ about_y(path.pitch[0]), check_limits=False
        )
        if toe:
            q[:, start + 6], v[:, start + 5], a[:, start + 5] = path.toe
    frames = [model.model.getFrameId(f"{side}_foot") for side in SIDES]
    columns = [slice(6 + leg * joints, 12 + leg * joints) for leg in range(2)]
    world = pin.LOCAL_WORLD_ALIGNED
    for n in range(count):
        pin.computeJointJacobians(model.model, model.data, q[n])
        pin.updateFramePlacements(model.model, model.data)
        inverse = []
        for leg, frame in enumerate(frames):
            jacobian = np.array(pin.getFrameJacobian(model.model, model.data, frame, world))
            inverse.append(np.linalg.inv(jacobian[:, columns[leg]]))
            v[n, columns[leg]] = inverse[leg] @ (feet[leg].twist(1, n) - jacobian[:, :6] @ v[n, :6])
        pin.forwardKinematics(model.model, model.data, q[n], v[n], a[n])
        for leg, frame in enumerate(frames):
            drift = pin.getFrameClassicalAcceleration(model.model, model.data, frame, world).vector
            a[n, columns[leg]] += inverse[leg] @ (feet[leg].twist(2, n) - drift)
    return q, v, a


def check_ranges(model: RigidBodyModel, q: np.ndarray) -> None:
    """Check that both legs stay within their ranges of motion.

    Args:
        model: floating robot.
        q: configurations, `(n, nq)`.

    Raises:
        InfeasibleError: names the joint and its angle.
    """
    for leg, side in enumerate(SIDES):
        check_range(model.design, side, q[:, 7:].reshape(len(q), 2, -1)[:, leg])


def contact_mask(model: RigidBodyModel, feet: tuple[FootPath, FootPath]) -> np.ndarray:
    """Find which pads bear load while the feet stand as planned.

    Args:
        model: floating robot.
        feet: left and right path.

    Returns:
        True where a pad bears load, `(n, pads)`.
    """
    columns = [feet[SIDES.index(pad.side)].bears(pad.row) for pad in sole_pads(model.tree)]
    return np.stack(columns, -1)


def ground_wrench(
    model: RigidBodyModel, q: np.ndarray, v: np.ndarray, a: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Compute what the ground must give for a motion.

    Args:
        model: floating robot.
        q: configurations, `(n, nq)`.
        v: velocities, `(n, nv)`.
        a: accelerations, `(n, nv)`.

    Returns:
        Force [N] and moment about the world's origin [Nm], in world axes, each `(n, 3)`.
    """
    from hyperleg_design.robot.models import quaternion_matrix

    force, moment = np.zeros((len(q), 3)), np.zeros((len(q), 3))
    for n in range(len(q)):
        rotation = quaternion_matrix(q[n, 3:7])
        base = model.inverse_dynamics(q[n], v[n], a[n])[:6]
        force[n] = rotation @ base[:3]
        moment[n] = rotation @ base[3:] + np.cross(q[n, :3], force[n])
    return force, moment


def zero_moment_offset(force: np.ndarray, moment: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Compute the zero-moment point at the height of a point, relative to that point.

    Args:
        force: of the ground [N], `(n, 3)`.
        moment: about the world's origin [Nm], `(n, 3)`.
        point: in the world [m], `(n, 3)`.

    Returns:
        The offset, `(n, 2)` [m].
    """
    about = moment - np.cross(point, force)
    return np.stack([-about[:, 1], about[:, 0]], -1) / force[:, 2:]


def check_positive(where: str, **values: float) -> None:
    """Check that numbers that describe a motion are positive and finite.

    Args:
        where: name of the plan, for error messages.
        values: the numbers by name.

    Raises:
        InputError: one is not.
    """
    for name, value in values.items():
        if not (np.isfinite(value) and value > 0):
            raise InputError(where, name, value, "must be positive")
