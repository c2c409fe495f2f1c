"""One limb of a design that writes its tree out, batched: where its links are, what they weigh, and
how its motors drive its joints.

Frames follow URDF: a joint at `position` in its parent's frame, turned by `turn_deg` (roll, pitch,
yaw), then turned about its axis by its angle.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.errors import InfeasibleError, InputError
from hyperleg_design.robot.actuator import actuator_mass
from hyperleg_design.robot.bodies import Inertial, shifted
from hyperleg_design.robot.tree_design import TreeDesign

Frame = tuple[np.ndarray, np.ndarray]
"""Rotation `(..., 3, 3)` and position `(..., 3)` [m] in the root link's frame."""


def axis_rotation(axis: Any, angle: Any) -> np.ndarray:
    """Compute rotations by angles about axes (Rodrigues).

    Args:
        axis: unit vectors, `(..., 3)`.
        angle: [rad], `(...)`.

    Returns:
        Rotation matrices, `(..., 3, 3)`.
    """
    axis, angle = np.asarray(axis, float), np.asarray(angle, float)[..., None, None]
    cross = skew(axis)
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * (cross @ cross))


def skew(vector: np.ndarray) -> np.ndarray:
    """Compute the matrix of a cross product.

    Args:
        vector: `(..., 3)`.

    Returns:
        `(..., 3, 3)`, such that the matrix times b is the vector times b (cross product).
    """
    x, y, z = np.moveaxis(vector, -1, 0)
    zero = np.zeros_like(x)
    return np.stack(
        [np.stack([zero, -z, y], -1), np.stack([z, zero, -x], -1), np.stack([-y, x, zero], -1)], -2
    )


def turned(turn_deg: Any) -> np.ndarray:
    """Compute the rotation Rz Ry Rx of roll, pitch and yaw, as in URDF.

    Args:
        turn_deg: roll, pitch, yaw [deg], `(..., 3)`.

    Returns:
        Rotation matrices, `(..., 3, 3)`.
    """
    roll, pitch, yaw = np.moveaxis(np.deg2rad(np.asarray(turn_deg, float)), -1, 0)
    x, y, z = np.eye(3)
    return axis_rotation(z, yaw) @ axis_rotation(y, pitch) @ axis_rotation(x, roll)


def default_position(design: TreeDesign) -> np.ndarray:
    """Collect the default posture of one limb.

    Args:
        design: a robot or batch.

    Returns:
        Joint angles [rad], `(..., joints)`.
    """
    return of_joints(design, "default_deg") * np.pi / 180


def of_joints(design: TreeDesign, field: str) -> np.ndarray:
    """Collect a number of each joint that moves.

    Args:
        design: a robot or batch.
        field: name of the number.

    Returns:
        The numbers, `(..., joints)`.
    """
    values = [np.asarray(getattr(j, field), float) for j in design.joint_sections.values()]
    return np.stack(np.broadcast_arrays(*values), -1)


def link_frames(design: TreeDesign, position: np.ndarray | None = None) -> dict[str, Frame]:
    """Compute the frames of the root link and of the links of one unmirrored limb.

    Args:
        design: a robot or batch.
        position: joint angles [rad], `(..., joints)`; zero by default.

    Returns:
        Rotation and position in the root's frame, by name of the link.
    """
    moving = list(design.joint_sections)
    frames: dict[str, Frame] = {str(design.trunk.link): (np.eye(3), np.zeros(3))}
    for name, joint in design.all_joints.items():
        rotation, place = frames[joint.parent]
        own = rotation @ turned(joint.turn_deg)
        if position is not None and name in moving:
            own = own @ axis_rotation(joint.axis, position[..., moving.index(name)])
        offset = (rotation @ np.asarray(joint.position, float)[..., None])[..., 0]
        frames[joint.child] = (own, place + offset)
    return frames


def ancestors(design: TreeDesign, link: str) -> list[str]:
    """List the joints between the root link and a link.

    Args:
        design: a robot or batch.
        link: name of the link.

    Returns:
        Names of the joints, from the root.
    """
    parents = {joint.child: name for name, joint in design.all_joints.items()}
    chain: list[str] = []
    while link in parents:
        chain.append(parents[link])
        link = design.all_joints[parents[link]].parent
    return chain[::-1]


