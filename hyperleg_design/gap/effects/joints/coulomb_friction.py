"""Friction of constant size."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from hyperleg_design.gap.effects.effect import Effect, Parameter
from hyperleg_design.gap.effects.excitation import FEW, REVERSES, Excitation, Motion, at_joints
from hyperleg_design.gap.effects.families import FRICTION
from hyperleg_design.gap.effects.joints.friction import JointFriction
from hyperleg_design.gap.effects.placing import at_joint, joint_strength
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


class CoulombFriction(Effect):
    """A joint resists sliding with one torque at any speed, beyond (or, negative, short of) the
    friction of the model.

    Trace: torque times the way in which the joint slides, `friction.sliding`.
    """

    identifier: ClassVar[str] = "coulomb_friction"
    kind: ClassVar[str] = "joint"
    described: ClassVar[bool] = True
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
    linear: ClassVar[bool] = True
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
        return at_joints(self.identifier, motion, motion.reversing, REVERSES, FEW)

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
        return at_joint(signals, joint, np.atleast_2d(values)[:, :1] * sliding(signals)[:, joint])

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
                [-subject.coulomb[joint]],
                [min(self.parameters[0].high, joint_strength(subject)[joint])],
            ]
        )
