"""Inverse kinematics of a leg in closed form: three hip axes meet in one point, two ankle axes in
another.

With s = 1 on the left and -1 on the right, the foot stands at

    R_foot = R_pelvis Rz(-s yaw) Rx(s roll) Ry(pitch + knee + ankle pitch) Rx(s ankle roll)

Seen from the foot, the hip lies in the plane of thigh and shank once the ankle's roll is undone.
That gives ankle roll; the cosine rule gives the knee; the plane's angle gives ankle pitch; what is
left of the rotation gives the hip.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.errors import InfeasibleError, InputError
from hyperleg_design.robot.kinematics.tree import SIGN
from hyperleg_design.robot.names import JOINTS
from hyperleg_design.robot.transmission import joint_names

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design


ALIGNED = 1e-9
"""Cosine of the hip's roll below which its yaw and pitch axes count as one."""


def hip_center(design: Design, side: str) -> np.ndarray:
    """Compute the point where the hip axes meet.

    Args:
        design: one robot.
        side: `left` or `right`.

    Returns:
        The point in the frame of the pelvis [m], `(3,)`.
    """
    return np.array([0.0, SIGN[side] * design.hip.spacing / 2, 0.0])


def leg_reach(design: Design, knee: float = 0.0) -> float:
    """Compute the distance from hip to ankle.

    Args:
        design: one robot.
        knee: how far the knee is bent [rad].

    Returns:
        The distance [m].
    """
    thigh, shank = float(design.thigh.length), float(design.shank.length)
    return float(np.sqrt(thigh**2 + shank**2 + 2 * thigh * shank * np.cos(knee)))


def leg_angles(
    design: Design,
    side: str,
    hip_to_ankle: np.ndarray,
    foot_rotation: np.ndarray,
    *,
    check_limits: bool = True,
) -> np.ndarray:
    """Angles of the six joints from hip yaw to ankle roll that bring the foot to a pose.

    Args:
        design: a robot.
        side: `left` or `right`.
        hip_to_ankle: ankle from the hip centre, in the pelvis's frame [m], `(..., 3)`.
        foot_rotation: of the foot, in the pelvis's frame, `(..., 3, 3)`.
        check_limits: whether angles outside the ranges of motion are an error.

    Returns:
        Joint angles [rad], `(..., 6)`, in the order of `JOINTS`; the knee bends the way knees do.

    Raises:
        InputError: a side that is none, or a batch of designs.
        InfeasibleError: the ankle lies beyond the leg's reach, or a joint's range ends before;
        names the joint and its angle.
    """
    if side not in SIGN:
        raise InputError("side", "", side, f"expects one of {', '.join(SIGN)}")
    if design.batch_shape:
        raise InputError(design.name, "", None, "holds a batch of designs; take one of them")
    sign, thigh, shank = SIGN[side], float(design.thigh.length), float(design.shank.length)
    rotation = np.asarray(foot_rotation, float)
    offset = np.asarray(hip_to_ankle, float)
    seen = np.einsum(
        "...ji,...j->...i", rotation, -offset
    )  # hip from the ankle, in the foot's frame
    distance = np.linalg.norm(seen, axis=-1)
    cosine = (distance**2 - thigh**2 - shank**2) / (2 * thigh * shank)
    if np.any(~(np.abs(cosine) <= 1)):
        worst = float(np.max(distance)) if np.any(~(cosine <= 1)) else float(np.min(distance))
        raise InfeasibleError(
            f"{design.name}: {side} leg: the ankle is {worst:.4f} m from the hip; the leg reaches "
            f"{abs(thigh - shank):.4f} .. {thigh + shank:.4f} m"
        )
    knee = np.arccos(cosine)
    roll = np.arctan2(seen[..., 1], seen[..., 2])
    in_plane = np.hypot(seen[..., 1], seen[..., 2])
    ankle_pitch = np.arctan2(-seen[..., 0], in_plane) - np.arctan2(
        thigh * np.sin(knee), shank + thigh * np.cos(knee)
    )
    rest = rotation @ about_x(-roll)
    hip_roll = np.arcsin(np.clip(rest[..., 2, 1], -1.0, 1.0))
    # with the hip rolled by a right angle, yaw and pitch turn about one axis: all of it is pitch
    # then
    aligned = np.hypot(rest[..., 0, 1], rest[..., 1, 1]) < ALIGNED
    hip_yaw = np.where(aligned, 0.0, np.arctan2(-rest[..., 0, 1], rest[..., 1, 1]))
    together = np.where(
        aligned,
        np.arctan2(rest[..., 0, 2], rest[..., 0, 0]),
        np.arctan2(-rest[..., 2, 0], rest[..., 2, 2]),
    )
    hip_pitch = _wrapped(together - knee - ankle_pitch)
    angles = np.stack(
        [-sign * hip_yaw, sign * hip_roll, hip_pitch, knee, ankle_pitch, sign * roll], -1
    )
    if check_limits:
        check_range(design, side, angles)
    return angles


