"""Motors that lose torque as they warm up."""

from __future__ import annotations

from collections.abc import Mapping, Set
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import Excitation, Motion
from hyperleg_design.gap.effects.families import SCALING, WITH_LOAD
from hyperleg_design.gap.effects.kinds import MotorTorque
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placed import MotorHooks, Placed
from hyperleg_design.gap.effects.placing import given, machine
from hyperleg_design.gap.effects.strength import motor_strength
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration, Tick

COLD = 25.0
"""Temperature at which a motor has the torque of its data sheet [degC]."""
RATED_RISE = 60.0
"""Rise at rated torque for ever [K]: continuous torque is rated so that windings reach 80-90 degC
(assumed)."""
TIME_CONSTANT = 60.0
"""Of a motor's windings and iron [s]; assumed."""
RATED_SHARE = 1 / 3
"""Rated over largest torque where nobody gives it (assumed)."""
WARMING = 10.0
"""Rise of a motor's temperature that changes torque visibly [K]."""
SOURCE = "flux of NdFeB -0.12 %/K, of ferrites -0.2 %/K; copper 0.39 %/K with voltage drives"


class ThermalDerating(MotorTorque):
    """A motor's torque falls short of what its current says by a share for each kelvin above 25
    degC.

    Trace: coefficient (T - 25 degC) times the believed torque, of logged temperatures T. A motor
    without one is not judged: a temperature modelled from torques grows with the time, as what a
    battery loses does. A simulation without one heats it by a first-order model, from cold.
    """

    identifier: ClassVar[str] = "thermal_derating"
    scales: ClassVar[str] = "motor"
    rare: ClassVar[float] = -0.5
    """Assumed."""
    summary: ClassVar[str] = "a motor loses torque as it warms up"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("coefficient", "1/K", 0.0, 0.0, 0.012, 0.002, SOURCE),
    )
    linear: ClassVar[bool] = True
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "known payload": WITH_LOAD,
        "cold and warm": SCALING | {"load_dependent_friction"},
    }

    @override
    def excited(self, log: Log, motion: Motion) -> Excitation:
        logged = [m for m in log.motors if log.has("motor_temperature", m)]
        known = {m: log.column(f"motor_temperature/{m}") for m in logged}
        rise = {m: float(np.nanmax(values) - np.nanmin(values)) for m, values in known.items()}
        if not rise:
            why = "no motor temperature"
            return Excitation(self.identifier, False, (), why)
        warm = tuple(m for m, value in rise.items() if value >= WARMING)
        needed = "" if warm else f"; {WARMING:.0f} K are needed"
        why = f"temperature changes by {max(rise.values()):.0f} K{needed}"
        return Excitation(self.identifier, bool(warm) and bool(motion.torque.any()), warm, why)

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        rise = _rise(signals, signals.subject.motors.index(location))
        return {} if rise is None else super().trace(signals, location, values)

    def _torque(self, signals: Signals, motor: int, coefficient: np.ndarray) -> np.ndarray:
        return coefficient * (_rise(signals, motor) * given(signals, motor))

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        """With the continuous torque of the motor."""
        rated = rated_torque(subject, subject.motors.index(location))
        constants = {"coefficient": np.asarray(values, float)[..., 0], "rated": rated}
        return Placed(location, constants, live=_Derated)

    @override
    def torque_slope(self, signals: Signals, motor: int, joint: int) -> np.ndarray:
        """Compute how the factor on the torque falls with the temperature."""
        rise = _rise(signals, motor)
        return np.zeros(1) if rise is None else -np.nan_to_num(rise)


def _rise(signals: Signals, motor: int) -> np.ndarray | None:
    """Temperature of a motor above 25 degC `(t,)` [K]; None where it is not logged."""
    if signals.temperature is None or not np.isfinite(signals.temperature[:, motor]).any():
        return None
    return np.asarray(signals.temperature[:, motor] - COLD)


def rated_torque(subject: Subject, motor: int) -> float:
    """Continuous torque of a motor [Nm].

    Args:
        subject: the robot.
        motor: index of the motor.

    Returns:
        The torque [Nm].
    """
    known = float(machine(subject).rated_torque[motor])
    return known if np.isfinite(known) else RATED_SHARE * motor_strength(subject, motor)


class _Derated(MotorHooks):
    """Loses torque with temperature: measured, or modelled from cold."""

    hidden_state: ClassVar[tuple[str, ...]] = ("rise",)
    coefficient: np.ndarray
    rated: float

    def prepare(self) -> None:
        super().prepare()
        self.rise = np.zeros(self.count)

    def motor_torque(self, torque: np.ndarray, tick: Tick) -> np.ndarray:
        heat = RATED_RISE * (torque[:, self.place] / self.rated) ** 2
        rise = self.rise.copy()
        if tick.temperature is not None:
            known = tick.temperature[:, self.place] - COLD
            rise = np.where(np.isfinite(known), known, rise)
        self.rise += -np.expm1(-self.step / TIME_CONSTANT) * (heat - self.rise)
        torque[:, self.place] *= np.clip(1 - self.coefficient * rise, 0.0, None)
        return torque
