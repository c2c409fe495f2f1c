"""What effects at one kind of place have in common: where they can sit, and how their torque shows.

An effect of another kind of place, or with places of its own, says so in its `locations`.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import Any, ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.effects.placing import at_joint, at_motor, driven_motors
from hyperleg_design.gap.effects.strength import joint_strength, motor_strength
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals


class JointEffect(Effect):
    """An effect that can sit at each joint."""

    kind: ClassVar[str] = "joint"

    @override
    def locations(self, subject: Subject) -> tuple[str, ...]:
        return subject.joints

    @override
    def strength(self, location: str, subject: Subject) -> float:
        return float(joint_strength(subject)[subject.joints.index(location)])


class JointTorque(JointEffect):
    """A torque that a joint takes from its drive, beyond the model."""

    resists: ClassVar[bool] = False
    """Whether it acts before a torque sensor that sits between gear and link."""

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        joint = signals.subject.joints.index(location)
        settings = np.atleast_2d(np.asarray(values, float))
        torque = self._torque(signals, joint, *settings.T[..., None])
        return at_joint(signals, joint, torque, resists=self.resists)

    @abstractmethod
    def _torque(self, signals: Signals, joint: int, *values: Any, **named: Any) -> np.ndarray:
        """The torque `(k, t)` [Nm] at a joint; each of the values `(k, 1)` is one parameter's."""


class MotorEffect(Effect):
    """An effect that can sit at each motor that exists."""

    kind: ClassVar[str] = "motor"

    @override
    def locations(self, subject: Subject) -> tuple[str, ...]:
        return driven_motors(subject)

    @override
    def strength(self, location: str, subject: Subject) -> float:
        return motor_strength(subject, subject.motors.index(location))


class MotorTorque(MotorEffect):
    """A torque that is lost between the measured torque of a motor and the joints."""

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        motor = signals.subject.motors.index(location)
        settings = np.atleast_2d(np.asarray(values, float))
        return at_motor(signals, motor, self._torque(signals, motor, *settings.T[..., None]))

    @abstractmethod
    def _torque(self, signals: Signals, motor: int, *values: Any, **named: Any) -> np.ndarray:
        """The torque `(k, t)` [Nm] on the motor's side; each of the values `(k, 1)` is one
        parameter's.
        """


class GearEffect(MotorEffect):
    """An effect of a gear or a belt; a torque sensor behind it tells only what arrives there."""

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        motor = signals.subject.motors.index(location)
        if signals.sensed_behind[motor]:
            return {}
        return self._left(signals, motor, *np.atleast_2d(np.asarray(values, float)).T)

    @abstractmethod
    def _left(self, signals: Signals, motor: int, *values: Any) -> dict[str, np.ndarray]:
        """The trace; each of the values `(k,)` is one parameter's."""


def before_sensors(effect: Effect) -> bool:
    """Tell whether an effect takes torque of a drive before a sensor that sits behind the gear.

    Args:
        effect: the effect.
    """
    return isinstance(effect, MotorTorque) or (isinstance(effect, JointTorque) and effect.resists)


class FootEffect(Effect):
    """An effect that can sit under each foot of a robot that stands on its feet."""

    kind: ClassVar[str] = "foot"

    @override
    def locations(self, subject: Subject) -> tuple[str, ...]:
        return subject.feet if subject.floating else ()