def descendants(design: TreeDesign, joint: str) -> list[str]:
    """List all links that a joint moves.

    Args:
        design: a robot or batch.
        joint: name of the joint.

    Returns:
        Names of the links.
    """
    return [
        other.child
        for other in design.all_joints.values()
        if joint in ancestors(design, other.child)
    ]


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
        found = np.stack(np.broadcast_arrays(*limbs), -3)
        return np.broadcast_to(found, (*position.shape, found.shape[-1]))


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
    if np.any(np.abs(right) >= size):
        raise InfeasibleError(
            f"{design.name}: the rod of motor {motor} does not reach in the posture "
            f"{np.round(np.rad2deg(position), 1).tolist()} deg; change rods.{motor} or the ranges "
            f"of the joints"
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


@dataclass(frozen=True, eq=False)
class LimbMasses:
    """Masses of a robot with its tree written out [kg], each `(...)`."""

    trunk: Any
    """Mass of the root link [kg]."""
    limb: Any
    """Mass of one limb, which is all but the root link [kg]."""
    total: Any
    links: Mapping[str, Inertial]
    """Inertials of the root link and of one unmirrored limb, in their own frames."""


def limb_masses(design: TreeDesign) -> LimbMasses:
    """Compute the masses and inertias of a limb by the design's law.

    The law `components` adds a point mass to each link at the place of its motor: the mass of the
    motor with its gear minus that of the reference motor with its gear. A motor in the root link
    counts once for each limb.

    Args:
        design: a robot or batch.

    Returns:
        Links of one limb, their sum, and the mass of the robot.

    Raises:
        InputError: that leaves a link without mass.
    """
    links = {name: _declared(section) for name, section in design.link_sections.items()}
    root = str(design.trunk.link)
    if design.masses.law == "components":
        per_torque = design.masses.gear_mass_per_torque
        for name, actuator in design.actuator_sections.items():
            reference = design.reference_sections[name]
            change = actuator_mass(actuator.motor, actuator.gear, per_torque) - actuator_mass(
                reference.motor, reference.gear, per_torque
            )
            if not np.any(change):
                continue
            places = [np.asarray(actuator.place, float)]
            if actuator.housed_in == root:
                places = [
                    copied(copy, places[0], move=True) for copy in design.copy_sections.values()
                ]
            for place in places:
                links[actuator.housed_in] = with_point(links[actuator.housed_in], change, place)
            heavy = np.asarray(links[actuator.housed_in].mass) > 0
            if not np.all(heavy):
                raise InputError(
                    design.source or design.name,
                    f"links.{actuator.housed_in}.mass",
                    None,
                    f"is less than the reference actuator {name} that leaves it",
                    bad=~heavy,
                )
    limb = sum((np.asarray(v.mass) for n, v in links.items() if n != root), start=np.zeros(()))
    trunk = np.asarray(links[root].mass)
    return LimbMasses(trunk, limb, trunk + len(design.copies) * limb, links)


def with_point(body: Inertial, mass: Any, place: np.ndarray) -> Inertial:
    """Add a point mass to a body, or take it away.

    Args:
        body: mass, centre of mass and inertia.
        mass: of the point [kg], `(...)`; negative to take it away.
        place: of the point [m], `(..., 3)`.

    Returns:
        The changed body.
    """
    total = np.asarray(body.mass + mass, float)
    safe = np.where(total > 0, total, 1.0)[..., None]
    moment = np.asarray(body.mass)[..., None] * body.com + np.asarray(mass)[..., None] * place
    com = np.where(total[..., None] > 0, moment / safe, body.com)
    inertia = body.inertia + shifted(body.mass, body.com - com) + shifted(mass, place - com)
    return Inertial(total, com, inertia)


def _declared(section: Any) -> Inertial:
    mass = np.asarray(section.mass, float)
    diagonal = mass[..., None] * np.asarray(section.gyration, float) ** 2
    xx, yy, zz, xy, xz, yz = np.moveaxis(np.asarray(section.inertia, float), -1, 0)
    stated = np.stack(
        [np.stack([xx, xy, xz], -1), np.stack([xy, yy, yz], -1), np.stack([xz, yz, zz], -1)], -2
    )
    return Inertial(mass, np.asarray(section.com, float), diagonal[..., None] * np.eye(3) + stated)


def copied(copy: Any, place: np.ndarray, *, move: bool = False) -> np.ndarray:
    """Transform a place of the limb to that of a copy of the limb.

    Args:
        copy: section of the copy, which may be mirrored.
        place: in the frame of the limb [m], `(..., 3)`.
        move: whether the place is in the frame of the trunk, so that it moves with the copy.

    Returns:
        The place [m], `(..., 3)`.
    """
    mirror = np.array([1.0, -1.0 if copy.mirror else 1.0, 1.0])
    return np.asarray(place * mirror + (np.asarray(copy.position, float) if move else 0.0))


def behind(
    design: TreeDesign, joint: str, position: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """What moves with a joint, taken as one body.

    Args:
        design: a robot or batch.
        joint: its name.
        position: joint angles [rad]; zero by default.

    Returns:
        Mass [kg] `(...)`, centre of mass in the root's frame [m], inertia about the joint's axis
        [kg m^2] `(...)`, and the joint's axis in the root's frame `(..., 3)`.
    """
    frames, masses = link_frames(design, position), limb_masses(design).links
    section = design.all_joints[joint]
    rotation, origin = frames[section.child]
    axis = (rotation @ np.asarray(section.axis, float)[..., None])[..., 0]
    total, moment, about = np.zeros(()), np.zeros(3), np.zeros(())
    for link in descendants(design, joint):
        turn, place = frames[link]
        body = masses[link]
        com = place + (turn @ np.asarray(body.com)[..., None])[..., 0]
        own = turn @ body.inertia @ np.swapaxes(turn, -1, -2)
        arm = np.cross(axis, com - origin)
        total = total + body.mass
        moment = moment + np.asarray(body.mass)[..., None] * com
        about = about + np.einsum("...i,...ij,...j->...", axis, own, axis)
        about = about + body.mass * np.sum(arm**2, -1)
    return total, moment / np.maximum(total, 1e-12)[..., None], about, axis


def pad_points(design: TreeDesign, position: np.ndarray | None = None) -> np.ndarray:
    """Compute the lowest points of the pads of one limb.

    Args:
        design: a robot or batch.
        position: joint angles [rad], `(..., joints)`; zero by default.

    Returns:
        The points in the frame of the root [m], `(..., pads, 3)`; `(0, 3)` without pads.
    """
    frames = link_frames(design, position)
    points = []
    for pad in design.pad_sections.values():
        rotation, place = frames[pad.link]
        centre = place + (rotation @ np.asarray(pad.position, float)[..., None])[..., 0]
        radius = pad_radius(design, pad)
        drop = np.stack(np.broadcast_arrays(0.0, 0.0, radius), -1)
        points.append(centre - drop)
    return np.stack(np.broadcast_arrays(*points), -2) if points else np.zeros((0, 3))


def pad_radius(design: TreeDesign, pad: Any) -> Any:
    """Look up the radius of a pad; by default that of the design's contact.

    Args:
        design: a robot or batch.
        pad: section of the pad.

    Returns:
        The radius [m], `(...)`.
    """
    return np.where(np.asarray(pad.radius) > 0, pad.radius, design.contact.pad_radius)


def standing_height(design: TreeDesign) -> np.ndarray:
    """Compute the height of the root link's origin above the floor in the zero posture.

    Args:
        design: a robot or batch.

    Returns:
        The height [m], `(...)`.
    """
    if design.trunk.motion == "fixed" or not design.pad_sections:
        return np.asarray(design.trunk.height, float)
    drop = -pad_points(design)[..., 2].min(-1)
    lowest = [
        -np.asarray(copy.position, float)[..., 2] + drop for copy in design.copy_sections.values()
    ]
    return np.asarray(np.max(np.stack(np.broadcast_arrays(*lowest)), 0))
