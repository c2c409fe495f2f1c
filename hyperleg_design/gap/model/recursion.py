"""Torques of a kinematic tree by the recursive Newton-Euler algorithm, many ticks at once.

The motion of a frame is one column of fifteen numbers: angular velocity w, angular acceleration,
acceleration of the origin minus gravity, and the six products of the components of w. What the
fixed arm and axes of a joint make of the motion of its parent is linear in these, and so is the
wrench that the inertia of a body needs. So each of both is one product with a constant matrix; only
the turn about the joint's own axis and the joint's own rates come on top.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.model.mechanism import BASE, Mechanism
from hyperleg_design.memoized import memoized

SPIN, ANGULAR, LINEAR, PRODUCTS = slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 15)
"""Rows of a frame's motion: angular velocity, angular acceleration, acceleration of the origin
minus gravity, and products of angular velocities (xx, yy, zz, xy, xz, yz)."""
PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""Of components, in the order of `PRODUCTS`."""


@dataclass(frozen=True, eq=False)
class Joint:
    """What of one joint no motion changes."""

    down: np.ndarray
    """Motion of the joint's frame before it turns, over that of its parent `(9, 15)`."""
    along: np.ndarray
    """Acceleration of a sliding joint's origin over its position and its parent's motion
    `(3, 15)`."""
    wrench: np.ndarray
    """Force and moment that the carried mass needs, over the motion of its frame `(6, 15)`."""
    up: np.ndarray
    """Wrench on the parent over that on the joint's frame before it turned `(6, 6)`."""
    lever: np.ndarray
    """Moment on the parent over a sliding joint's position and the force on it `(3, 3)`."""


@memoized
def fixed_parts(tree: Mechanism) -> tuple[Joint, ...]:
    """Compute the constant matrices of every joint of a tree.

    Args:
        tree: the robot.

    Returns:
        One entry a joint.
    """
    parts = []
    for rotation, offset, inertial in zip(tree.rotation, tree.offset, tree.inertial, strict=True):
        along = rotation.T @ _of_point(rotation[:, 2])
        along[:, LINEAR] = 0.0
        lever = _skew(rotation[:, 2]) @ rotation
        down, up = fixed_motion(rotation, offset), fixed_wrench(rotation, offset)
        parts.append(Joint(down, along, inertial_wrench(inertial), up, lever))
    return tuple(parts)


