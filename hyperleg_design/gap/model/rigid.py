"""Rigid-body dynamics of many ticks at once: torques that a motion needs, and how they depend on
each link's mass.

Recursive Newton-Euler over the tree of `mechanism.Mechanism`, every joint once and all ticks
together, in the joints' own frames, z along the axis (Featherstone, Rigid Body Dynamics Algorithms,
2008, Table 5.1). A uniform velocity of the whole robot changes no torque, so a floating base enters
by its angular velocity, angular acceleration and specific force alone, which is what an inertial
sensor measures. Rotors of coupled motors add `armature` times acceleration, as M diag(J) M^T does
not depend on posture here.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.model.mechanism import BASE

if TYPE_CHECKING:
    from hyperleg_design.gap.model.base import BaseMotion
    from hyperleg_design.gap.model.mechanism import Mechanism
    from hyperleg_design.gap.model.subject import Subject

BLOCK = 4096
"""Ticks worked on together, so that they stay in the processor's cache."""


@dataclass(frozen=True, eq=False)
class _Motion:
    """Of one frame, components first: each `(3, t)`."""

    spin: np.ndarray
    angular: np.ndarray
    """Angular acceleration."""
    linear: np.ndarray
    """Acceleration of the origin minus gravity, as an accelerometer there would feel it."""


def inverse_dynamics(
    subject: Subject,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    base: BaseMotion | None = None,
    *,
    rotors: bool = True,
) -> np.ndarray:
    """Joint torques that a motion needs, without friction, springs or contact [Nm].

    Args:
        subject: robot with n joints.
        position: `(..., t, n)` [rad].
        velocity: the same [rad/s].
        acceleration: the same [rad/s^2].
        base: of a floating base, of t ticks; at rest by default.
        rotors: add the rotors' inertia.

    Returns:
        `(..., t, n)`.
    """
    return _dynamics(subject, position, velocity, acceleration, base, rotors)[0]


def accelerating(
    subject: Subject,
    position: np.ndarray,
    accelerations: Iterable[np.ndarray],
    *,
    rotors: bool = True,
) -> list[np.ndarray]:
    """Compute the torque that each of some accelerations takes of a robot at rest, beyond its
    weight.

    Args:
        subject: the robot.
        position: [rad], `(t, n)`.
        accelerations: [rad/s^2], `(t, n)` or `(n,)` each.
        rotors: whether rotor inertia counts.

    Returns:
        The torques [Nm], `(t, n)` each; see `inverse_dynamics`.
    """
    rest = np.zeros_like(position)
    weight = inverse_dynamics(subject, position, rest, rest, rotors=rotors)
    return [
        inverse_dynamics(subject, position, rest, rest + one, rotors=rotors) - weight
        for one in accelerations
    ]


def base_wrench(
    subject: Subject,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    base: BaseMotion,
) -> np.ndarray:
    """Compute the force and moment that a floating base needs from outside, about its origin and in
    its frame.

    A rotor's own spin pushes back on the base in nature; like MuJoCo's armature, this leaves it
    out.

    Args:
        subject: the robot.
        position: as in `inverse_dynamics`.
        velocity: as in `inverse_dynamics`.
        acceleration: as in `inverse_dynamics`.
        base: motion of the base.

    Returns:
        The wrench [N, Nm], `(..., t, 6)`.
    """
    return _dynamics(subject, position, velocity, acceleration, base, False)[1]


def _dynamics(
    subject: Subject,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    base: BaseMotion | None,
    rotors: bool,
) -> tuple[np.ndarray, np.ndarray]:
    tree = subject.tree
    position, velocity, acceleration = np.broadcast_arrays(position, velocity, acceleration)
    shape = position.shape
    q, v, a = (
        x.reshape(-1, shape[-1]).T for x in (position - tree.reference, velocity, acceleration)
    )
    ticks, rows = q.shape[1], shape[-2] if len(shape) > 1 else 1
    torque, wrench = np.empty((ticks, tree.count)), np.empty((ticks, 6))
    start = _base_start(subject, base, rows)
    for first in range(0, ticks, BLOCK):
        part = slice(first, min(first + BLOCK, ticks))
        index = np.arange(part.start, part.stop) % rows
        root = _Motion(
            *(x[:, index] if x.shape[1] > 1 else np.broadcast_to(x, (3, len(index))) for x in start)
        )
        torque[part], wrench[part] = _newton_euler(
            tree,
            np.ascontiguousarray(q[:, part]),
            np.ascontiguousarray(v[:, part]),
            np.ascontiguousarray(a[:, part]),
            root,
        )
    if rotors:
        torque += a.T @ subject.armature.T
    return torque.reshape(shape), wrench.reshape(*shape[:-1], 6)


