"""Order of joints, motors and pads in every array of this room: limb by limb in the design's order
(of HyperLeg the left leg first), each limb from the base outward.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.kinematics.dimensions import total_mass
from hyperleg_design.robot.kinematics.posture import default_angles, link_poses, lowest_point
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.models import GRAVITY
from hyperleg_design.robot.parameters.described import prefixed
from hyperleg_design.simulation.symmetry import mirrored_joints, mirrored_order

if TYPE_CHECKING:
    from hyperleg_design.robot.kinematics.kinematic_tree import Tree
    from hyperleg_design.robot.parameters.described import RobotDesign


@dataclass(frozen=True, eq=False)
class Layout:
    """What the arrays of one robot hold; J joints, K motors, P pads and F feet of all L limbs."""

    joints: tuple[str, ...]
    """Names with the limb's in front, `(J,)`."""
    motors: tuple[str, ...]
    """Names with the limb's in front, `(K,)`."""
    pads: tuple[str, ...]
    """Geoms of the pads in the MuJoCo model, foot after foot, `(P,)`."""
    pad_foot: np.ndarray
    """Foot of each pad, `(P,)`; of HyperLeg 0 left, 1 right."""
    pad_position: np.ndarray
    """Centre of each pad in the frame of its foot's first link, joints of the foot at zero, y to
    the left [m], `(P, 3)`; of HyperLeg from the ankle, toe straight."""
    default: np.ndarray
    """Posture to which actions are added [rad], `(J,)`."""
    lower: np.ndarray
    """Lower ends of the ranges of motion [rad], `(J,)`."""
    upper: np.ndarray
    """Upper ends of the ranges of motion [rad], `(J,)`."""
    weight: Any
    """m g [N]; of a batch `(n,)`."""
    default_height: Any
    """Base's origin above the floor in the default posture [m]; of a batch `(n,)`."""
    limbs: tuple[str, ...] = ("left", "right")
    """Names of the copies of the limb, `(L,)`; one empty name for a robot written out whole."""
    feet: tuple[str, ...] = ("left_foot", "right_foot")
    """First link of each foot, `(F,)`: a link with pads, with all that hangs from it."""
    foot_phase: tuple[float, ...] = (0.0, 0.5)
    """Share of the stride by which each foot is behind the first in a symmetric gait, `(F,)`: 0 or
    0.5; feet on one diagonal step together."""
    base: str = "pelvis"
    """Root link."""
    mirror_joints: tuple[tuple[int, float], ...] = ()
    """Place and sign of each joint's mirror image in the plane y = 0, `(J,)`; empty where the
    robot has none."""
    mirror_feet: tuple[int, ...] = (1, 0)
    """Place of each foot's mirror image, `(F,)`; empty where the robot has none."""
    observed: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(0))
    """Numbers of the design that are observed, scaled by their ranges, `(k,)`."""
    observed_names: tuple[str, ...] = ()
    """Their names, `(k,)`."""

    @property
    def batched(self) -> bool:
        """Whether it is of a batch of robots, whose numbers have the batch in front."""
        return self.default.ndim > 1

    def take(self, rows: Any) -> Layout:
        """Take the layout of some robots of a batch; that of a single robot is the same for all
        rows.

        Args:
            rows: a number for one robot, or an index array or slice.

        Returns:
            The layout.
        """
        if not self.batched:
            return self
        return dataclasses.replace(self, **{name: getattr(self, name)[rows] for name in _NUMBERS})

    @property
    def leg_joints(self) -> int:
        """Number of joints of one leg."""
        return len(self.joints) // len(self.limbs)

    @property
    def leg_motors(self) -> int:
        """Number of motors of one leg."""
        return len(self.motors) // len(self.limbs)

    @cached_property
    def own_joints(self) -> tuple[str, ...]:
        """Names of the joints of one limb, without the limb's, `(J / L,)`."""
        return tuple(_own(name, self.limbs[0]) for name in self.joints[: self.leg_joints])

    @cached_property
    def own_motors(self) -> tuple[str, ...]:
        """Names of the motors of one limb, without the limb's, `(K / L,)`."""
        return tuple(_own(name, self.limbs[0]) for name in self.motors[: self.leg_motors])

    @cached_property
    def hip_sideways(self) -> np.ndarray:
        """Places of hip yaw and roll, `(4,)` of a biped."""
        return self.joint_indices("hip_yaw", "hip_roll")

    def joint_indices(self, *names: str) -> np.ndarray:
        """Find joints in the arrays over all limbs.

        Args:
            names: without the limb's name.

        Returns:
            Their indices.
        """
        own = self.own_joints
        return np.array([i for i in range(len(self.joints)) if own[i % len(own)] in names], int)

    @cached_property
    def pads_of_foot(self) -> tuple[int, ...]:
        """Number of pads of each foot, `(F,)`."""
        return tuple(np.bincount(self.pad_foot, minlength=len(self.feet)).tolist())


