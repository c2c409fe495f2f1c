"""Drives whose battery gives less than its nominal voltage."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from hyperleg_design.gap.effects.effect import Effect, Parameter
from hyperleg_design.gap.effects.placing import (
    BATTERY,
    before_measurement,
    commanded,
    driven_motors,
    is_commanded,
    joint_strength,
    limited,
    machine,
    motor_velocity,
)
from hyperleg_design.simulation.alteration import Alteration, Limits, Live, Machine, Tick

if TYPE_CHECKING:
    from hyperleg_design.gap.signals import Signals
    from hyperleg_design.gap.subject import Subject

SAG = 0.2
"""Share of the voltage that is missing at the reference power, where nobody logged it (assumed: 5.8-7.4 V of an XL330's 7.4 V)."""
AT_REST = 0.5
"""Part of `SAG` that is missing without load, as batteries run down (assumed)."""
REFERENCE_SPEED = 0.5
"""Reference power: the torque that the joints are made for at this speed [rad/s]; assumed."""
_FULL = 95.0


class VoltageSag(Effect):
    """Torque falls with the battery's voltage: its limits, and of drives without current control the torque itself.

    What is missing of the voltage, 1 - V / V_nominal, is logged; else 20 % of it at the reference power, half of that at rest.
    `limits` scales how much of it the DC-motor line loses (torque limit, where no line is known), `torque` how much of it any
    torque loses. A nominal voltage that nobody gives is the largest that the log shows. Trace, by the rule of `placing`.
    """

    identifier: ClassVar[str] = "voltage_sag"
    kind: ClassVar[str] = "robot"
    summary: ClassVar[str] = "the battery's voltage drops, and with it torque limits or torques"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("limits", "", 0.0, 0.0, 4.0, 1.0, "1: as a DC motor's; 5.8-9.2 V at 7.4 V nominal (XL330 log)"),
        Parameter("torque", "", 0.0, -0.5, 4.0, 1.0, "1: as of servos driven by duty cycle, without current control"),
    )

    def locations(self, subject: Subject) -> tuple[str, ...]:
        """The battery."""
        return (BATTERY,) if driven_motors(subject) else ()

    def place(self, location: str, subject: Subject) -> str:
        """The battery, also as the robot."""
        return super().place(BATTERY if location == "robot" else location, subject)

    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        """See `Effect.trace`."""
        subject = signals.subject
        limits, torque = np.atleast_2d(np.asarray(values, float)).T[..., None]
        lost = missing(signals)
        changes = {}
        for motor in range(len(subject.motors)):
            if not is_commanded(signals, motor):
                continue
            asked, voltage = commanded(signals, motor), np.maximum(1 - limits * lost, 0.0)
            line = np.isfinite(subject.stall_torque[motor]) and np.isfinite(subject.no_load_speed[motor])
            peak = np.inf if line or not np.isfinite(subject.torque_limit[motor]) else voltage * subject.torque_limit[motor]
            given = limited(signals, motor, asked * (1 - torque * lost), peak=peak, voltage=voltage if line else 1.0)
            changes[motor] = given - limited(signals, motor, asked)
        return before_measurement(signals, changes)

    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        """See `Effect.alteration`."""
        values = np.asarray(values, float)
        return WeakBattery(values[..., 0], values[..., 1], reference_power(subject))

    def starts(self, signals: Signals, location: str) -> np.ndarray:
        """Limits alone, torques alone."""
        return np.array([[1.0, 0.0], [3.0, 0.0], [0.0, 1.0]])


def missing(signals: Signals) -> np.ndarray:
    """1 - V / V_nominal `(t,)`, logged or modelled."""
    subject = signals.subject
    if signals.voltage is not None:
        nominal = machine(subject).voltage
        return np.asarray(1 - signals.voltage / (nominal if np.isfinite(nominal) else float(np.nanpercentile(signals.voltage, _FULL))))
    speed = np.stack([motor_velocity(signals, motor) for motor in range(len(subject.motors))], -1)
    return modelled(np.nan_to_num(signals.believed), speed, machine(subject), reference_power(subject))


def modelled(torque: np.ndarray, speed: np.ndarray, drives: Machine, reference: float) -> np.ndarray:
    """Share of the voltage that is missing at torques and speeds of the motors `(..., m)`, `(...,)`."""
    power = np.maximum((torque * speed + drives.power_constant * torque**2).sum(-1), 0.0)
    return np.asarray(SAG * (AT_REST + (1 - AT_REST) * np.minimum(power / reference, 1.0)))


def reference_power(subject: Subject) -> float:
    """Power at which `SAG` is missing [W]."""
    return float(REFERENCE_SPEED * joint_strength(subject).sum())


@dataclass(frozen=True, eq=False)
class WeakBattery(Alteration):
    """Limits and torques of all motors follow the battery's voltage: measured, or modelled."""

    limits: Any
    torque: Any
    """`()` or `(n,)` each [-]."""
    reference_power: float
    """[W]"""


class _Weak(Live):
    kept: ClassVar[tuple[str, ...]] = ("lost", "full")

    alteration: WeakBattery

    def prepare(self) -> None:
        self.line = np.isfinite(self.machine.stall_torque) & np.isfinite(self.machine.no_load_speed)
        self.lost, self.full = np.zeros(self.count), np.zeros(self.count)

    def begin(self, tick: Tick) -> None:
        found = modelled(tick.last_torque, tick.motor_velocity, self.machine, self.alteration.reference_power)
        if tick.battery is not None:
            self.full[:] = np.fmax(self.full, tick.battery)
            nominal = self.machine.voltage if np.isfinite(self.machine.voltage) else self.full
            with np.errstate(invalid="ignore", divide="ignore"):
                found = np.where(np.isfinite(tick.battery), 1 - tick.battery / nominal, found)
        self.lost[:] = found

    def command(self, command: np.ndarray, tick: Tick) -> np.ndarray:
        return np.asarray(command * (1 - self.alteration.torque * self.lost)[:, None])

    def limits(self, limits: Limits, tick: Tick) -> Limits:
        voltage = np.maximum(1 - self.alteration.limits * self.lost, 1e-6)[:, None]
        of_line, of_rest = np.where(self.line, voltage, 1.0), np.where(self.line, 1.0, voltage)
        return dataclasses.replace(
            limits, stall_torque=limits.stall_torque * of_line, no_load_speed=limits.no_load_speed * of_line, peak_torque=limits.peak_torque * of_rest
        )


WeakBattery.live = _Weak
