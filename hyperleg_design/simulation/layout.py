"""Order of joints, motors and sole pads in every array of this room: left leg first, each leg from
the hip down.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

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
    weight: float
    """m g [N]."""
    standing_height: float
    """Hip-pitch axis above the floor, legs straight [m]."""

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


def layout_of(design: Design) -> Layout:
    """Layout of a robot; of a batch of designs, which share it, the layout with the first one's
    numbers.
    """
    one = design.take(0) if design.batch_shape else design
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
