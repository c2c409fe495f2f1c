"""How heavy a leg is and where its mass lies: what a leg costs to swing, batched over designs.

All in the zero posture: HyperLeg's legs are straight there, thigh above shank. The leg is all that
moves with its first hip joint; what swings is all behind the hip-pitch joint, about whose axis the
swing inertia is taken (the composite rigid-body inertia, that joint's entry of the joint-space
inertia).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.checks.consistency import leg_length
from hyperleg_design.robot.mass.bodies import Inertial
from hyperleg_design.robot.mass.inertials import LEG_LINKS, inertials
from hyperleg_design.robot.models import leg_reflected_inertia
from hyperleg_design.robot.names import JOINTS
from hyperleg_design.robot.trees.tree_design import TreeDesign

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hyperleg_design.robot.design import Design

HIP_PITCH = JOINTS.index("hip_pitch")

SWINGING = LEG_LINKS[HIP_PITCH:]
"""Links behind the hip-pitch joint."""

DISTAL = LEG_LINKS[JOINTS.index("knee") :]
"""Links below the knee."""


@dataclass(frozen=True, eq=False)
class LegInertia:
    """Mass and inertia of a leg, each `(...)`; rotor inertia through the gears is not in it."""

    total_mass: Any
    """Mass of the robot [kg]."""
    leg_mass: Any
    """Mass of all that moves with the first joint of one hip [kg]."""
    distal_mass: Any
    """Below the knee [kg]."""
    leg_length: Any
    """Hip-pitch axis to the sole, straight [m]."""
    swing_mass: Any
    """Behind the hip-pitch joint [kg]."""
    swing_inertia: Any
    """Inertia of all links behind the hip-pitch joint, about the axis of that joint [kg m^2]."""
    com_distance: Any
    """Centre of mass of what swings, from the hip-pitch axis [m]."""

    @property
    def leg_share(self) -> Any:
        """Mass of one leg over the robot's [-]."""
        return self.leg_mass / self.total_mass

    @property
    def distal_share(self) -> Any:
        """Share of the leg's mass that is below the knee [-]."""
        return self.distal_mass / self.leg_mass

    @property
    def inertia_over_leg(self) -> Any:
        """Swing inertia over leg mass and squared leg length [-]; 1/3 for a uniform rod."""
        return self.swing_inertia / (self.leg_mass * self.leg_length**2)

    @property
    def inertia_over_total(self) -> Any:
        """Swing inertia over total mass and squared leg length [-]."""
        return self.swing_inertia / (self.total_mass * self.leg_length**2)

    @property
    def gyration_over_length(self) -> Any:
        """Distal lightness: radius of gyration of the swinging part about the hip, over leg length
        [-]; 0.577 for a uniform rod.
        """
        return np.sqrt(self.swing_inertia / self.swing_mass) / self.leg_length


def leg_inertia(design: Design) -> LegInertia:
    """Mass and inertia of a leg of a design or batch, each `(...)`.

    Args:
        design: a robot, or a batch of `n` robots.

    Returns:
        Masses [kg], lengths [m] and the swing inertia [kg m^2], rotors not included.

    Raises:
        InputError: as `robot.mass.inertials.inertials`, or a design that writes its tree out, which
            names no hip or knee.
    """
    if isinstance(design, TreeDesign):
        remedy = (
            'has no straight leg of its own; analyze(design)["link_inertia"] gives the inertia '
            "behind each joint, mass_table(design) the masses"
        )
        raise InputError(design.name, "family", design.family, remedy)
    links = inertials(design)
    leg_mass = sum(np.asarray(links[name].mass) for name in LEG_LINKS)
    swing_mass, com, inertia = composite(design, links, SWINGING)
    length = np.asarray(leg_length(design), float)
    swing_inertia = inertia[..., 1, 1]
    shape = np.broadcast_shapes(design.batch_shape, swing_inertia.shape)

    def full(value: Any) -> Any:
        return np.broadcast_to(np.asarray(value, float), shape).copy()[()]

    return LegInertia(
        total_mass=full(links["pelvis"].mass + 2 * leg_mass),
        leg_mass=full(leg_mass),
        distal_mass=full(sum(np.asarray(links[name].mass) for name in DISTAL)),
        leg_length=full(length),
        swing_mass=full(swing_mass),
        swing_inertia=full(swing_inertia),
        com_distance=full(np.hypot(com[..., 0], com[..., 2])),
    )


def rotor_swing_inertia(design: Design, posture: str | None = None) -> np.ndarray:
    """Compute what the rotors add to the swing inertia at the hip-pitch joint, its entry of M
    diag(J) M^T.

    Args:
        design: a robot or batch.
        posture: `walking` or `standing`; the design's own by default.

    Returns:
        The inertia [kg m^2], `(...)`.
    """
    return leg_reflected_inertia(design, posture)[..., HIP_PITCH, HIP_PITCH]


def composite(
    design: Design, links: Mapping[str, Inertial], names: tuple[str, ...]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Links of the left leg taken as one body, straight leg.

    Args:
        design: a robot or batch.
        links: its inertials, of `robot.mass.inertials.inertials`.
        names: of the links, from `LEG_LINKS`.

    Returns:
        Mass [kg] `(...)`, centre of mass from the hip centre [m] `(..., 3)`, and inertia about the
        hip centre [kg m^2] `(..., 3, 3)`.
    """
    place = _origins(design)
    mass, moment, inertia = np.zeros(()), np.zeros(3), np.zeros((3, 3))
    for name in names:
        link = links[name]
        weight, centre = np.asarray(link.mass, float), np.asarray(link.com, float) + place[name]
        squared = (
            np.sum(centre**2, -1)[..., None, None] * np.eye(3)
            - centre[..., :, None] * centre[..., None, :]
        )
        mass = mass + weight
        moment = moment + weight[..., None] * centre
        inertia = inertia + link.inertia + weight[..., None, None] * squared
    return mass, moment / mass[..., None], inertia


def _origins(design: Design) -> dict[str, np.ndarray]:
    """Where the frames of the leg's links stand, from the hip centre, straight leg [m], each `(...,
    3)`.
    """

    def at(x: Any, z: Any) -> np.ndarray:
        return np.stack(np.broadcast_arrays(np.asarray(x, float), 0.0, np.asarray(z, float)), -1)

    thigh, shank = np.asarray(design.thigh.length), np.asarray(design.shank.length)
    ankle = thigh + shank
    drop = np.asarray(design.foot.ankle_height) - np.asarray(design.toe.axis_height)
    hip = at(0, 0)
    return {
        "hip_yaw_carrier": hip,
        "hip_roll_carrier": hip,
        "thigh": hip,
        "shank": at(0, -thigh),
        "ankle_cross": at(0, -ankle),
        "foot": at(0, -ankle),
        "toe_plate": at(design.foot.ball_length, -ankle - drop),
    }
