"""How the motors of one limb of a tree that is written out drive its joints, batched."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hyperleg_design.errors import InfeasibleError
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.robot.trees.tree_limb import Frame, ancestors, default_position, link_frames


def joint_from_motor(design: TreeDesign, position: np.ndarray | None = None) -> np.ndarray:
    """Compute M of one limb.

    Args:
        design: a robot or batch.
        position: joint angles [rad], `(..., joints)`; the default posture by default.

    Returns:
        M [-], `(..., joints, motors)`.

    Raises:
        InfeasibleError: a rod does not reach in this posture.
    """
    joints = list(design.joint_sections)
    position = default_position(design) if position is None else np.asarray(position, float)
    columns = []
    for name, actuator in design.actuator_sections.items():
        if name in design.rod_sections:
            column = crank_turn(design, name, position)[1]
        else:
            ratios = [np.asarray(design.ratio(name, joint), float) for joint in joints]
            column = np.stack(np.broadcast_arrays(*ratios), -1)
        columns.append(column * np.asarray(actuator.gear, float)[..., None])
    return np.stack(np.broadcast_arrays(*columns), -1)


@dataclass(frozen=True, eq=False)
class RodLinkage:
    """The rods of a design, for every limb of many robots at once."""

    design: TreeDesign
    """A robot, or a batch of n."""

    def joint_from_motor(self, position: np.ndarray) -> np.ndarray:
        """M of each limb in its posture [-].

        Args:
            position: joint angles [rad], `(n, limbs, joints)`.

        Returns:
            `(n, limbs, joints, motors)`

        Raises:
            InfeasibleError: a rod does not reach in one of the postures.
        """
        limbs = [
            joint_from_motor(self.design, position[:, limb]) for limb in range(position.shape[1])
        ]
        matrices = np.stack(np.broadcast_arrays(*limbs), -3)
        return np.broadcast_to(matrices, (*position.shape, matrices.shape[-1]))


def motor_position(design: TreeDesign, position: np.ndarray) -> np.ndarray:
    """Compute the motor angles at joint angles; they are zero at zero.

    Args:
        design: a robot or batch.
        position: joint angles [rad], `(..., joints)`.

    Returns:
        Motor angles [rad], `(..., motors)`.

    Raises:
        InfeasibleError: a rod does not reach in this posture.
    """
    joints = list(design.joint_sections)
    angles = []
    for name, actuator in design.actuator_sections.items():
        if name in design.rod_sections:
            turn = crank_turn(design, name, position)[0]
        else:
            parts = [design.ratio(name, j) * position[..., i] for i, j in enumerate(joints)]
            turn = sum(parts, start=np.zeros(position.shape[:-1]))
        angles.append(turn * np.asarray(actuator.gear, float))
    return np.stack(np.broadcast_arrays(*angles), -1)


def crank_turn(
    design: TreeDesign, motor: str, position: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Compute the turn of a linkage's crank and its gradient over the joints.

    The crank's end r(theta) from the crank's axis and the rod's end d(q) from it keep their
    distance, so `r . d - |d|^2 / 2` is constant. With r = r_parallel + cos(theta) u + sin(theta) w
    that is `A cos(theta) + B sin(theta) = C`, and its derivative gives the gradient `(d - r) . d' /
    (r' . d)`.

    Args:
        design: a robot or batch.
        motor: name of the motor that turns the crank.
        position: joint angles [rad], `(..., joints)`.

    Returns:
        The turn [rad], `(...)`, and its gradient [-], `(..., joints)`.

    Raises:
        InfeasibleError: the rod does not reach.
    """
    rod = design.rod_sections[motor]
    axis = np.asarray(rod.axis, float)
    arm = np.asarray(rod.crank_end, float) - np.asarray(rod.crank_axis, float)
    parallel = np.sum(arm * axis, -1, keepdims=True) * axis
    across, ahead = arm - parallel, np.cross(axis, arm)

    def seen(angles: np.ndarray | None) -> tuple[np.ndarray, dict[str, Frame]]:
        frames = link_frames(design, angles)
        (rotation, place), (turn, origin) = frames[rod.carrier], frames[rod.end]
        world = origin + (turn @ np.asarray(rod.rod_end, float)[..., None])[..., 0]
        own = np.swapaxes(rotation, -1, -2) @ (world - place)[..., None]
        return own[..., 0] - np.asarray(rod.crank_axis, float), frames

    start, _ = seen(None)
    reach, frames = seen(position)
    constant = np.sum(arm * start, -1) - np.sum(start**2, -1) / 2
    cosine, sine = np.sum(across * reach, -1), np.sum(ahead * reach, -1)
    right = constant + np.sum(reach**2, -1) / 2 - np.sum(parallel * reach, -1)
    size = np.hypot(cosine, sine)
    beyond = np.abs(right) >= size
    if np.any(beyond):
        angles = np.broadcast_to(np.rad2deg(position), (*beyond.shape, np.shape(position)[-1]))
        posture = ", ".join(
            f"{joint} {angle:.4g} deg"
            for joint, angle in zip(design.joint_sections, angles[beyond][0], strict=True)
        )
        raise InfeasibleError(
            f"{design.name}: the rod of motor {motor} does not reach in the posture {posture}; "
            f"change rods.{motor} or the ranges of the joints"
        )
    side = -np.sign(np.sum(ahead * start, -1))
    angle = np.arctan2(sine, cosine) + side * np.arccos(right / size)
    angle = (angle + np.pi) % (2 * np.pi) - np.pi
    turn = angle[..., None]
    now = parallel + np.cos(turn) * across + np.sin(turn) * ahead
    rate = np.sum((np.cos(turn) * ahead - np.sin(turn) * across) * reach, -1)
    between = [j for j in ancestors(design, rod.end) if j not in ancestors(design, rod.carrier)]
    rotation = frames[rod.carrier][0]
    turn_end, origin = frames[rod.end]
    world = origin + (turn_end @ np.asarray(rod.rod_end, float)[..., None])[..., 0]
    gradient = []
    for name, joint in design.joint_sections.items():
        if name not in between:
            gradient.append(np.zeros(np.shape(angle)))
            continue
        own, place = frames[joint.child]
        about = (own @ np.asarray(joint.axis, float)[..., None])[..., 0]
        moved = np.cross(about, world - place)
        moved = (np.swapaxes(rotation, -1, -2) @ moved[..., None])[..., 0]
        gradient.append(np.sum((reach - now) * moved, -1) / rate)
    return angle, np.stack(np.broadcast_arrays(*gradient), -1)
