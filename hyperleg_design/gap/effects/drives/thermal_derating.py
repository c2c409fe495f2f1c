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

    Temperature as logged; else that of a first-order model heated by the squared torques of the log
    itself, from cold. Trace: coefficient (T - 25 degC) times the believed torque.
    """

    identifier: ClassVar[str] = "thermal_derating"
    scales: ClassVar[str] = "motor"
    rare: ClassVar[float] = -0.5
    """Assumed."""
    driver: ClassVar[str] = "temperature"
    unseen: ClassVar[float] = -1.0
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
            why = "no motor temperature: a diagnosis models it from the torques, and may be wrong"
            return Excitation(self.identifier, False, (), why)
        warm = tuple(m for m, value in rise.items() if value >= WARMING)
        needed = "" if warm else f"; {WARMING:.0f} K are needed"
        why = f"temperature changes by {max(rise.values()):.0f} K{needed}"
        return Excitation(self.identifier, bool(warm) and bool(motion.torque.any()), warm, why)

    def _torque(self, signals: Signals, motor: int, coefficient: np.ndarray) -> np.ndarray:
        return coefficient * (rise(signals, motor) * given(signals, motor))

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        """With the continuous torque of the motor."""
        rated = rated_torque(subject, subject.motors.index(location))
        constants = {"coefficient": np.asarray(values, float)[..., 0], "rated": rated}
        return Placed(location, constants, live=_Derated)

    @override
    def torque_slope(self, signals: Signals, motor: int, joint: int) -> np.ndarray:
        """Compute how the factor on the torque falls with the temperature."""
        return -np.nan_to_num(rise(signals, motor))


def rise(signals: Signals, motor: int) -> np.ndarray:
    """Temperature of a motor above 25 degC `(t,)` [K], logged or modelled.

    Args:
        signals: a conditioned log, `t` ticks.
        motor: index of the motor.

    Returns:
        The rise `(t,)` [K].
    """
    if signals.temperature is not None and np.isfinite(signals.temperature[:, motor]).any():
        return signals.temperature[:, motor] - COLD
    from scipy.signal import lfilter

    heat = (
        RATED_RISE
        * (np.nan_to_num(signals.believed[:, motor]) / rated_torque(signals.subject, motor)) ** 2
    )
    keep = np.exp(-signals.step / TIME_CONSTANT)
    return np.asarray(lfilter([0.0, 1 - keep], [1.0, -keep], heat))


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
