"""Kinematic tree of a robot as plain arrays: one moving frame a joint, its z axis the joint's axis,
and what mass rides on it.

Made from a compiled MuJoCo model, so that whatever file a robot came from, inverse dynamics,
Pinocchio and replays share one set of numbers. Several joints in one body become several frames,
all but the last without mass.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError, meant

if TYPE_CHECKING:
    import mujoco

BASE = -1
"""Place of the base (or, of a fixed one, the world) among the joints."""
MOMENTS = (0, 0, 1, 0, 1, 2), (0, 1, 1, 2, 2, 2)
"""Rows and columns of the six moments of an inertia: xx, xy, yy, xz, yz, zz."""


@dataclass(frozen=True, eq=False)
class Mechanism:
    """Tree of `n` joints that carry `L` links; parents come before children."""

    floating: bool
    joints: tuple[str, ...]
    parent: np.ndarray
    """Joint that carries each joint, `BASE` where none does `(n,)`."""
    rotation: np.ndarray
    """Axes of each joint's frame in its parent's, at the reference position `(n, 3, 3)`."""
    offset: np.ndarray
    """Origin of each joint's frame in its parent's [m] `(n, 3)`."""
    hinge: np.ndarray
    """Whether it turns; it slides otherwise `(n,)`."""
    reference: np.ndarray
    """Position at which the frames stand as given [rad or m] `(n,)`."""
    inertial: np.ndarray
    """Mass, mass times centre of mass, and inertia about the origin (xx, xy, yy, xz, yz, zz) of
    what each joint's frame carries, in that frame `(n, 10)` [kg, kg m, kg m^2]."""
    base_inertial: np.ndarray
    """The same of a floating base, in its own frame `(10,)`."""
    links: tuple[str, ...]
    """Names of the links that can move."""
    link_joint: np.ndarray
    """Joint that carries each link, `BASE` for the floating base and what is fixed to it `(L,)`."""
    link_rotation: np.ndarray
    """Axes of each link's own frame in its joint's `(L, 3, 3)`."""
    link_offset: np.ndarray
    """Origin of each link's own frame in its joint's [m] `(L, 3)`."""
    link_inertial: np.ndarray
    """Inertial parameters of each link in its own frame `(L, 10)`."""

    @property
    def count(self) -> int:
        """The number of joints."""
        return len(self.joints)

    @property
    def mass(self) -> float:
        """Mass of all that can move [kg]."""
        return float(self.base_inertial[0] + self.inertial[:, 0].sum())

    def chain(self, joint: int) -> list[int]:
        """List the joints from the base to a joint, itself included.

        Args:
            joint: index of the joint.

        Returns:
            Indices.
        """
        joints = []
        while joint != BASE:
            joints.append(joint)
            joint = int(self.parent[joint])
        return joints[::-1]

    def chain_to(self, link: int) -> list[int]:
        """List the joints from the base to a link.

        Args:
            link: index of the link.

        Returns:
            Indices of joints.
        """
        return self.chain(int(self.link_joint[link]))

    def limbs(self, joints: Iterable[int]) -> list[int]:
        """List all joints of the limbs that hold some joints: no other joint feels their motion
        where the base's is given.

        Args:
            joints: indices of joints.

        Returns:
            Indices, parents before children.
        """
        roots = {self.chain(j)[0] for j in joints}
        return [j for j in range(self.count) if self.chain(j)[0] in roots]

    def beyond(self, name: str) -> int:
        """Count the joints in a row that a link carries at most: 0 at the ends of a robot, 1 of
        feet with toes and hands with fingers.

        It is 0 for a base, on whose back or in whose trunk loads are as well, and 1 for what is no
        link.

        Args:
            name: of the link, or of the joint that carries it.

        Returns:
            The count.
        """
        if name not in (*self.links, *self.joints):
            return 1
        joint = int(self.link_joint[self.link(name)])
        if joint == BASE:
            return 0
        chains = [self.chain(j) for j in range(self.count)]
        return max(len(chain) - 1 - chain.index(joint) for chain in chains if joint in chain)

    @property
    def length(self) -> float:
        """Of the longest chain, from its first joint to its last [m]."""
        return max(
            (
                float(np.linalg.norm(self.offset[self.chain(j)[1:]], axis=1).sum())
                for j in range(self.count)
            ),
            default=0.0,
        )

    def link(self, name: str) -> int:
        """Find a link by its own name or by that of the joint that carries it (its outermost link).

        Args:
            name: of the link or joint.

        Returns:
            Index of the link.

        Raises:
            InputError: no such link or joint.
        """
        if name in self.links:
            return self.links.index(name)
        if name in self.joints:
            carried = np.flatnonzero(self.link_joint == self.joints.index(name))
            if len(carried):
                return int(carried[0])
        raise InputError("robot", "link", name, f"no such moving link; {meant(name, self.links)}")