def fixed_motion(rotation: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """Compute the matrix of the motion of a frame that is fixed in another.

    Args:
        rotation: of the frame in the other `(3, 3)`.
        offset: of the frame in the other `(3,)` [m].

    Returns:
        The frame's motion over that of the other `(9, 15)`.
    """
    matrix = np.zeros((9, 15))
    matrix[SPIN, SPIN] = matrix[ANGULAR, ANGULAR] = rotation.T
    matrix[LINEAR] = rotation.T @ _of_point(offset)
    return matrix


def fixed_wrench(rotation: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """Compute the matrix that carries a wrench over to the frame in which its own is fixed.

    Args:
        rotation: as of `fixed_motion`.
        offset: as of `fixed_motion`.

    Returns:
        Force and moment in the other frame, about its origin, over those in this one `(6, 6)`.
    """
    matrix = np.zeros((6, 6))
    matrix[:3, :3] = matrix[3:, 3:] = rotation
    matrix[3:, :3] = _skew(offset) @ rotation
    return matrix


def inertial_wrench(parameters: np.ndarray) -> np.ndarray:
    """Compute the matrix of the wrench that a rigid body's motion needs.

    Args:
        parameters: inertial parameters, see `Mechanism.inertial`, `(10,)`.

    Returns:
        Force and moment about the origin over the motion of the body's frame `(6, 15)`.
    """
    mass, first, (xx, xy, yy, xz, yz, zz) = parameters[0], parameters[1:4], parameters[4:]
    matrix = np.zeros((6, 15))
    matrix[:3] = _of_point(first)
    matrix[:3, LINEAR] *= mass
    matrix[3:, ANGULAR] = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    matrix[3:, LINEAR] = _skew(first)
    # w x (inertia w)
    matrix[3:, PRODUCTS] = [
        [0.0, yz, -yz, xz, -xy, zz - yy],
        [-xz, 0.0, xz, -yz, xx - zz, xy],
        [xy, -xy, 0.0, yy - xx, yz, -xz],
    ]
    return matrix


def _of_point(place: np.ndarray) -> np.ndarray:
    """Acceleration of a point fixed in a frame over the frame's motion `(3, 15)`; times a mass in
    `place`, the force.
    """
    x, y, z = place
    matrix = np.zeros((3, 15))
    matrix[:, ANGULAR] = -_skew(place)
    matrix[:, LINEAR] = np.eye(3)
    # w x (w x place)
    matrix[:, PRODUCTS] = [
        [0.0, -x, -x, y, z, 0.0],
        [-y, 0.0, -y, x, 0.0, z],
        [-z, -z, 0.0, 0.0, x, y],
    ]
    return matrix


def _skew(vector: np.ndarray) -> np.ndarray:
    """Matrix of the cross product of a vector with another."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def torques(
    tree: Mechanism,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    root: np.ndarray,
    joints: Sequence[int],
) -> tuple[np.ndarray, np.ndarray]:
    """Compute the torques that a motion needs.

    Args:
        tree: the robot, of n joints.
        position: of the joints, from the reference `(n, t)` [rad or m].
        velocity: `(n, t)`.
        acceleration: `(n, t)`.
        root: angular velocity, angular acceleration, and acceleration minus gravity of the base
            `(9, t)`.
        joints: that are computed, parents before children, with all joints of their limbs.

    Returns:
        Torques of these joints `(t, len(joints))`, and the base's wrench, its own and that of these
        joints `(t, 6)`.
    """
    sin, cos = np.sin(position), np.cos(position)
    motions = frame_motions(tree, position, velocity, acceleration, sin, cos, root, joints)
    parts = fixed_parts(tree)
    wrenches = {j: parts[j].wrench @ motions[j] for j in joints}
    wrenches[BASE] = inertial_wrench(tree.base_inertial) @ motions[BASE]
    torque = np.empty((position.shape[1], len(joints)))
    for place in range(len(joints) - 1, -1, -1):
        j = joints[place]
        torque[:, place] = wrenches[j][5] if tree.hinge[j] else wrenches[j][2]
        wrenches[int(tree.parent[j])] += on_parent(
            tree, j, wrenches[j], position[j], sin[j], cos[j]
        )
    return torque, wrenches[BASE].T


def frame_motions(
    tree: Mechanism,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    sin: np.ndarray,
    cos: np.ndarray,
    root: np.ndarray,
    joints: Sequence[int],
) -> dict[int, np.ndarray]:
    """Compute the motion of the frames of some joints, from the base on.

    Args:
        tree: the robot, of n joints.
        position: as of `torques`.
        velocity: as of `torques`.
        acceleration: as of `torques`.
        sin: of the positions `(n, t)`.
        cos: of the positions `(n, t)`.
        root: as of `torques`.
        joints: parents before children, with all joints between them and the base.

    Returns:
        Motion by joint, and of the base, `(15, t)` each.
    """
    parts = fixed_parts(tree)
    motions = {BASE: with_products(root)}
    for j in joints:
        above, part = motions[int(tree.parent[j])], parts[j]
        whole = np.empty((15, position.shape[1]))
        motion = np.matmul(part.down, above, out=whole[:9])
        v, a = velocity[j], acceleration[j]
        if tree.hinge[j]:
            _turn(motion.reshape(3, 3, -1), sin[j], cos[j])
            motion[3] += motion[1] * v
            motion[4] -= motion[0] * v
            motion[5] += a
            motion[2] += v
        else:
            motion[LINEAR] += (part.along @ above) * position[j]
            motion[6] += 2 * motion[1] * v
            motion[7] -= 2 * motion[0] * v
            motion[8] += a
        motions[j] = _products(whole)
    return motions


def on_parent(
    tree: Mechanism,
    joint: int,
    wrench: np.ndarray,
    position: np.ndarray,
    sin: np.ndarray,
    cos: np.ndarray,
) -> np.ndarray:
    """Carry a wrench on the frame of a joint over to the frame of its parent.

    Args:
        tree: the robot.
        joint: index of the joint.
        wrench: force and moment `(6, t)`; it is turned in place.
        position: of the joint `(t,)` [rad or m].
        sin: sine of the position `(t,)`.
        cos: cosine of the position `(t,)`.

    Returns:
        Force and moment on the parent `(6, t)`.
    """
    part = fixed_parts(tree)[joint]
    if tree.hinge[joint]:
        _turn(wrench.reshape(2, 3, -1), -sin, cos)
        return np.asarray(part.up @ wrench)
    up = part.up @ wrench
    up[3:] += (part.lever @ wrench[:3]) * position
    return np.asarray(up)


def _turn(vectors: np.ndarray, sin: np.ndarray, cos: np.ndarray) -> None:
    """Turn vectors `(k, 3, t)` in place into a frame turned about z."""
    x, y = vectors[:, 0], vectors[:, 1]
    across = sin * x
    x *= cos
    x += sin * y
    y *= cos
    y -= across


def with_products(motion: np.ndarray) -> np.ndarray:
    """Append the products of its angular velocities to a motion.

    Args:
        motion: `(9, t)`.

    Returns:
        The motion `(15, t)`.
    """
    return _products(np.concatenate([motion, np.empty((len(PAIRS), motion.shape[1]))]))


def _products(whole: np.ndarray) -> np.ndarray:
    for row, (i, j) in enumerate(PAIRS, start=PRODUCTS.start):
        np.multiply(whole[i], whole[j], out=whole[row])
    return whole
