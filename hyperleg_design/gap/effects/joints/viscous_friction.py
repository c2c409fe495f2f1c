"""Friction that grows with speed."""

from __future__ import annotations

from collections.abc import Mapping, Set
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import Need
from hyperleg_design.gap.effects.families import FRICTION, LATE
from hyperleg_design.gap.effects.joints.friction import JointFriction, ModelledFriction
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration

SPEED_SPREAD = 3.0
"""Fastest tenth over slowest tenth of the moving time, that tells viscous from Coulomb friction."""
SOURCE = "1.3-9.7 Nms/rad on harmonic drives of 100 Nm (BAM, arXiv 2410.08650)"


class ViscousFriction(ModelledFriction):
    """A joint resists motion in proportion to its velocity, beyond (or, negative, short of) the
    model; trace: damping times velocity.
    """

    identifier: ClassVar[str] = "viscous_friction"
    nuisance_rank: ClassVar[int] = 1
    summary: ClassVar[str] = "a joint resists motion in proportion to its velocity"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            "damping", "Nms/rad", 0.0, -1e4, 1e4, 0.02, SOURCE, spread=0.0007, of_strength=True
        ),
    )
    linear: ClassVar[bool] = True
    described: ClassVar[bool] = True
    model_spread: ClassVar[float] = 0.12
    most: ClassVar[float] = 10.0  # a joint may turn at 0.1 rad/s at most (assumed)
    needs: ClassVar[Need] = Need(
        lambda motion: motion.reversing & (motion.spread > SPEED_SPREAD),
        "speeds differ",
        "one speed only: viscous and Coulomb friction look alike",
    )
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "several amplitudes": FRICTION,
        "slow ramp": LATE | {"controller_gain"},
        "cold and warm": {"torque_constant"},
    }
    look_alikes: ClassVar[Mapping[str, str]] = {
        "voltage_sag": "drives off: no back-EMF, no damping gain",
        "controller_gain": "drives off: no back-EMF, no damping gain",
    }

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
    @override
    def modelled(subject: Subject) -> np.ndarray:
        return subject.viscous
