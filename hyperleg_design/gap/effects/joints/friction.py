"""What effects of friction share: how large it is, and how it acts in a simulation."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.families import FRICTION as FRICTION
from hyperleg_design.gap.effects.kinds import JointTorque
from hyperleg_design.gap.effects.placing import joint_strength
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.sliding import WIDTH
from hyperleg_design.simulation.alteration import Alteration, Live, Tick, resistance


class DescribedFriction(JointTorque):
    """Friction of one size that a model describes, so that there may also be less of it."""

    described: ClassVar[bool] = True
    linear: ClassVar[bool] = True
    share: ClassVar[float]
    """Usual size over the torque that the joint is made for [1/s or -]."""

    @staticmethod
    @abstractmethod
    def _described(subject: Subject) -> np.ndarray:
        """What the model has of it, `(joints,)`."""

    @override
    def usual(self, location: str, subject: Subject) -> np.ndarray:
        return np.array([self.share * joint_strength(subject)[subject.joints.index(location)]])

    @override
    def bounds(self, location: str, subject: Subject) -> np.ndarray:
        """Bound it by no friction at all, and by the torque that the joint is made for."""
        joint = subject.joints.index(location)
        largest = min(self.parameters[0].high, joint_strength(subject)[joint])
        return np.array([[-self._described(subject)[joint]], [largest]])


class _Friction(Live):
    kept: ClassVar[tuple[str, ...]] = ("before", "begun")

    alteration: JointFriction

    def prepare(self) -> None:
        machine = self.machine
        self.place = machine.joint(self.alteration.joint)
        matrix, inertia = np.asarray(machine.joint_from_motor), np.asarray(machine.rigid_inertia)
        self.armature = np.einsum(
            "...k,...k,...lk->...l", matrix[..., self.place, :], inertia, matrix
        )
        self.before, self.begun = np.zeros((self.count, len(machine.joints))), np.zeros(self.count)

    def joint_damping(self, tick: Tick) -> np.ndarray:
        one, velocity = self.alteration, tick.velocity[:, self.place]
        size = one.coulomb + one.breakaway * np.exp(-((velocity / one.speed) ** 2))
        if np.any(one.share):
            size = size + one.share * np.abs(self._transmitted(tick))
        out = np.zeros_like(tick.velocity)
        out[:, self.place] = resistance(size, velocity, one.width) + one.viscous
        return out

    def _transmitted(self, tick: Tick) -> np.ndarray:
        """Torque that reaches the joint `(n,)` [Nm]: less what turned the rotors in the step
        before.
        """
        assert tick.joint_torque is not None
        acceleration = (tick.velocity - self.before) / self.step * self.begun[:, None]
        self.before[:], self.begun[:] = tick.velocity, 1.0
        return np.asarray(tick.joint_torque[:, self.place] - (self.armature * acceleration).sum(-1))


@dataclass(frozen=True, eq=False)
class JointFriction(Alteration):
    """Friction at a joint: (coulomb + breakaway exp(-(v/speed)^2) + share |torque|) sign(v) +
    viscous v, its sign softened.
    """

    live: ClassVar[type[Live] | None] = _Friction
    joint: str
    coulomb: Any = 0.0
    viscous: Any = 0.0
    breakaway: Any = 0.0
    speed: Any = 1.0
    share: Any = 0.0
    """Of the torque that the motors give at the joint, less what turns their rotors; `()` or `(n,)`
    each [Nm, Nms/rad, Nm, rad/s, -]."""
    width: float = WIDTH
    """[rad/s]"""
