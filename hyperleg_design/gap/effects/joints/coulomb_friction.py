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
from hyperleg_design.gap.effects.placing import is_logged, is_measured
from hyperleg_design.gap.effects.usual import COULOMB_LEAST
from hyperleg_design.gap.model.friction import turned
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.sliding import WIDTH, sliding
from hyperleg_design.simulation.alteration import Alteration

SOURCE = "4-5.6 Nm on harmonic drives of 100 Nm (BAM, arXiv 2410.08650); 0.7 on an RMD-X8"

SPEEDS = (0.0, 0.03, 0.1, 0.3)
"""Speeds v_s over which friction reverses, as tanh(v / v_s) [rad/s]; 0, at once. Models state 0.01
to 0.3 rad/s; friction of MuJoCo takes some 20 ms to reverse, which looks like it."""
REVERSALS = ("reverses at once", *(f"reverses over {speed:g} rad/s" for speed in SPEEDS[1:]))
"""Choices of the parameter `reversal`."""
LAST = len(REVERSALS) - 1.0
"""The last of them."""
GRADUAL = -6.0
"""Log prior odds for friction that reverses over a speed, over one that does at once (assumed: both
often fit alike) [nat]."""


class CoulombFriction(ModelledFriction):
    """A joint resists sliding with one torque at any speed, beyond (or, negative, short of) the
    friction of the model.

    Trace: torque times the way in which the joint slides, `friction.sliding`, where it reverses at
    once; else times tanh of the speed over one of `SPEEDS`.
    """

    identifier: ClassVar[str] = "coulomb_friction"
    summary: ClassVar[str] = "a joint resists motion with a torque of constant size"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            "torque", "Nm", 0.0, -1e4, 1e4, 0.04, SOURCE, spread=COULOMB_LEAST, of_strength=True
        ),
        Parameter("reversal", "", 0.0, 0.0, LAST, 1.0, "a choice", shape=True, choices=REVERSALS),
    )
    linear: ClassVar[bool] = True
    described: ClassVar[bool] = True
    needs: ClassVar[Need] = REVERSING
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "slow ramp": FRICTION | {"cogging", "joint_spring"}
    }
    look_alikes: ClassVar[Mapping[str, str]] = {"backlash": "preload"}

    def _torque(
        self, signals: Signals, joint: int, torque: np.ndarray, reversal: np.ndarray
    ) -> np.ndarray:
        choices = np.round(reversal).astype(int).ravel().tolist()
        ways = {choice: _way(signals, joint, choice) for choice in set(choices)}
        return torque * np.stack([ways[choice] for choice in choices])

    @override
    def variants(self, signals: Signals, location: str) -> np.ndarray:
        """Each of the ways to reverse; at once alone where no torque is logged, as the error that a
        firmware lets pass looks like a way to reverse.
        """
        subject = signals.subject
        motors = np.flatnonzero(subject.joint_from_motor[subject.joints.index(location)])
        known = any(is_measured(signals, m) or is_logged(signals, m) for m in motors.tolist())
        ways = np.arange(len(SPEEDS) if known else 1)
        return np.stack([np.zeros(len(ways)), ways], 1)

    @override
    def odds(self, location: str, subject: Subject, values: np.ndarray) -> float:
        """Less for one that reverses over a speed."""
        return GRADUAL if np.round(values[1:]).any() else 0.0

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        """What is taken away never exceeds the model's, and has its width."""
        joint = subject.joints.index(location)
        torque, reversal = np.moveaxis(np.asarray(values, float), -1, 0)
        torque = np.maximum(torque, -subject.coulomb[joint])
        width = np.array([WIDTH, *SPEEDS[1:]])[np.round(reversal).astype(int)]
        return JointFriction(
            location,
            coulomb=torque,
            width=np.where(torque < 0, subject.friction_speed[joint], width),
        )


def _way(signals: Signals, joint: int, reversal: int) -> np.ndarray:
    """The way in which a joint slides, by one of the choices of `reversal` `(t,)` [-]."""
    if not reversal:
        return sliding(signals)[:, joint]
    swing = None if signals.limit_cycle is None else signals.limit_cycle.speed[:, joint]
    return turned(signals.velocity[:, joint], SPEEDS[reversal], swing)