def _base_start(
    subject: Subject, base: BaseMotion | None, rows: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    if base is None or not subject.floating:
        return np.zeros((3, 1)), np.zeros((3, 1)), -np.asarray(subject.gravity, float)[:, None]
    return base.angular_velocity.T, base.angular_acceleration.T, base.specific_force.T


def _newton_euler(
    tree: Mechanism, q: np.ndarray, v: np.ndarray, a: np.ndarray, root: _Motion
) -> tuple[np.ndarray, np.ndarray]:
    """Torques `(t, n)` and the base's wrench `(t, 6)`; inputs `(n, t)`."""
    count, ticks = q.shape
    sin, cos = np.sin(q), np.cos(q)
    motions: list[_Motion] = []
    forces, moments = [], []
    for j in range(count):
        above = root if tree.parent[j] == BASE else motions[tree.parent[j]]
        motions.append(_child_motion(tree, j, above, q[j], v[j], a[j], sin[j], cos[j]))
        force, moment = _inertial_wrench(tree.inertial[j], motions[j])
        forces.append(force)
        moments.append(moment)
    force, moment = _inertial_wrench(tree.base_inertial, root)
    torque = np.empty((ticks, count))
    for j in range(count - 1, -1, -1):
        torque[:, j] = moments[j][2] if tree.hinge[j] else forces[j][2]
        up_force, up_moment = _to_parent(tree, j, forces[j], moments[j], q[j], sin[j], cos[j])
        above_index = int(tree.parent[j])
        if above_index == BASE:
            force, moment = force + up_force, moment + up_moment
        else:
            forces[above_index] = forces[above_index] + up_force
            moments[above_index] = moments[above_index] + up_moment
    return torque, np.concatenate([force, moment]).T


def _child_motion(
    tree: Mechanism,
    j: int,
    above: _Motion,
    q: np.ndarray,
    v: np.ndarray,
    a: np.ndarray,
    sin: np.ndarray,
    cos: np.ndarray,
) -> _Motion:
    arm = tree.offset[j]
    hinge = bool(tree.hinge[j])
    linear = above.linear
    if not hinge or np.any(arm):
        lever: np.ndarray = arm[:, None] if hinge else arm[:, None] + tree.rotation[j][:, 2:] * q
        linear = (
            linear + _cross(above.angular, lever) + _cross(above.spin, _cross(above.spin, lever))
        )
    into = tree.rotation[j].T
    spin, angular, linear = into @ above.spin, into @ above.angular, into @ linear
    if hinge:
        spin, angular, linear = (
            _turned(spin, sin, cos),
            _turned(angular, sin, cos),
            _turned(linear, sin, cos),
        )
        angular[0] += spin[1] * v
        angular[1] -= spin[0] * v
        angular[2] += a
        spin[2] += v
        return _Motion(spin, angular, linear)
    linear[0] += 2 * spin[1] * v
    linear[1] -= 2 * spin[0] * v
    linear[2] += a
    return _Motion(spin, angular, linear)


def _inertial_wrench(parameters: np.ndarray, motion: _Motion) -> tuple[np.ndarray, np.ndarray]:
    """Force and moment about the origin that a rigid body's motion needs, `(3, t)` each."""
    if not parameters.any():
        return np.zeros_like(motion.linear), np.zeros_like(motion.linear)
    mass, first, xx, xy, yy, xz, yz, zz = parameters[0], parameters[1:4, None], *parameters[4:]
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    force = (
        mass * motion.linear
        + _cross(motion.angular, first)
        + _cross(motion.spin, _cross(motion.spin, first))
    )
    moment = (
        inertia @ motion.angular
        + _cross(motion.spin, inertia @ motion.spin)
        + _cross(first, motion.linear)
    )
    return force, moment


def _to_parent(
    tree: Mechanism,
    j: int,
    force: np.ndarray,
    moment: np.ndarray,
    q: np.ndarray,
    sin: np.ndarray,
    cos: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    if tree.hinge[j]:
        force, moment = _turned(force, -sin, cos), _turned(moment, -sin, cos)
    force, moment = tree.rotation[j] @ force, tree.rotation[j] @ moment
    lever = tree.offset[j][:, None]
    if not tree.hinge[j]:
        lever = lever + tree.rotation[j][:, 2:] * q
    return force, moment + _cross(lever, force)


def _turned(x: np.ndarray, sin: np.ndarray, cos: np.ndarray) -> np.ndarray:
    """Components in a frame turned about z."""
    out = np.empty(np.broadcast_shapes(x.shape, (3, *sin.shape)))
    out[0] = cos * x[0] + sin * x[1]
    out[1] = cos * x[1] - sin * x[0]
    out[2] = x[2]
    return out


def _cross(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Cross product over the first axis; `np.cross` copies its arguments about."""
    out = np.empty((3, max(x.shape[1], y.shape[1])))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        np.multiply(x[j], y[k], out=out[i])
        out[i] -= x[k] * y[j]
    return out


def regressor(
    subject: Subject,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    base: BaseMotion | None,
    link: str,
) -> np.ndarray:
    """Compute the joint torques over the ten inertial parameters of one link.

    Args:
        subject: the robot.
        position: [rad], `(t, n)`.
        velocity: [rad/s], `(t, n)`.
        acceleration: [rad/s^2], `(t, n)`.
        base: motion of a floating base; None for a fixed one.
        link: name of the link.

    Returns:
        The regressor, `(t, n, 10)`; see `signals.regressor.link_regressor`.
    """
    return regressors(subject, position, velocity, acceleration, base, link)[0]


def regressors(
    subject: Subject,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    base: BaseMotion | None,
    link: str,
) -> tuple[np.ndarray, np.ndarray]:
    """Compute joint torques and the base's wrench over the ten inertial parameters of one link.

    Args:
        subject: the robot.
        position: [rad], `(t, n)`.
        velocity: [rad/s], `(t, n)`.
        acceleration: [rad/s^2], `(t, n)`.
        base: motion of a floating base; None for a fixed one.
        link: name of the link.

    Returns:
        Torques `(t, n, 10)` and wrench `(t, 6, 10)`, each per unit of the parameters.
    """
    tree = subject.tree
    place = tree.link(link)
    chain = tree.chain(int(tree.link_joint[place]))
    q, v, a = (
        np.ascontiguousarray(x.T) for x in (position - tree.reference, velocity, acceleration)
    )
    ticks = q.shape[1]
    motion = _Motion(*(np.broadcast_to(x, (3, ticks)) for x in _base_start(subject, base, ticks)))
    sin, cos = np.sin(q), np.cos(q)
    for j in chain:
        motion = _child_motion(tree, j, motion, q[j], v[j], a[j], sin[j], cos[j])
    arm, into = tree.link_offset[place][:, None], tree.link_rotation[place].T
    linear = (
        motion.linear + _cross(motion.angular, arm) + _cross(motion.spin, _cross(motion.spin, arm))
    )
    block = _body_regressor(_Motion(into @ motion.spin, into @ motion.angular, into @ linear))
    columns = block.shape[1]
    # Ten wrenches, each carried down the chain like any other.
    force, moment = block[:3].reshape(3, -1), block[3:].reshape(3, -1)
    force, moment = into.T @ force, into.T @ moment
    moment = moment + _cross(arm, force)
    torque = np.zeros((ticks, tree.count, columns))
    for j in reversed(chain):
        own = moment if tree.hinge[j] else force
        torque[:, j] = own[2].reshape(columns, ticks).T
        force, moment = _to_parent(
            tree,
            j,
            force,
            moment,
            np.tile(q[j], columns),
            np.tile(sin[j], columns),
            np.tile(cos[j], columns),
        )
    return torque, np.concatenate([force, moment]).reshape(6, columns, ticks).transpose(2, 0, 1)


def _body_regressor(motion: _Motion) -> np.ndarray:
    """Force and moment over the ten parameters of a body in its own frame `(6, 10, t)`."""
    spin, angular, linear = motion.spin, motion.angular, motion.linear
    block = np.zeros((6, 10, linear.shape[1]))
    block[:3, 0] = linear
    for column, axis in enumerate(np.eye(3)):
        first = axis[:, None]
        block[:3, 1 + column] = _cross(angular, first) + _cross(spin, _cross(spin, first))
        block[3:, 1 + column] = _cross(first, linear)
    for column, (i, j) in enumerate(((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))):
        unit = np.zeros((3, 3))
        unit[i, j] = unit[j, i] = 1.0
        block[3:, 4 + column] = unit @ angular + _cross(spin, unit @ spin)
    return block


def link_poses(
    subject: Subject, position: np.ndarray, links: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Where links stand in the base's frame (the world's, of a fixed base).

    Args:
        subject: the robot.
        position: `(t, n)` [rad].
        links: places among `subject.links` `(k,)`.

    Returns:
        Axes `(t, k, 3, 3)` and origins `(t, k, 3)` [m].
    """
    tree = subject.tree
    frames = joint_frames(tree, position)
    ticks = len(position)
    axes, origins = np.empty((ticks, len(links), 3, 3)), np.empty((ticks, len(links), 3))
    for row, link in enumerate(links):
        carrier = int(tree.link_joint[link])
        rotation, origin = (
            (np.eye(3)[None], np.zeros((1, 3))) if carrier == BASE else frames[carrier]
        )
        axes[:, row] = rotation @ tree.link_rotation[link]
        origins[:, row] = origin + rotation @ tree.link_offset[link]
    return axes, origins


def joint_frames(tree: Mechanism, position: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Compute the frames of all joints in the base's frame.

    Args:
        tree: the robot.
        position: [rad], `(t, n)`.

    Returns:
        Axes `(t, 3, 3)` and origin `(t, 3)` [m] of each joint's frame.
    """
    frames: list[tuple[np.ndarray, np.ndarray]] = []
    angle = position - tree.reference
    for j in range(tree.count):
        above, origin = (
            (np.eye(3)[None], np.zeros((1, 3)))
            if tree.parent[j] == BASE
            else frames[tree.parent[j]]
        )
        axes, origin = above @ tree.rotation[j], origin + above @ tree.offset[j]
        if tree.hinge[j]:
            sin, cos = np.sin(angle[:, j])[:, None], np.cos(angle[:, j])[:, None]
            axes = np.stack(
                [
                    axes[..., 0] * cos + axes[..., 1] * sin,
                    axes[..., 1] * cos - axes[..., 0] * sin,
                    np.broadcast_to(axes[..., 2], (len(angle), 3)),
                ],
                -1,
            )
        else:
            axes, origin = (
                np.broadcast_to(axes, (len(angle), 3, 3)),
                origin + axes[..., 2] * angle[:, j, None],
            )
        frames.append((axes, np.broadcast_to(origin, (len(angle), 3))))
    return frames


def contact_torque(
    subject: Subject,
    position: np.ndarray,
    rotation: np.ndarray | None,
    force: np.ndarray,
    lift: np.ndarray | float = 0.0,
) -> tuple[np.ndarray, np.ndarray]:
    """What forces of the ground do at the joints and at the base.

    Args:
        subject: the robot, with P pads.
        position: `(t, n)` [rad].
        rotation: world from base `(t, 3, 3)`; none of a fixed base.
        force: on each pad, in the world `(t, P, 3)` [N]; it acts where the pad's sphere is lowest,
        lift: or so far above that, `()` or `(t, P)` [m].

    Returns:
        Generalised torque J^T f `(t, n)` [Nm], and force and moment on the base in its own frame
        `(t, 6)`.
    """
    tree = subject.tree
    rotation = np.broadcast_to(np.eye(3), (len(position), 3, 3)) if rotation is None else rotation
    into = np.swapaxes(rotation, -1, -2)
    local = np.einsum("tij,tpj->tpi", into, force)
    points = (
        pad_points(subject, position, rotation)
        + np.asarray(lift)[..., None] * rotation[:, None, 2, :]
    )
    frames = joint_frames(tree, position)
    torque = np.zeros((len(position), tree.count))
    for row, pad in enumerate(subject.pads):
        for j in tree.chain(int(tree.link_joint[pad.link])):
            axes, origin = frames[j]
            arm = points[:, row] - origin if tree.hinge[j] else None
            column = np.cross(axes[..., 2], arm) if arm is not None else axes[..., 2]
            torque[:, j] += np.einsum("ti,ti->t", column, local[:, row])
    moment = np.cross(points, local).sum(1)
    return torque, np.concatenate([local.sum(1), moment], -1)


def pad_points(subject: Subject, position: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """Compute the lowest point of each pad.

    Args:
        subject: the robot.
        position: [rad], `(t, n)`.
        rotation: world from base, `(t, 3, 3)`.

    Returns:
        The points in the base's frame [m], `(t, P, 3)`.
    """
    axes, origins = link_poses(subject, position, np.array([p.link for p in subject.pads], int))
    centre = origins + np.einsum("tpij,pj->tpi", axes, np.array([p.position for p in subject.pads]))
    return centre - np.array([p.radius for p in subject.pads])[:, None] * rotation[:, None, 2, :]


def pad_rolling(
    subject: Subject, position: np.ndarray, rotation: np.ndarray, step: float
) -> np.ndarray:
    """Compute the velocity of each pad's lowest point relative to its centre: a pad that rolls does
    not slide.

    Args:
        subject: the robot.
        position: of the joints `(t, n)` [rad].
        rotation: world from base `(t, 3, 3)`.
        step: between ticks [s].

    Returns:
        The velocity in the world's frame [m/s], `(t, P, 3)`.
    """
    axes = (
        rotation[:, None]
        @ link_poses(subject, position, np.array([p.link for p in subject.pads], int))[0]
    )
    down = np.array([0.0, 0.0, -1.0]) * np.array([p.radius for p in subject.pads])[:, None]
    return np.einsum("tpij,tpkj,pk->tpi", np.gradient(axes, step, axis=0), axes, down)
