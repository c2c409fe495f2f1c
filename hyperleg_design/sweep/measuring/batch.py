"""A batch of designs, and what several measures need of it."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from hyperleg_design.robot import (
    masses,
    transmission,
)
from hyperleg_design.robot.mass.bodies import Inertial
from hyperleg_design.robot.mass.inertials import inertials
from hyperleg_design.robot.parameters.described import RobotDesign
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.sizing.envelope import MotorEnvelope, motor_envelope
from hyperleg_design.sizing.inertia import LegInertia, leg_inertia
from hyperleg_design.sweep.measuring import reference_loads
from hyperleg_design.sweep.measuring.reference_loads import StaticLoad


class Batch:
    """A batch of designs `(n,)` of one variant, and what several measures need of it, computed
    once.
    """

    def __init__(self, design: RobotDesign) -> None:
        self.design: Any = design
        self.size = (design.batch_shape or (1,))[0]
        self.start = 0 if isinstance(design, TreeDesign) else 3
        """First joint of those that `below_hip` holds."""

    @cached_property
    def masses(self) -> masses.MassTable:
        """Masses of the segments of all designs."""
        return masses.mass_table(self.design)

    @cached_property
    def inertials(self) -> dict[str, Inertial]:
        """Inertials of the links of the left leg and of the pelvis."""
        return inertials(self.design)

    @cached_property
    def leg(self) -> LegInertia:
        """Mass and inertia of one leg."""
        return leg_inertia(self.design)

    @cached_property
    def walking(self) -> np.ndarray:
        """`joint_from_motor` in the printed walking posture."""
        return transmission.joint_from_motor(self.design, "walking")

    @cached_property
    def envelope(self) -> MotorEnvelope:
        """Torque-speed envelopes of the motors of one leg."""
        return motor_envelope(self.design)

    @cached_property
    def squat(self) -> StaticLoad:
        """The squat of `reference_loads`, for all designs."""
        return reference_loads.squat(self.design, self.inertials)

    @cached_property
    def push_off(self) -> StaticLoad:
        """The push-off of `reference_loads`, for all designs."""
        return reference_loads.push_off(self.design, self.inertials)

    def below_hip(self) -> tuple[np.ndarray, np.ndarray]:
        """Collect what lies below the hip, in the walking posture; for a design that describes its
        own tree, the whole limb.

        Returns:
            Matrix M [-] and largest torques of the motors at standstill [Nm].
        """
        return self.walking[..., self.start :, self.start :], self.envelope.standstill_torque[
            ..., self.start :
        ]
