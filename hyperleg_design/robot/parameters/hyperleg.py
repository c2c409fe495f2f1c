"""The parameters of HyperLeg's family: a pelvis and two mirrored legs of seven joints.

The data alone; `robot.design.Design` is the same, checked whenever one is made. Axes: x forward,
y left, z up. Pitch axes point left, so hip flexion is negative, knee flexion, plantar flexion and
toe flexion are positive; yaw and roll axes of the right leg mirror the left's, so equal angles are
mirrored postures.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

from hyperleg_design.robot.names import ACTUATOR_OF_MOTOR, JOINTS, MOTORS, SIDES
from hyperleg_design.robot.parameters.described import RobotDesign
from hyperleg_design.robot.parameters.model_sections import (
    Contact,
    FrictionModel,
    GearModel,
    MassModel,
    StopModel,
)
from hyperleg_design.robot.parameters.reference_sections import ReferenceBuild
from hyperleg_design.robot.parameters.sections import (
    Actuators,
    Electrical,
    Foot,
    Hip,
    Joints,
    Pelvis,
    Segment,
    Toe,
    Transmission,
)

SPRING_LEAVES = ("stiffness", "damping")
"""Leaves of the section `toe` that only a passive toe has."""


@dataclass(frozen=True, eq=False, kw_only=True)
class HyperLeg(RobotDesign):
    """A biped of HyperLeg's kind, or a batch of bipeds that differ in numbers and motors only."""

    family: ClassVar[str] = "hyperleg"
    pelvis: Pelvis
    hip: Hip
    thigh: Segment
    shank: Segment
    foot: Foot
    toe: Toe
    joints: Joints
    actuators: Actuators
    transmission: Transmission
    electrical: Electrical
    reference: ReferenceBuild
    masses: MassModel
    contact: Contact
    stops: StopModel = field(default_factory=StopModel)
    friction: FrictionModel = field(default_factory=FrictionModel)
    gears: GearModel = field(default_factory=GearModel)
    variant: str = "toe"
    """Ablation that made it; informative."""

    @property
    def copies(self) -> tuple[str, ...]:
        """Names of the two sides, which are the two copies of the leg."""
        return SIDES

    @property
    def root_link(self) -> str:
        """Path of the section of the pelvis."""
        return "pelvis"

    @property
    def joint_sections(self) -> dict[str, Any]:
        """Joints that move, by name: all seven, or without the toe where that is locked."""
        names = JOINTS[:-1] if self.toe.joint == "locked" else JOINTS
        return {name: getattr(self.joints, name) for name in names}

    def to_mapping(self) -> dict[str, Any]:
        """Write all leaves as nested plain mappings.

        Returns:
            Each leaf with value, label and source; without the spring where the toe has none.
        """
        result = super().to_mapping()
        if self.toe.joint != "passive":
            for leaf in SPRING_LEAVES:
                del result["toe"][leaf]
        return result

    @property
    def every_actuator(self) -> tuple[Any, ...]:
        """Sections of the seven motors, the toe's among them whether it is installed or not."""
        return tuple(getattr(self.actuators, name) for name in ACTUATOR_OF_MOTOR)

    @property
    def actuator_sections(self) -> dict[str, Any]:
        """Motors that are there, by name: all seven, or without the toe's."""
        names = MOTORS if self.actuators.toe_installed else MOTORS[:-1]
        return dict(zip(names, self.every_actuator, strict=False))
