"""Drives whose battery gives less than its nominal voltage."""

from __future__ import annotations

from collections.abc import Mapping, Set
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.drives.weak_battery import WeakBattery
from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.effects.excitation import Excitation, Motion
from hyperleg_design.gap.effects.families import BEYOND_COMMANDS, LATE, SCALING, WITHOUT_DRIVE
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placing import (
    BATTERY,
    before_measurement,
    commanded,
    driven_motors,
    is_commanded,
    limited,
    machine,
)
from hyperleg_design.gap.effects.strength import joint_strength, motor_strength, motor_strengths
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.loading import FULL
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration

FAR, FALLS_SHORT, FEWEST = 6.0, 0.02, 20
"""A motor falls short where it gives less than it is told, by so many times the median of its
error, and by this share of the torque that it is made for; ticks that a line needs."""
NEAREST = 1e-12
"""`limits` from which a line is drawn [-]; below, it is out of reach."""
REFERENCE_SPEED = 0.5
"""Reference power: the torque that the joints are made for at this speed [rad/s]; assumed."""
USUAL_LINES = ((1.0, 10.0), (1.0, 20.0), (1.0, 40.0), (0.5, 20.0), (2.0, 20.0), (4.0, 20.0))
"""`limits` and `speed` from which lines that nobody knows are searched [-, rad/s]."""
SAGGING = 0.03
"""Spread of the voltage over its mean that changes torque visibly."""
LIMITS_SOURCE = "1: as a DC motor's; 5.8-9.2 V at 7.4 V nominal (XL330 log)"
TORQUE_SOURCE = "1: as of servos driven by duty cycle, without current control"
SPEED_SOURCE = "no-load speeds of servos 6-10 rad/s, of legs' joints 10-25 rad/s (data sheets)"


class VoltageSag(Effect):
    """Torque falls with the battery's voltage: its limits, and of drives without current control
    the torque itself.

    What is missing of the voltage V is 1 - V / V_nominal. Without a logged voltage it is not judged
    (a simulation without one loses 20 % at the reference power, half of that at rest). A nominal
    voltage that nobody gives is the largest that reference logs show, or the log itself. `limits`
    scales how much of it a motor's DC-motor line loses. Of motors whose line nobody knows, it says
    how near that line is: stall torque at the nominal voltage is the torque that the motor is made
    for over `limits`, no-load speed is `speed` at the joint that it moves most, and both fall with
    the voltage. `torque` is how much of what is missing any torque loses. Trace, by the rule of
    `placing`.
    """

    identifier: ClassVar[str] = "voltage_sag"
    kind: ClassVar[str] = "robot"
    rare: ClassVar[float] = -1.0
    """Assumed."""
    holds_back: ClassVar[bool] = True
    summary: ClassVar[str] = "the battery's voltage drops, and with it torque limits or torques"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("limits", "", 0.0, 0.0, 20.0, 1.0, LIMITS_SOURCE),
        Parameter("torque", "", 0.0, -0.5, 4.0, 1.0, TORQUE_SOURCE),
        Parameter("speed", "rad/s", 10.0, 0.5, 60.0, 5.0, SPEED_SOURCE, shape=True),
    )
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "log torque or current": BEYOND_COMMANDS,
        "several amplitudes": {"controller_gain", "torque_constant", "torque_saturation"},
        "torque-off swing": WITHOUT_DRIVE,
        "stiff supply": LATE | SCALING | {"torque_saturation"},
    }

    @override
    def locations(self, subject: Subject) -> tuple[str, ...]:
        """List the battery as the only place."""
        return (BATTERY,) if driven_motors(subject) else ()

    @override
    def excited(self, log: Log, motion: Motion) -> Excitation:
        values = log.column("battery_voltage")
        if not np.isfinite(values).any():
            return Excitation(self.identifier, False, (), "no battery voltage")
        following = log.metadata.supply
        if following and following.keys() >= set(log.motors or log.joints):
            why = "all drives follow the logged voltage already, as declared by `supply`"
            return Excitation(self.identifier, False, (), why)
        spread = voltage_spread(values)
        enough = spread >= SAGGING and bool(motion.torque.any())
        needed = "" if enough else f"; {100 * SAGGING:.0f} % are needed"
        why = f"voltage varies by {100 * spread:.0f} %{needed}"
        return Excitation(self.identifier, enough, (), why)

    @override
    def place(self, location: str, subject: Subject) -> str:
        """The battery, also as the robot."""
        return super().place(BATTERY if location == "robot" else location, subject)

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        subject = signals.subject
        limits, torque, speed = np.atleast_2d(np.asarray(values, float)).T[..., None]
        if signals.voltage is None:
            return {}
        lost = missing(signals)
        changes = {}
        for motor in range(len(subject.motors)):
            if not is_commanded(signals, motor) or np.isfinite(subject.supply[motor]):
                continue  # of motors that follow the logged voltage it is no news
            asked, wanted = (
                commanded(signals, motor),
                commanded(signals, motor) * (1 - torque * lost),
            )
            if np.isfinite([subject.stall_torque[motor], subject.no_load_speed[motor]]).all():
                given = limited(signals, motor, wanted, voltage=1 - limits * lost)
            else:
                stall = motor_strength(subject, motor) / np.maximum(limits, NEAREST)
                line = stall, speed * subject.motor_over_joint(motor)
                given = limited(signals, motor, wanted, voltage=1 - lost, line=line)
            changes[motor] = given - limited(signals, motor, asked)
        return before_measurement(signals, changes)

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        limits, torque, speed = np.moveaxis(np.asarray(values, float), -1, 0)
        ratios = np.array([subject.motor_over_joint(motor) for motor in range(len(subject.motors))])
        drives = motor_strengths(subject), ratios, reference_power(subject)
        return WeakBattery(limits, torque, speed, *drives)

    @override
    def starts(self, signals: Signals, location: str) -> np.ndarray:
        """Limits alone, torques alone; of motors whose line nobody knows, also the line on which
        they give less than they are told.
        """
        if np.isfinite(signals.subject.stall_torque).all():
            return np.array([[1.0, 0.0, 10.0], [3.0, 0.0, 10.0], [0.0, 1.0, 10.0]])
        lines = [[limits, 0.0, speed] for limits, speed in USUAL_LINES]
        return np.array([*_lines(signals), *lines, [0.0, 1.0, 10.0]])


