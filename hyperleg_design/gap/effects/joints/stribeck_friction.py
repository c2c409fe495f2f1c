"""Friction that falls as a joint breaks away."""

from __future__ import annotations

from collections.abc import Mapping, Set
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import SLOW, Need
from hyperleg_design.gap.effects.joints.friction import JointFriction, ModelledFriction
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.usual import COULOMB_LEAST
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.sliding import sliding
from hyperleg_design.simulation.alteration import Alteration

SPREAD = 0.3 * COULOMB_LEAST
TORQUE_SOURCE = "breakaway 2.4-3.3 Nm against 0.7 Nm sliding on an RMD-X8 of 40 Nm"
SPEED_SOURCE = "0.01-0.3 rad/s (Armstrong-Helouvry et al. 1994; BAM fits)"


class StribeckFriction(ModelledFriction):
    """Breakaway friction in excess of sliding friction, which is gone at speeds above the Stribeck
    speed.

    Trace: torque exp(-(v / speed)^2) times the way in which the joint slides, `friction.sliding`.
    Sliding friction itself is `coulomb_friction`.
    """

    identifier: ClassVar[str] = "stribeck_friction"
    nuisance_rank: ClassVar[int] = 2
    summary: ClassVar[str] = (
        "a joint sticks: friction is larger at rest and at low speed than in fast motion"
    )
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            "torque",
            "Nm",
            0.0,
            0.0,
            1e4,
            0.04,
            TORQUE_SOURCE,
            0.3 * COULOMB_LEAST,
            of_strength=True,
        ),
        Parameter("speed", "rad/s", 0.1, 0.01, 2.0, 0.1, SPEED_SOURCE, shape=True),
    )
    needs: ClassVar[Need] = Need(
        lambda motion: motion.reversing & (motion.slow > SLOW),
        "slow and fast motion",
        "no slow motion: breakaway is passed in a few ticks",
    )
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "slow ramp": {"backlash", "cogging", "load_dependent_friction", "viscous_friction"}
    }

    def _torque(
        self, signals: Signals, joint: int, torque: np.ndarray, speed: np.ndarray
    ) -> np.ndarray:
        fall = np.exp(-((signals.velocity[:, joint] / np.maximum(speed, 1e-6)) ** 2))
        return torque * fall * sliding(signals)[:, joint]

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        values = np.asarray(values, float)
        return JointFriction(
            location, breakaway=values[..., 0], speed=np.maximum(values[..., 1], 1e-6)
        )

    @override
    def steps(self, location: str, subject: Subject) -> np.ndarray:
        """Small against the least Stribeck speed."""
        return np.array([0.1 * self.usual(location, subject)[0], 0.1 * self.parameters[1].low])

    @override
    def starts(self, signals: Signals, location: str) -> np.ndarray:
        """The usual excess at several Stribeck speeds."""
        usual = self.usual(location, signals.subject)[0]
        return np.array([[usual, speed] for speed in (0.03, 0.1, 0.3)])
