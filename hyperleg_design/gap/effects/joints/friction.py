"""What effects of friction share: how large it is, and how it acts in a simulation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.kinds import JointTorque
from hyperleg_design.gap.effects.strength import largest_torque
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.sliding import WIDTH
from hyperleg_design.simulation.alteration import Alteration, Live, Tick, resistance

VARIED = 2.0
"""Spread between sessions over the usual error of a model's friction [-]: it changes with
temperature and wear from day to day, and most else of a robot does not (developed)."""


class ModelledFriction(JointTorque):
    """Friction that is as well known as the model's: its first parameter is its size."""

    resists: ClassVar[bool] = True
    model_spread: ClassVar[float] = 0.08
    """Usual error of the model's friction, over it."""
    most: ClassVar[float] = 1.0
    """Largest size, over the largest torque of the joint, in units of the size."""

    @staticmethod
    def modelled(subject: Subject) -> np.ndarray:
        """Friction of its kind in the model, `(joints,)`.

        Args:
            subject: the robot.
        """
        return subject.coulomb

    @override
    def nuisance_spreads(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """A share of the model's friction, and of what the joint is made for."""
        return self._errors(subject, step, self.model_spread)

    @override
    def session_spreads(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """Likewise, of a larger share."""
        return self._errors(subject, step, VARIED * self.model_spread)

    def _errors(self, subject: Subject, step: float, share: float) -> Mapping[str, np.ndarray]:
        size = np.eye(len(self.parameters))[0]
        usual = super().nuisance_spreads(subject, step).items()
        own = share * self.modelled(subject)
        return {joint: part * size + least for (joint, least), part in zip(usual, own, strict=True)}

    @override
    def bounds(self, location: str, subject: Subject) -> np.ndarray:
        """Usual bounds, up to the largest torque of the joint, and down to no friction at all."""
        bounds, joint = super().bounds(location, subject), subject.joints.index(location)
        bounds[1, 0] = min(bounds[1, 0], self.most * largest_torque(subject)[joint])
        if self.described:
            bounds[0, 0] = -self.modelled(subject)[joint]
        return bounds

    @override
    def change_bounds(self, location: str, subject: Subject) -> np.ndarray:
        """There may be less of it than in the references, also where the model has none."""
        bounds = self.bounds(location, subject)
        if self.described and not self.modelled(subject)[subject.joints.index(location)]:
            bounds[0, 0] = -bounds[1, 0]
        return bounds


class _Friction(Live):
    hidden_state: ClassVar[tuple[str, ...]] = ("before", "begun")

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
        friction, velocity = self.alteration, tick.velocity[:, self.place]
        size = friction.coulomb + friction.breakaway * np.exp(-((velocity / friction.speed) ** 2))
        if np.any(friction.share):
            size = size + friction.share * np.abs(self._transmitted(tick))
        damping = np.zeros_like(tick.velocity)
        damping[:, self.place] = resistance(size, velocity, friction.width) + friction.viscous
        return damping

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
    """Of the torque that the motors give at the joint, less what turns their rotors."""
    width: Any = WIDTH
    """Speed over which the sign of the velocity is softened; `()` or `(n,)` each [Nm, Nms/rad, Nm,
    rad/s, -, rad/s]."""