def mechanism_of(model: mujoco.MjModel) -> Mechanism:
    """Build the kinematic tree of a compiled MuJoCo model with hinges, slides and at most one free
    joint, at the root.

    Args:
        model: the compiled model.

    Returns:
        The tree.

    Raises:
        InputError: a ball joint, or a free joint elsewhere.
    """
    import mujoco

    kinds = mujoco.mjtJoint
    joints: list[str] = []
    rows: dict[str, list[Any]] = {
        k: [] for k in ("parent", "rotation", "offset", "hinge", "reference")
    }
    inertials: list[np.ndarray] = []
    base_inertial = np.zeros(10)
    frames: list[tuple[int, np.ndarray, np.ndarray]] = [(BASE, np.eye(3), np.zeros(3))]
    moves = [False]
    floating = False
    links: list[tuple[str, int, np.ndarray, np.ndarray, np.ndarray]] = []
    for body in range(1, model.nbody):
        above = int(model.body_parentid[body])
        carrier, rotation, offset = frames[above]
        offset = offset + rotation @ model.body_pos[body]
        rotation = rotation @ quaternion_rotation(model.body_quat[body])
        moving = moves[above]
        first = int(model.body_jntadr[body])
        for joint in range(first, first + int(model.body_jntnum[body])):
            kind, name = model.jnt_type[joint], model.joint(joint).name
            moving = True
            if kind == kinds.mjJNT_FREE:
                if above != 0 or floating:
                    remedy = "is not the root's; one floating base can be understood"
                    raise InputError("robot", name or "free joint", None, remedy)
                floating, carrier, rotation, offset = True, BASE, np.eye(3), np.zeros(3)
                continue
            if kind == kinds.mjJNT_BALL:
                remedy = "ball joints are not understood; model it as three hinges"
                raise InputError("robot", name, "ball", remedy)
            anchor = offset + rotation @ model.jnt_pos[joint]
            axes = _axes_with_z(rotation @ model.jnt_axis[joint])
            rows["parent"].append(carrier)
            rows["rotation"].append(axes)
            rows["offset"].append(anchor)
            rows["hinge"].append(kind == kinds.mjJNT_HINGE)
            rows["reference"].append(model.qpos0[model.jnt_qposadr[joint]])
            inertials.append(np.zeros(10))
            carrier, rotation, offset = len(joints), axes.T @ rotation, axes.T @ (offset - anchor)
            joints.append(name or f"joint_{joint}")
        frames.append((carrier, rotation, offset))
        moves.append(moving)
        if not moving:
            continue
        turned = quaternion_rotation(model.body_iquat[body])
        inertia = turned @ np.diag(model.body_inertia[body]) @ turned.T
        own = inertial_parameters(float(model.body_mass[body]), model.body_ipos[body], inertia)
        links.append((model.body(body).name or f"body_{body}", carrier, rotation, offset, own))
        if carrier == BASE:
            base_inertial += moved_inertial(own, rotation, offset)
        else:
            inertials[carrier] += moved_inertial(own, rotation, offset)
    if not joints:
        raise InputError("robot", "", None, "has no hinge or slide to diagnose")
    return Mechanism(
        floating=floating,
        joints=tuple(joints),
        parent=np.array(rows["parent"]),
        rotation=np.array(rows["rotation"]),
        offset=np.array(rows["offset"]),
        hinge=np.array(rows["hinge"], bool),
        reference=np.array(rows["reference"], float),
        inertial=np.array(inertials),
        base_inertial=base_inertial,
        links=tuple(name for name, *_ in links),
        link_joint=np.array([carrier for _, carrier, *_ in links]),
        link_rotation=np.array([rotation for _, _, rotation, *_ in links]),
        link_offset=np.array([offset for *_, offset, _ in links]),
        link_inertial=np.array([own for *_, own in links]),
    )


def inertial_parameters(mass: float, com: np.ndarray, inertia: np.ndarray) -> np.ndarray:
    """Compute the ten inertial parameters of a body.

    Args:
        mass: [kg].
        com: centre of mass [m], `(3,)`.
        inertia: about the centre of mass [kg m^2], `(3, 3)`.

    Returns:
        Mass, mass times centre of mass, and inertia about the origin, `(10,)`.
    """
    about = inertia + mass * (com @ com * np.eye(3) - np.outer(com, com))
    return np.array([mass, *(mass * com), *about[MOMENTS]])


def mass_properties(parameters: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Compute mass properties from the ten inertial parameters.

    Args:
        parameters: `(10,)`.

    Returns:
        Mass [kg], centre of mass [m] and inertia about it [kg m^2]; a massless body is at the
        origin.
    """
    mass, moment = float(parameters[0]), parameters[1:4]
    com = moment / mass if mass else np.zeros(3)
    return (
        mass,
        com,
        _about_origin(parameters) - mass * (com @ com * np.eye(3) - np.outer(com, com)),
    )


def moved_inertial(parameters: np.ndarray, rotation: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """Transform the ten inertial parameters into another frame.

    Args:
        parameters: in the old frame, `(10,)`.
        rotation: of the old frame in the new one, `(3, 3)`.
        offset: of the old frame in the new one [m], `(3,)`.

    Returns:
        The parameters in the new frame, `(10,)`.
    """
    mass, com, inertia = mass_properties(parameters)
    if not mass:
        moved = rotation @ _about_origin(parameters) @ rotation.T
        return np.array([0, 0, 0, 0, *moved[MOMENTS]])
    return inertial_parameters(mass, offset + rotation @ com, rotation @ inertia @ rotation.T)


def quaternion_rotation(wxyz: np.ndarray) -> np.ndarray:
    """Convert quaternions of any length but zero to rotation matrices.

    Args:
        wxyz: w first, `(..., 4)`.

    Returns:
        `(..., 3, 3)`; NaN where a quaternion is unknown.
    """
    from scipy.spatial.transform import Rotation

    q = np.asarray(wxyz, float)
    rows = q.reshape(-1, 4)
    known = np.isfinite(rows).all(1)
    turned = np.full((len(rows), 3, 3), np.nan)
    turned[known] = Rotation.from_quat(rows[known], scalar_first=True).as_matrix()
    return turned.reshape(*q.shape[:-1], 3, 3)


def _about_origin(parameters: np.ndarray) -> np.ndarray:
    xx, xy, yy, xz, yz, zz = parameters[4:]
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _axes_with_z(axis: np.ndarray) -> np.ndarray:
    """A right-handed frame whose z is the axis, exact for axes along coordinates."""
    z = axis / np.linalg.norm(axis)
    helper = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.cross(helper, z)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], -1)
