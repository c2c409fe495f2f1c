"""Torque that varies with a motor's angle."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import SLOW, Excitation, Motion, at_joints
from hyperleg_design.gap.effects.families import FRICTION
from hyperleg_design.gap.effects.kinds import MotorTorque
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placing import motor_position, motor_strength, motor_velocity
from hyperleg_design.gap.effects.waves import fitted_waves, peaks
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.filtering import HIGHEST
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.sliding import sliding
from hyperleg_design.simulation.alteration import Alteration, Live, Tick

SHARE = 0.02
"""Usual cogging over the torque that a motor is made for (EMBiR: cogging of a few per cent of rated
torque)."""
ORDERS = np.arange(1.0, 201.0)
"""Periods a turn that a search tries: of motors that count at the output of their gear, as many
more as it has."""
ALWAYS = 48
"""Of these, how many are tried however fast the motor turns; more as long as half of a log shows
them below `HIGHEST`."""
TRIED = 3
"""Best orders kept as starts of a search."""


class Cogging(MotorTorque):
    """A motor resists with a torque that repeats `order` times a turn of M^T q: cosine cos(order
    M^T q) + sine sin(order M^T q).

    Amplitude and phase are hypot(cosine, sine) and atan2(sine, cosine). Where M holds a gear's
    ratio, a turn is the rotor's; where it is 1, the gear's output's. Trace: that torque.
    """

    identifier: ClassVar[str] = "cogging"
    summary: ClassVar[str] = "a motor's torque varies with its angle, some periods a turn"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            "cosine",
            "Nm",
            0.0,
            -20.0,
            20.0,
            0.1,
            "a few per cent of the rated torque of BLDC motors (assumed; MuJoCo's dcmotor "
            "`cogging`)",
        ),
        Parameter("sine", "Nm", 0.0, -20.0, 20.0, 0.1, "as the cosine"),
        Parameter(
            "order",
            "1/turn",
            6.0,
            0.5,
            200.0,
            10.0,
            "least common multiple of slots and poles, or its fractions",
            shape=True,
        ),
    )
    told_apart: ClassVar[Mapping[str, frozenset[str]]] = {
        "slow ramp": FRICTION | {"encoder_offset", "joint_spring"}
    }

    @override
    def excited(self, log: Log, motion: Motion) -> Excitation:
        slow = motion.swinging & (motion.slow > SLOW)
        return at_joints(
            self.identifier, motion, slow, "slow motion over a range", "no slow motion over a range"
        )

    def _torque(
        self, signals: Signals, motor: int, cosine: np.ndarray, sine: np.ndarray, order: np.ndarray
    ) -> np.ndarray:
        angle = order * motor_position(signals, motor)
        return cosine * np.cos(angle) + sine * np.sin(angle)

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        values = np.asarray(values, float)
        return CoggingTorque(location, values[..., 0], values[..., 1], values[..., 2])

    @override
    def usual(self, location: str, subject: Subject) -> np.ndarray:
        """A share of the torque that the motor is made for."""
        motor = subject.motors.index(location)
        share = SHARE * motor_strength(subject, motor)
        return np.array(
            [share, share, self.parameters[2].typical * max(abs(float(subject.gear[motor])), 1.0)]
        )

    @override
    def bounds(self, location: str, subject: Subject) -> np.ndarray:
        """Amplitudes up to the torque that the motor is made for."""
        found = super().bounds(location, subject)
        most = min(found[1, 0], motor_strength(subject, subject.motors.index(location)))
        found[0, :2], found[1, :2] = -most, most
        return found

    @override
    def steps(self, location: str, subject: Subject) -> np.ndarray:
        """Those of the order turn the phase little over a radian of the joint."""
        found = super().steps(location, subject)
        found[2] = min(
            found[2],
            0.05 / float(np.abs(subject.joint_from_motor[:, subject.motors.index(location)]).max()),
        )
        return found

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
        main = int(np.argmax(np.abs(subject.joint_from_motor[:, motor])))
        ratio = subject.joint_from_motor[main, motor]
        residual = signals.residual["motion"][:, main] / ratio
        known = np.isfinite(residual) & signals.valid
        if known.sum() < 16:
            return super().starts(signals, location)
        angle = motor_position(signals, motor)
        # what gravity, friction and inertia that are off would leave is taken out of residual and
        # waves alike
        turned, speed = signals.position[:, main], signals.velocity[:, main]
        other = [
            np.ones_like(turned),
            turned,
            np.cos(turned),
            np.sin(turned),
            speed,
            sliding(signals)[:, main],
            signals.acceleration[:, main],
        ]
        beside = np.linalg.qr(np.stack(other, -1)[known])[0]
        slow = float(np.median(np.abs(motor_velocity(signals, motor)[known])))
        orders = ORDERS[(ORDERS <= ALWAYS) | (ORDERS * slow <= 2 * np.pi * HIGHEST)]
        gains, amplitudes = fitted_waves(residual[known], angle[known], orders, beside)
        best = peaks(gains, TRIED)
        low, high = self.bounds(location, subject)
        return np.clip(np.column_stack([amplitudes[best], orders[best]]), low, high)


class _Cogging(Live):
    alteration: CoggingTorque

    def prepare(self) -> None:
        self.place = self.machine.motor(self.alteration.motor)

    def motor_torque(self, torque: np.ndarray, tick: Tick) -> np.ndarray:
        one, angle = self.alteration, tick.motor_position[:, self.place]
        torque[:, self.place] -= one.cosine * np.cos(one.order * angle) + one.sine * np.sin(
            one.order * angle
        )
        return torque


@dataclass(frozen=True, eq=False)
class CoggingTorque(Alteration):
    """Torque that a rotor resists with, over its angle."""

    live: ClassVar[type[Live] | None] = _Cogging
    motor: str
    cosine: Any
    sine: Any
    order: Any
    """`()` or `(n,)` each [Nm, Nm, 1/turn]."""
