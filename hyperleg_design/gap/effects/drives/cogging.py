"""Torque that varies with a motor's angle."""

from __future__ import annotations

from collections.abc import Mapping, Set
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import SLOW, Need
from hyperleg_design.gap.effects.families import FRICTION
from hyperleg_design.gap.effects.kinds import MotorTorque
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placed import MotorHooks
from hyperleg_design.gap.effects.placing import motor_position, motor_velocity
from hyperleg_design.gap.effects.waves import fitted_waves, peaks
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.filtering import HIGHEST
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.sliding import sliding
from hyperleg_design.simulation.alteration import Tick

ORDERS = np.arange(1.0, 201.0)
"""Periods a turn that a search tries: of motors that count at the output of their gear, as many
more as it has."""
ALWAYS = 48
"""Orders up to this one are always tried; higher ones only if the motor turns so slowly in half of
the log that their ripple stays below `HIGHEST`."""
TRIED = 3
"""Best orders kept as starts of a search."""
HEALTHY = 0.005
"""Ripple that healthy motors have, over the torque that they are made for [-] (assumed: cogging and
ripple of currents of good drives, a fraction of `COSINE_SOURCE`)."""
COSINE_SOURCE = (
    "a few per cent of the rated torque of BLDC motors (EMBiR; MuJoCo's dcmotor `cogging`)"
)
ORDER_SOURCE = "least common multiple of slots and poles, or its fractions"


class _Cogging(MotorHooks):
    cosine: np.ndarray
    sine: np.ndarray
    order: np.ndarray

    def motor_torque(self, torque: np.ndarray, tick: Tick) -> np.ndarray:
        angle = self.order * tick.motor_position[:, self.place]
        torque[:, self.place] -= self.cosine * np.cos(angle) + self.sine * np.sin(angle)
        return torque


class Cogging(MotorTorque):
    """A motor resists with a torque that repeats `order` times a turn of M^T q: cosine cos(order
    M^T q) + sine sin(order M^T q).

    Amplitude and phase are hypot(cosine, sine) and atan2(sine, cosine). Where M holds a gear's
    ratio, a turn is the rotor's; where it is 1, the gear's output's. Trace: that torque.
    """

    identifier: ClassVar[str] = "cogging"
    summary: ClassVar[str] = "a motor's torque varies with its angle, some periods a turn"
    telling: ClassVar[str] = "amplitude"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("cosine", "Nm", 0.0, -1e3, 1e3, 0.02, COSINE_SOURCE, of_strength=True),
        Parameter("sine", "Nm", 0.0, -1e3, 1e3, 0.02, "as the cosine", of_strength=True),
        Parameter("order", "1/turn", 6.0, 0.5, 200.0, 10.0, ORDER_SOURCE, shape=True),
    )
    hooks: ClassVar[type[MotorHooks]] = _Cogging
    needs: ClassVar[Need] = Need(
        lambda motion: motion.swinging & (motion.slow > SLOW),
        "slow motion over a range",
        "no slow motion over a range",
    )
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "slow ramp": FRICTION | {"encoder_offset", "joint_spring"}
    }

    def _torque(
        self, signals: Signals, motor: int, cosine: np.ndarray, sine: np.ndarray, order: np.ndarray
    ) -> np.ndarray:
        angle = order * motor_position(signals, motor)
        return cosine * np.cos(angle) + sine * np.sin(angle)

    @override
    def usual_errors(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """A share of the motor's torque."""
        shares = [HEALTHY, HEALTHY, 0.0]
        return {place: self._sized(shares, place, subject) for place in self.locations(subject)}

    @override
    def usual(self, location: str, subject: Subject) -> np.ndarray:
        """Usual values, with the order times the motor's gear: so many more periods of the rotor's
        cogging fall on a turn of the joint.
        """
        typical = super().usual(location, subject)
        typical[2] *= max(abs(float(subject.gear[subject.motors.index(location)])), 1.0)
        return typical

    @override
    def bounds(self, location: str, subject: Subject) -> np.ndarray:
        """Usual bounds, with amplitudes up to the torque that the motor is made for."""
        bounds = super().bounds(location, subject)
        largest = min(bounds[1, 0], self.strength(location, subject))
        bounds[0, :2], bounds[1, :2] = -largest, largest
        return bounds

    @override
    def steps(self, location: str, subject: Subject) -> np.ndarray:
        """Usual steps, with one of the order that changes the phase little over a radian of the
        joint.
        """
        steps = super().steps(location, subject)
        steps[2] = min(steps[2], 0.05 / subject.motor_over_joint(subject.motors.index(location)))
        return steps

    @override
    def derived(
        self, location: str, values: np.ndarray, subject: Subject
    ) -> dict[str, tuple[float, str]]:
        """Amplitude, and the angle at which it resists most."""
        cosine, sine, order = values
        return {
            "amplitude": (float(np.hypot(cosine, sine)), "Nm"),
            "phase": (float(np.arctan2(sine, cosine) / order), "rad"),
        }

    @override
    def starts(self, signals: Signals, location: str) -> np.ndarray:
        """The orders that explain most of the residual of this log, each more than its neighbours,
        with their amplitudes.
        """
        subject = signals.subject
        motor = subject.motors.index(location)
        main = subject.main_joint(motor)
        ratio = subject.joint_from_motor[main, motor]
        residual = signals.resisting[:, main] / ratio
        known = np.isfinite(residual) & signals.valid
        if known.sum() < 16:
            return super().starts(signals, location)
        angle = motor_position(signals, motor)
        # what gravity, friction and inertia that are off would leave is taken out of residual and
        # waves alike
        turned, speed = signals.position[:, main], signals.velocity[:, main]
        gravity = [np.ones_like(turned), turned, np.cos(turned), np.sin(turned)]
        other = [*gravity, speed, sliding(signals)[:, main], signals.acceleration[:, main]]
        beside = np.linalg.qr(np.stack(other, -1)[known])[0]
        slow = float(np.median(np.abs(motor_velocity(signals, motor)[known])))
        orders = ORDERS[(ORDERS <= ALWAYS) | (ORDERS * slow <= 2 * np.pi * HIGHEST)]
        gains, amplitudes = fitted_waves(residual[known], angle[known], orders, beside)
        best = peaks(gains, TRIED)
        low, high = self.bounds(location, subject)
        return np.clip(np.column_stack([amplitudes[best], orders[best]]), low, high)
