"""Friction that grows with speed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import Excitation, Motion, at_joints
from hyperleg_design.gap.effects.families import FRICTION, LATE
from hyperleg_design.gap.effects.joints.friction import DescribedFriction, JointFriction
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placing import joint_strength
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration

SHARE = 0.02
"""Usual viscous friction at 1 rad/s over the torque that a joint is made for: 1.3-9.7 Nms/rad on
harmonic drives of 100 Nm (BAM)."""
SPEED_SPREAD = 3.0
"""Fastest tenth over slowest tenth of the moving time, that tells viscous from Coulomb friction."""
OF_FRICTION, OF_STRENGTH = 0.12, 0.0007
"""Usual error of the model's friction, over it, and over the torque that the joint is made for."""


class ViscousFriction(DescribedFriction):
    """A joint resists motion in proportion to its velocity, beyond (or, negative, short of) the
    model; trace: damping times velocity.
    """

    identifier: ClassVar[str] = "viscous_friction"
    nuisance_rank: ClassVar[int] = 1
    summary: ClassVar[str] = "a joint resists motion in proportion to its velocity"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            "damping",
            "Nms/rad",
            0.0,
            -50.0,
            100.0,
            2.0,
            "1.3-9.7 Nms/rad on harmonic drives (BAM, arXiv 2410.08650)",
        ),
    )
    share: ClassVar[float] = SHARE
    told_apart: ClassVar[Mapping[str, frozenset[str]]] = {
        "several amplitudes": FRICTION,
        "slow ramp": LATE | {"controller_gain"},
        "cold and warm": frozenset({"torque_constant"}),
    }
    look_alikes: ClassVar[Mapping[str, str]] = {
        "voltage_sag": "drives off: no back-EMF, no damping gain",
        "controller_gain": "drives off: no back-EMF, no damping gain",
    }

    @override
    def nuisance_spreads(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """A share of the model's friction, and of what the joint is made for."""
        spreads = OF_FRICTION * subject.viscous + OF_STRENGTH * joint_strength(subject)
        return {joint: np.array([s]) for joint, s in zip(subject.joints, spreads, strict=True)}

    @override
    def excited(self, log: Log, motion: Motion) -> Excitation:
        varied = motion.reversing & (motion.spread > SPEED_SPREAD)
        lacking = "one speed only: viscous and Coulomb friction look alike"
        return at_joints(self.identifier, motion, varied, "speeds differ", lacking)

    def _torque(self, signals: Signals, joint: int, damping: np.ndarray) -> np.ndarray:
        return damping * signals.velocity[:, joint]

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        """What is taken away never exceeds the model's."""
        joint = subject.joints.index(location)
        return JointFriction(
            location, viscous=np.maximum(np.asarray(values, float)[..., 0], -subject.viscous[joint])
        )

    @staticmethod
    def _described(subject: Subject) -> np.ndarray:
        return subject.viscous