def check_range(design: Design, side: str, angles: np.ndarray, tolerance: float = 1e-9) -> None:
    """Check that joint angles lie within the ranges of motion.

    Args:
        design: one robot.
        side: `left` or `right`, for the error message.
        angles: joint angles in the order of `JOINTS` [rad], `(..., joints)`.
        tolerance: how far beyond a range is allowed [rad].

    Raises:
        InfeasibleError: names the joint that leaves its range by most, and its angle.
    """
    names = JOINTS[: np.shape(angles)[-1]]
    lower = np.deg2rad([getattr(design.joints, n).lower_deg for n in names])
    upper = np.deg2rad([getattr(design.joints, n).upper_deg for n in names])
    flat = np.asarray(angles, float).reshape(-1, len(names))
    beyond = np.maximum(lower - flat, flat - upper)
    if np.any(~(beyond <= tolerance)):
        sample, joint = np.unravel_index(int(np.argmax(beyond)), beyond.shape)
        limits = getattr(design.joints, names[joint])
        raise InfeasibleError(
            f"{design.name}: {side} {names[joint]} would have to turn to "
            f"{np.rad2deg(flat[sample, joint]):.1f} deg; "
            f"its range is {limits.lower_deg:g} .. {limits.upper_deg:g} deg"
        )


def has_toe_joint(design: Design) -> bool:
    """Decide whether the toe can move in its joint.

    Args:
        design: a robot or batch.

    Returns:
        True if it can.
    """
    return len(joint_names(design)) == len(JOINTS)


def about_x(angle: np.ndarray) -> np.ndarray:
    """Compute rotations about x; a positive angle lifts the left side.

    Args:
        angle: [rad], `(...)`.

    Returns:
        Rotation matrices, `(..., 3, 3)`.
    """
    return _turned(angle, 1, 2)


def about_y(angle: np.ndarray) -> np.ndarray:
    """Compute rotations about y; a positive angle pitches the nose down.

    Args:
        angle: [rad], `(...)`.

    Returns:
        Rotation matrices, `(..., 3, 3)`.
    """
    return _turned(angle, 2, 0)


def _turned(angle: np.ndarray, first: int, second: int) -> np.ndarray:
    """Rotations that turn the axis `first` towards the axis `second`, by number."""
    angle = np.asarray(angle, float)
    rotation = np.zeros((*angle.shape, 3, 3))
    rotation[..., range(3), range(3)] = 1.0
    rotation[..., first, first] = rotation[..., second, second] = np.cos(angle)
    rotation[..., second, first] = np.sin(angle)
    rotation[..., first, second] = -rotation[..., second, first]
    return rotation


def _wrapped(angle: np.ndarray) -> np.ndarray:
    return (angle + np.pi) % (2 * np.pi) - np.pi