def voltage_spread(voltage: np.ndarray) -> float:
    """Compute how much a voltage varies, over its mean.

    Args:
        voltage: `(s,)` [V], some of it known.

    Returns:
        The spread [-].
    """
    low, high = np.nanpercentile(voltage, [5, 95])
    return float((high - low) / max(abs(np.nanmean(voltage)), 1e-9))


def _lines(signals: Signals) -> list[list[float]]:
    """Torque-speed lines of measured motors that give less than their limits allow, by least
    squares: `limits`, `torque` and `speed` of each.
    """
    subject, lines = signals.subject, []
    if signals.voltage is None or signals.measured is None:
        return []
    for motor in range(len(subject.motors)):
        if not is_commanded(signals, motor):
            continue
        torque = signals.measured[:, motor]
        if not np.isfinite(torque).any():
            continue
        direction = np.sign(torque)
        shortfall = (limited(signals, motor, commanded(signals, motor)) - torque) * direction
        strength, usual = motor_strength(subject, motor), float(np.nanmedian(np.abs(shortfall)))
        limited_rows = np.flatnonzero(shortfall > max(FAR * usual, FALLS_SHORT * strength))
        if len(limited_rows) < FEWEST:
            continue
        columns = np.stack([1 - missing(signals), -signals.motor_speed[:, motor] * direction], -1)[
            limited_rows
        ]
        (level, slope), *_ = np.linalg.lstsq(
            np.nan_to_num(columns), np.abs(torque[limited_rows]) / strength
        )
        if level > 0 and slope > 0:
            lines.append([1 / level, 0.0, level / (slope * subject.motor_over_joint(motor))])
    return lines


def missing(signals: Signals) -> np.ndarray:
    """Compute 1 - V / V_nominal.

    Args:
        signals: a conditioned log with a voltage, `t` ticks.

    Returns:
        The missing share `(t,)` [-].
    """
    assert signals.voltage is not None
    nominal = machine(signals.subject).voltage
    if not np.isfinite(nominal):
        nominal = float(np.nanpercentile(signals.voltage, FULL))
    return np.asarray(1 - signals.voltage / nominal)


def reference_power(subject: Subject) -> float:
    """Power at which `SAG` is missing [W].

    Args:
        subject: the robot.

    Returns:
        The power [W].
    """
    return float(REFERENCE_SPEED * joint_strength(subject).sum())
