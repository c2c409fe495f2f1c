"""Springs at joints that the model does not have."""

from __future__ import annotations

from collections.abc import Mapping, Set
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import SWINGING, Need
from hyperleg_design.gap.effects.families import INERTIAL
from hyperleg_design.gap.effects.kinds import JointTorque
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placed import JointHooks, Placed
from hyperleg_design.gap.effects.strength import largest_torque
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration, Tick

SOURCE = "cable bundles and seals, 5 % of the joint's torque a radian, and at rest (assumed)"
USUAL = 0.05, SOURCE, 0.002
BARE = 0.05, SOURCE, 0.01
"""Of the preload, as which the zero of a torque sensor shows: those of current and torque sensors
are off by some 1 % of what they measure (assumed)."""

FARTHEST = 2 * np.pi
"""Distance from a joint's posture of rest up to which the rest of a spring is stated [rad]."""


class JointSpring(JointTorque):
    """A cable, a seal or a spring pulls a joint back: stiffness (q - default) + preload, default
    the robot's posture at rest.

    It rests at default - preload / stiffness. Trace: that torque.
    """

    identifier: ClassVar[str] = "joint_spring"
    nuisance_rank: ClassVar[int] = 5
    summary: ClassVar[str] = "a cable or a spring pulls a joint towards some angle"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("stiffness", "Nm/rad", 0.0, -1e5, 1e5, *USUAL, of_strength=True),
        Parameter("preload", "Nm", 0.0, -1e4, 1e4, *BARE, of_strength=True),
    )
    linear: ClassVar[bool] = True
    needs: ClassVar[Need] = SWINGING
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "several amplitudes": {"backlash", "coulomb_friction"},
        "several postures": INERTIAL,
    }

    def _torque(
        self, signals: Signals, joint: int, stiffness: np.ndarray, preload: np.ndarray
    ) -> np.ndarray:
        rest = signals.subject.default[joint]
        return stiffness * (signals.position[:, joint] - rest) + preload

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        """Away from the posture of rest."""
        stiffness, preload = np.moveaxis(np.asarray(values, float), -1, 0)
        rest = float(subject.default[subject.joints.index(location)])
        constants = {"stiffness": stiffness, "preload": preload, "rest": rest}
        return Placed(location, constants, live=_Pull)

    @override
    def bounds(self, location: str, subject: Subject) -> np.ndarray:
        """Less stiff than the model's springs by no more than these; preload up to the largest
        torque of the joint.
        """
        joint = subject.joints.index(location)
        own, most = subject.spring[joint], largest_torque(subject)[joint]
        low, high = super().bounds(location, subject)
        return np.array([np.maximum(low, [-own, -most]), np.minimum(high, [20 * most, most])])

    @override
    def derived(
        self, location: str, values: np.ndarray, subject: Subject
    ) -> dict[str, tuple[float, str]]:
        """Angle at which it rests; nothing of a pull that hardly changes within `FARTHEST`."""
        stiffness, preload = (float(value) for value in values)
        if abs(preload) > FARTHEST * abs(stiffness) or not stiffness:
            return {}
        default = float(subject.default[subject.joints.index(location)])
        return {"rest": (default - preload / stiffness, "rad")}

    @override
    def starts(self, signals: Signals, location: str) -> np.ndarray:
        """A spring, and a bare preload either way."""
        usual = self.usual(location, signals.subject)
        return np.array([[usual[0], 0.0], [0.0, usual[1]], [0.0, -usual[1]]])


class _Pull(JointHooks):
    stiffness: np.ndarray
    preload: np.ndarray
    rest: float

    def joint_torque(self, tick: Tick) -> np.ndarray:
        torque, angle = np.zeros_like(tick.position), tick.position[:, self.place] - self.rest
        torque[:, self.place] = -(self.stiffness * angle + self.preload)
        return torque
