"""Friction of constant size."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from hyperleg_design.gap.effects.excitation import FEW, REVERSES, Excitation, Motion, at_joints
from hyperleg_design.gap.effects.families import FRICTION
from hyperleg_design.gap.effects.joints.friction import DescribedFriction, JointFriction
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.usual import least_friction
from hyperleg_design.gap.signals.sliding import WIDTH, sliding

if TYPE_CHECKING:
    from hyperleg_design.gap.logs.log import Log
    from hyperleg_design.gap.model.subject import Subject
    from hyperleg_design.gap.signals.signals import Signals
    from hyperleg_design.simulation.alteration import Alteration

SHARE = 0.04
"""Usual Coulomb friction over the torque that a joint is made for: 4-5 Nm on harmonic drives of 100
Nm (BAM)."""
OF_FRICTION = 0.08
"""Usual error of the model's friction, over it."""


class CoulombFriction(DescribedFriction):
    """A joint resists sliding with one torque at any speed, beyond (or, negative, short of) the
    friction of the model.

    Trace: torque times the way in which the joint slides, `friction.sliding`.
    """

    identifier: ClassVar[str] = "coulomb_friction"
    summary: ClassVar[str] = "a joint resists motion with a torque of constant size"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            "torque",
            "Nm",
            0.0,
            -50.0,
            100.0,
            4.0,
            "4-5.6 Nm on harmonic drives (BAM, arXiv 2410.08650); 0.7 Nm sliding on an RMD-X8",
        ),
    )
    share: ClassVar[float] = SHARE
    told_apart: ClassVar[Mapping[str, frozenset[str]]] = {
        "slow ramp": FRICTION | {"cogging", "joint_spring"},
    }
    look_alikes: ClassVar[Mapping[str, str]] = {
        "backlash": "preload",
    }

    def nuisance_spreads(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """A share of the model's friction, and of what the joint is made for.

        Args:
            subject: the robot.
            step: of its logs [s].

        Returns:
            Standard deviations from the nulls by location `(parameters,)`.
        """
        spreads = OF_FRICTION * subject.coulomb + least_friction(subject)
        return {joint: np.array([s]) for joint, s in zip(subject.joints, spreads, strict=True)}

    def excited(self, log: Log, motion: Motion) -> Excitation:
        """Decide whether a log can show it, see `Effect.excited`.

        Args:
            log: as it was read.
            motion: facts of it.

        Returns:
            Whether the log can show it, where, and why or why not.
        """
        return at_joints(self.identifier, motion, motion.reversing, REVERSES, FEW)

    def _torque(self, signals: Signals, joint: int, torque: np.ndarray) -> np.ndarray:
        return torque * sliding(signals)[:, joint]

    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        """See `Effect.alteration`; what is taken away never exceeds the model's, and has its
        width.

        Args:
            location: one of `locations`.
            values: `(parameters,)`, or `(n, parameters)`, one row a simulation.
            subject: the robot.

        Returns:
            What adds it to a simulation.
        """
        joint = subject.joints.index(location)
        torque = np.maximum(np.asarray(values, float)[..., 0], -subject.coulomb[joint])
        return JointFriction(
            location,
            coulomb=torque,
            width=float(subject.friction_speed[joint]) if np.any(torque < 0) else WIDTH,
        )

    @staticmethod
    def _described(subject: Subject) -> np.ndarray:
        return subject.coulomb
