"""Friction that grows with speed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from hyperleg_design.gap.effects.effect import Effect, Parameter
from hyperleg_design.gap.effects.excitation import Excitation, Motion, at_joints
from hyperleg_design.gap.effects.families import FRICTION, LATE
from hyperleg_design.gap.effects.joints.friction import JointFriction
from hyperleg_design.gap.effects.placing import at_joint, joint_strength

if TYPE_CHECKING:
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


class ViscousFriction(Effect):
    """A joint resists motion in proportion to its velocity, beyond (or, negative, short of) the
    model; trace: damping times velocity.
    """

    identifier: ClassVar[str] = "viscous_friction"
    nuisance_rank: ClassVar[int] = 1
    kind: ClassVar[str] = "joint"
    described: ClassVar[bool] = True
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
    linear: ClassVar[bool] = True
    told_apart: ClassVar[Mapping[str, frozenset[str]]] = {
        "several amplitudes": FRICTION,
        "slow ramp": LATE | {"controller_gain"},
        "cold and warm": frozenset({"torque_constant"}),
    }
    look_alikes: ClassVar[Mapping[str, str]] = {
        "voltage_sag": "drives off: no back-EMF, no damping gain",
        "controller_gain": "drives off: no back-EMF, no damping gain",
    }

    def nuisance_spreads(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """A share of the model's friction, and of what the joint is made for.

        Args:
            subject: the robot.
            step: of its logs [s].

        Returns:
            Standard deviations from the nulls by location `(parameters,)`.
        """
        spreads = OF_FRICTION * subject.viscous + OF_STRENGTH * joint_strength(subject)
        return {joint: np.array([s]) for joint, s in zip(subject.joints, spreads, strict=True)}

    def locations(self, subject: Subject) -> tuple[str, ...]:
        """List the joints at which it can sit.

        Args:
            subject: the robot.

        Returns:
            Names of the places; empty where it can sit nowhere on this robot.
        """
        return subject.joints

    def excited(self, log: Log, motion: Motion) -> Excitation:
        """Decide whether a log can show it, see `Effect.excited`.

        Args:
            log: as it was read.
            motion: facts of it.

        Returns:
            Whether the log can show it, where, and why or why not.
        """
        varied = motion.reversing & (motion.spread > SPEED_SPREAD)
        lacking = "one speed only: viscous and Coulomb friction look alike"
        return at_joints(self.identifier, motion, varied, "speeds differ", lacking)

    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        """Compute the residual that it leaves, see `Effect.trace`.

        Args:
            signals: a conditioned log, `t` ticks.
            location: one of `locations`.
            values: `(k, parameters)`, k settings at once.

        Returns:
            By name of the residual `(k, t, rows)` [Nm; N in the ground residual]; residuals that it
            leaves alone are missing.
        """
        joint = signals.subject.joints.index(location)
        return at_joint(signals, joint, np.atleast_2d(values)[:, :1] * signals.velocity[:, joint])

    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        """See `Effect.alteration`; what is taken away never exceeds the model's.

        Args:
            location: one of `locations`.
            values: `(parameters,)`, or `(n, parameters)`, one row a simulation.
            subject: the robot.

        Returns:
            What adds it to a simulation.
        """
        joint = subject.joints.index(location)
        return JointFriction(
            location, viscous=np.maximum(np.asarray(values, float)[..., 0], -subject.viscous[joint])
        )

    def usual(self, location: str, subject: Subject) -> np.ndarray:
        """A share of the torque that the joint is made for.

        Args:
            location: one of `locations`.
            subject: the robot.

        Returns:
            Usual distances from the nulls `(parameters,)`.
        """
        return np.array([SHARE * joint_strength(subject)[subject.joints.index(location)]])

    def bounds(self, location: str, subject: Subject) -> np.ndarray:
        """No less than no friction at all.

        Args:
            location: one of `locations`.
            subject: the robot.

        Returns:
            Least and largest values `(2, parameters)`.
        """
        joint = subject.joints.index(location)
        return np.array(
            [
                [-subject.viscous[joint]],
                [min(self.parameters[0].high, joint_strength(subject)[joint])],
            ]
        )
