"""Order of joints, motors and sole pads in every array of this room: left leg first, each leg from
the hip down.
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
from hyperleg_design.robot.consistency import leg_length
from hyperleg_design.robot.masses import mass_table
from hyperleg_design.robot.names import SIDES
from hyperleg_design.robot.tree import build_tree

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design

GRAVITY = 9.81
"""[m/s^2], as in the MuJoCo model."""


@dataclass(frozen=True, eq=False)
class Layout:
    """What the arrays of one robot hold; J joints, K motors and P pads of both legs."""

    joints: tuple[str, ...]
    """Names with the side in front, `(J,)`."""
    motors: tuple[str, ...]
    """Names with the side in front, `(K,)`."""
    pads: tuple[str, ...]
    """Geoms of the sole pads in the MuJoCo model, as many of the left foot as of the right,
    `(P,)`."""
    pad_foot: np.ndarray
    """Foot of each pad, 0 left, 1 right, `(P,)`."""
    pad_position: np.ndarray
    """Centre of each pad from the ankle in its foot's frame, toe straight, y to the left [m], `(P,
    3)`."""
    default: np.ndarray
    """Posture to which actions are added [rad], `(J,)`."""
    lower: np.ndarray
    """Lower ends of the ranges of motion [rad], `(J,)`."""
    upper: np.ndarray
    """Upper ends of the ranges of motion [rad], `(J,)`."""
    weight: Any
    """m g [N]; of a batch `(n,)`."""
    standing_height: Any
    """Hip-pitch axis above the floor, legs straight [m]; of a batch `(n,)`."""

    @property
    def batched(self) -> bool:
        """Whether it is of a batch of robots, whose numbers have the batch in front."""
        return self.default.ndim > 1

    def take(self, rows: Any) -> Layout:
        """Layout of one robot of a batch by its number, or of several by an index array or slice;
        a single robot's is the same for all rows.
        """
        if not self.batched:
            return self
        return dataclasses.replace(self, **{name: getattr(self, name)[rows] for name in _NUMBERS})

    @property
    def leg_joints(self) -> int:
        """Joints of one leg."""
        return len(self.joints) // 2

    @property
    def leg_motors(self) -> int:
        """Motors of one leg."""
        return len(self.motors) // 2

    @cached_property
    def hip_sideways(self) -> np.ndarray:
        """Places of hip yaw and roll, `(4,)`."""
        return self.joint_indices("hip_yaw", "hip_roll")

    def joint_indices(self, *names: str) -> np.ndarray:
        """Places of joints, given without the side, in both legs."""
        return np.array(
            [i for i, joint in enumerate(self.joints) if joint.split("_", 1)[1] in names], int
        )


_NUMBERS = ("pad_position", "default", "lower", "upper", "weight", "standing_height")
"""Fields that differ within a batch."""


def layout_of(design: Design) -> Layout:
    """Layout of a robot, or of a batch of robots with the same joints, motors and pads, whose
    numbers then have the batch in front.
    """
    if design.batch_shape:
        return stacked([layout_of(design.take(i)) for i in range(design.batch_shape[0])])
    one = design
    tree = build_tree(one)
    toe_axis = np.array([one.foot.ball_length, 0.0, -(one.foot.ankle_height - one.toe.axis_height)])
    pads, feet, places = [], [], []
    for link in tree.links:
        for index, pad in enumerate(link.pads):
            pads.append(f"{link.name}_pad_{index}")
            feet.append(0 if link.name.startswith(SIDES[0]) else 1)
            places.append(
                np.array(pad.position) + (toe_axis if link.name.endswith("toe_plate") else 0.0)
            )
    return Layout(
        joints=tuple(joint.name for joint in tree.moving),
        motors=tuple(
            f"{side}_{motor}" for side in SIDES for motor in transmission.motor_names(one)
        ),
        pads=tuple(pads),
        pad_foot=np.array(feet),
        pad_position=np.array(places),
        default=np.array([joint.default for joint in tree.moving]),
        lower=np.array([joint.lower for joint in tree.moving]),
        upper=np.array([joint.upper for joint in tree.moving]),
        weight=float(mass_table(one).total) * GRAVITY,
        standing_height=float(leg_length(one)),
    )


def stacked(layouts: Sequence[Layout]) -> Layout:
    """Layouts of robots with the same joints, motors and pads as that of a batch.

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
        name: np.stack([getattr(one, name) for one in layouts]) for name in _NUMBERS
    }
    return dataclasses.replace(first, **numbers)
