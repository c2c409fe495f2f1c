"""Friction of constant size."""

from __future__ import annotations

from collections.abc import Mapping, Set
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import REVERSING, Need
from hyperleg_design.gap.effects.families import FRICTION
from hyperleg_design.gap.effects.joints.friction import JointFriction, ModelledFriction
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.usual import COULOMB_LEAST
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.sliding import WIDTH, sliding
from hyperleg_design.simulation.alteration import Alteration

SOURCE = "4-5.6 Nm on harmonic drives of 100 Nm (BAM, arXiv 2410.08650); 0.7 on an RMD-X8"


class CoulombFriction(ModelledFriction):
    """A joint resists sliding with one torque at any speed, beyond (or, negative, short of) the
    friction of the model.

    Trace: torque times the way in which the joint slides, `friction.sliding`.
    """

    identifier: ClassVar[str] = "coulomb_friction"
    summary: ClassVar[str] = "a joint resists motion with a torque of constant size"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            "torque", "Nm", 0.0, -1e4, 1e4, 0.04, SOURCE, spread=COULOMB_LEAST, of_strength=True
        ),
    )
    linear: ClassVar[bool] = True
    described: ClassVar[bool] = True
    needs: ClassVar[Need] = REVERSING
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "slow ramp": FRICTION | {"cogging", "joint_spring"}
    }
    look_alikes: ClassVar[Mapping[str, str]] = {"backlash": "preload"}

    def _torque(self, signals: Signals, joint: int, torque: np.ndarray) -> np.ndarray:
        return torque * sliding(signals)[:, joint]

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        """What is taken away never exceeds the model's, and has its width."""
        joint = subject.joints.index(location)
        torque = np.maximum(np.asarray(values, float)[..., 0], -subject.coulomb[joint])
        return JointFriction(
            location,
            coulomb=torque,
            width=float(subject.friction_speed[joint]) if np.any(torque < 0) else WIDTH,
        )
