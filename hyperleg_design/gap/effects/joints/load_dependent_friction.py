"""Friction of a gear that grows with the torque it transmits."""

from __future__ import annotations

from collections.abc import Mapping, Set
from itertools import compress
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import Need
from hyperleg_design.gap.effects.families import FRICTION
from hyperleg_design.gap.effects.joints.friction import JointFriction
from hyperleg_design.gap.effects.kinds import JointTorque
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.sliding import sliding
from hyperleg_design.simulation.alteration import Alteration

SOURCE = (
    "20-31 % of the motor's torque on small servos, 4-5 % on good gears (BAM); gears that lose "
    "more than half of it cannot be driven back"
)


class LoadDependentFriction(JointTorque):
    """A joint resists sliding with a share of the torque that it transmits: what its motion needs
    by the model, less what turns the rotors. The torque that its drive gives is more by the very
    friction, so that friction of any kind would be a share of it.

    Trace, to first order: coefficient |needed torque - rotors' torque| times the way in which the
    joint slides, `friction.sliding`.
    """

    identifier: ClassVar[str] = "load_dependent_friction"
    resists: ClassVar[bool] = True
    by_load: ClassVar[bool] = True
    nuisance_rank: ClassVar[int] = 3
    summary: ClassVar[str] = "a joint resists motion with a share of the torque that it transmits"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("coefficient", "", 0.0, 0.0, 0.5, 0.1, SOURCE, spread=0.006),
    )
    linear: ClassVar[bool] = True
    needs: ClassVar[Need] = Need(
        lambda motion: motion.reversing & motion.swinging,
        "reverses under different loads",
        "no joint reverses under different loads",
    )
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "preload": FRICTION,
        "known payload": FRICTION,
    }

    @override
    def locations(self, subject: Subject) -> tuple[str, ...]:
        """Joints that some motor moves."""
        return tuple(compress(subject.joints, np.any(subject.joint_from_motor, 1).tolist()))

    def _torque(self, signals: Signals, joint: int, coefficient: np.ndarray) -> np.ndarray:
        subject = signals.subject
        load = signals.rigid[:, joint]
        if signals.behind_gears is None or not signals.behind_gears[joint]:
            load = load - signals.acceleration @ subject.armature[joint]
        return coefficient * (np.abs(load) * sliding(signals)[:, joint])

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        return JointFriction(location, share=np.asarray(values, float)[..., 0])