_NUMBERS = (
    "pad_position",
    "default",
    "lower",
    "upper",
    "weight",
    "default_height",
    "observed",
)
"""Fields that differ within a batch."""


def layout_of(design: RobotDesign) -> Layout:
    """Compute the layout of a robot.

    Args:
        design: a robot, or a batch of robots with the same joints, motors and pads.

    Returns:
        The layout; the numbers of a batch have the batch in front.
    """
    if design.batch_shape:
        return stacked([layout_of(design.take(i)) for i in range(design.batch_shape[0])])
    tree = build_tree(design)
    first_links = foot_links(tree)
    feet = tuple(dict.fromkeys(first_links.values()))
    pads, owners, places = [], [], []
    for link in tree.links:
        for index, pad in enumerate(link.pads):
            pads.append(f"{link.name}_pad_{index}")
            owners.append(feet.index(first_links[link.name]))
            places.append(
                np.array(pad.position) + _from_link(tree, first_links[link.name], link.name)
            )
    order = np.argsort(owners, kind="stable")
    image = mirrored_joints(tree)
    foot_image = mirrored_order(tree, feet)
    return Layout(
        joints=tuple(joint.name for joint in tree.moving),
        motors=tuple(
            prefixed(limb, motor)
            for limb in design.copies
            for motor in transmission.motor_names(design)
        ),
        pads=tuple(pads[i] for i in order),
        pad_foot=np.array(owners, int)[order],
        pad_position=np.array(places).reshape(-1, 3)[order],
        default=np.array([joint.default for joint in tree.moving]),
        lower=np.array([joint.lower for joint in tree.moving]),
        upper=np.array([joint.upper for joint in tree.moving]),
        weight=float(total_mass(design)) * GRAVITY,
        default_height=_default_height(tree),
        limbs=tuple(design.copies),
        feet=feet,
        foot_phase=_phases(tree, feet),
        base=tree.base,
        mirror_joints=image or (),
        mirror_feet=foot_image or (),
    )


def foot_links(tree: Tree) -> dict[str, str]:
    """Find the foot that each link with pads belongs to.

    A link with pads belongs to the foot of the nearest link with pads that carries it, as a toe
    does; pads of the base are a foot of their own.

    Args:
        tree: the robot.

    Returns:
        First link of the foot, by name of the link.
    """
    carrier = {joint.child: joint.parent for joint in tree.joints}
    links_by_name: dict[str, str] = {}
    for link in tree.links:
        if not link.pads:
            continue
        first, above = link.name, carrier.get(link.name)
        while above is not None and above != tree.base:
            first = links_by_name.get(above, first)
            above = carrier.get(above)
        links_by_name[link.name] = first
    return links_by_name


def _own(name: str, limb: str) -> str:
    return name.removeprefix(f"{limb}_") if limb else name


def _from_link(tree: Tree, first: str, link: str) -> np.ndarray:
    """Position of a link's frame in that of a link that carries it, joints between them at zero
    [m], `(3,)`.
    """
    hanging = {joint.child: joint for joint in tree.joints}
    offset = np.zeros(3)
    while link != first:
        offset = offset + np.array(hanging[link].position)
        link = hanging[link].parent
    return offset


def _default_height(tree: Tree) -> float:
    if not tree.floating:
        return float(tree.height)
    return -lowest_point(tree, link_poses(tree, default_angles(tree)))


def _phases(tree: Tree, feet: Sequence[str]) -> tuple[float, ...]:
    """Phases of a gait in which the feet of one diagonal step together, from where the feet stand
    in the default posture: a foot left of its fellows at the front, and right at the rear, is 0.
    """
    if len(feet) < 2:
        return (0.0,) * len(feet)
    poses = link_poses(tree, default_angles(tree))
    places = np.array([poses[foot][1] for foot in feet])
    rear = places[:, 0] < places[:, 0].mean() - 1e-9 if len(feet) > 2 else np.zeros(len(feet), bool)
    late = (places[:, 1] < 0) ^ rear
    return tuple(0.5 if behind else 0.0 for behind in late)


def stacked(layouts: Sequence[Layout]) -> Layout:
    """Stack layouts of single robots into that of a batch.

    Args:
        layouts: of robots with the same joints, motors and pads.

    Returns:
        The layout, with the batch in front of all numbers.

    Raises:
        InputError: their joints, motors or pads differ.
    """
    first = layouts[0]
    for name in ("joints", "motors", "pads"):
        if any(getattr(layout, name) != getattr(first, name) for layout in layouts[1:]):
            raise InputError(
                "batch", name, None, f"must be the same in all designs of a batch: {name} differ"
            )
    numbers: dict[str, Any] = {
        name: np.stack([getattr(layout, name) for layout in layouts]) for name in _NUMBERS
    }
    return dataclasses.replace(first, **numbers)
