"""Springs at joints that the model does not have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import POSTURES, STILL, Excitation, Motion, at_joints
from hyperleg_design.gap.effects.families import INERTIAL
from hyperleg_design.gap.effects.kinds import JointTorque
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placing import joint_strength
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration, Live, Tick

SHARE = 0.05
"""Usual stiffness a radian, and preload, over the torque that a joint is made for (assumed: cables
and seals)."""
STIFFNESS, TORQUE = 0.002, 0.002
"""Usual error of the torque a radian, and at rest, over the torque that the joint is made for."""


class JointSpring(JointTorque):
    """A cable, a seal or a spring pulls a joint back: stiffness (q - default) + preload, default
    the robot's posture at rest.

    It rests at default - preload / stiffness. Trace: that torque.
    """

    identifier: ClassVar[str] = "joint_spring"
    nuisance_rank: ClassVar[int] = 5
    summary: ClassVar[str] = "a cable or a spring pulls a joint towards some angle"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            "stiffness",
            "Nm/rad",
            0.0,
            -100.0,
            500.0,
            2.0,
            "cable bundles and seals, 5 % of the joint's torque a radian (assumed)",
        ),
        Parameter(
            "preload",
            "Nm",
            0.0,
            -100.0,
            100.0,
            2.0,
            "as the stiffness, at the posture of rest (assumed)",
        ),
    )
    linear: ClassVar[bool] = True
    told_apart: ClassVar[Mapping[str, frozenset[str]]] = {
        "several amplitudes": frozenset({"backlash", "coulomb_friction"}),
        "several postures": INERTIAL,
    }

    @override
    def nuisance_spreads(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """Shares of what the joint is made for."""
        shares = np.array([STIFFNESS, TORQUE])
        return {
            joint: shares * s
            for joint, s in zip(subject.joints, joint_strength(subject), strict=True)
        }

    @override
    def excited(self, log: Log, motion: Motion) -> Excitation:
        return at_joints(self.identifier, motion, motion.swinging, POSTURES, STILL)

    def _torque(
        self, signals: Signals, joint: int, stiffness: np.ndarray, preload: np.ndarray
    ) -> np.ndarray:
        rest = signals.subject.default[joint]
        return stiffness * (signals.position[:, joint] - rest) + preload

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        values = np.asarray(values, float)
        return Spring(
            location,
            values[..., 0],
            values[..., 1],
            float(subject.default[subject.joints.index(location)]),
        )

    @override
    def usual(self, location: str, subject: Subject) -> np.ndarray:
        """A share of the torque that the joint is made for."""
        return np.full(2, SHARE * joint_strength(subject)[subject.joints.index(location)])

    @override
    def bounds(self, location: str, subject: Subject) -> np.ndarray:
        """Less stiff than the model's springs by no more than these; preload up to the torque that
        the joint is made for.
        """
        joint = subject.joints.index(location)
        strength = joint_strength(subject)[joint]
        found = super().bounds(location, subject)
        return np.array(
            [
                np.maximum(found[0], [-subject.spring[joint], -strength]),
                np.minimum(found[1], [20 * strength, strength]),
            ]
        )

    @override
    def derived(
        self, location: str, values: np.ndarray, subject: Subject
    ) -> dict[str, tuple[float, str]]:
        """Angle at which it rests."""
        stiffness, preload = values
        default = float(subject.default[subject.joints.index(location)])
        return {"rest": (default - float(preload) / float(stiffness), "rad")} if stiffness else {}

    @override
    def starts(self, signals: Signals, location: str) -> np.ndarray:
        """A spring, and a bare preload either way."""
        usual = self.usual(location, signals.subject)
        return np.array([[usual[0], 0.0], [0.0, usual[1]], [0.0, -usual[1]]])


class _Pull(Live):
    alteration: Spring

    def prepare(self) -> None:
        self.place = self.machine.joint(self.alteration.joint)

    def joint_torque(self, tick: Tick) -> np.ndarray:
        one, out = self.alteration, np.zeros_like(tick.position)
        out[:, self.place] = -(
            one.stiffness * (tick.position[:, self.place] - one.rest) + one.preload
        )
        return out


@dataclass(frozen=True, eq=False)
class Spring(Alteration):
    """Pulls a joint by -(stiffness (q - rest) + preload)."""

    live: ClassVar[type[Live] | None] = _Pull
    joint: str
    stiffness: Any
    preload: Any
    """`()` or `(n,)` each [Nm/rad, Nm]."""
    rest: float
    """[rad]"""
