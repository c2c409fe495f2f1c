"""Motors that give another torque than their current says."""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import replace
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.effect import NEEDED
from hyperleg_design.gap.effects.excitation import Excitation, Motion
from hyperleg_design.gap.effects.families import FRICTION, WITH_LOAD, WITHOUT_DRIVE
from hyperleg_design.gap.effects.kinds import MotorEffect
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placed import MotorHooks, Placed
from hyperleg_design.gap.effects.placing import (
    at_motor,
    before_measurement,
    braked,
    given,
    is_commanded,
    is_measured,
)
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration, Tick
from hyperleg_design.simulation.drives.actuation import applied
from hyperleg_design.simulation.drives.limits import Limits

READING = 1
"""Parameter by which currents are read wrongly."""


class _Scaled(MotorHooks):
    """Scales torque over what the drive takes itself to give, or over what is read from it; and
    once more that by which the windings brake.
    """

    scale: np.ndarray
    reading: np.ndarray
    driven: bool
    """Whether the motor has no current control."""

    def prepare(self) -> None:
        super().prepare()
        self.read = 1.0 + self.reading * (self.scale - 1.0)
        self.misread = bool(np.any(self.read != 1.0))

    def command(self, command: np.ndarray, tick: Tick) -> np.ndarray:
        if self.misread:
            command[:, self.place] /= self.read
        return command

    def limits(self, limits: Limits, tick: Tick) -> Limits:
        if not self.misread:
            return limits
        shape = np.broadcast_shapes(
            np.shape(limits.peak_torque), (self.count, len(self.machine.motors))
        )
        stall = np.array(np.broadcast_to(limits.stall_torque, shape))
        peak = np.array(np.broadcast_to(limits.peak_torque, shape))
        stall[:, self.place] /= self.read
        peak[:, self.place] /= self.read
        return Limits(limits.no_load_speed, stall, peak)

    def motor_torque(self, torque: np.ndarray, tick: Tick) -> np.ndarray:
        torque[:, self.place] *= self.scale
        if self.driven:
            damper = applied(self.machine.motor_from_joint, self.machine.damping * tick.velocity)
            torque[:, self.place] -= self.scale * (self.scale - 1.0) * damper[:, self.place]
        return torque


class TorqueConstant(MotorEffect):
    """A motor's torque is `scale` times the one believed, from its current and the declared
    constant, or as commanded.

    Either the motor is another one, and its drive knows no more of it than the log (`reading` 0);
    or the constant by which the log's currents are read is wrong, and the drive gives what it was
    asked for (1). Trace: (1 - scale) times the believed torque, in the residual of motion, and with
    a wrong reading in that of the drive. Without current control, the windings brake by the square
    of the constant: (1 - scale) times twice that torque, to first order.
    """

    identifier: ClassVar[str] = "torque_constant"
    scales: ClassVar[str] = "motor"
    nuisance_torque: ClassVar[str] = NEEDED
    summary: ClassVar[str] = (
        "a motor gives more or less torque than its current and its data sheet say"
    )
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            "scale", "", 1.0, 0.3, 2.0, 0.08, "8 % off on a dynamometer (EMBiR)", spread=0.03
        ),
        Parameter(
            "reading",
            "",
            0.0,
            0.0,
            1.0,
            1.0,
            "a choice",
            shape=True,
            choices=("another motor", "its current is read wrongly"),
            spread=0.005,
        ),
    )
    linear: ClassVar[bool] = True
    hooks: ClassVar[type[MotorHooks]] = _Scaled
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "several amplitudes": FRICTION - {"viscous_friction"},
        "torque-off swing": WITHOUT_DRIVE,
        "known payload": WITH_LOAD,
    }
    look_alikes: ClassVar[Mapping[str, str]] = {"payload": "a known payload, or several loads"}

    @override
    def nuisance_trace(
        self, signals: Signals, location: str, parameter: int, spread: float
    ) -> dict[str, np.ndarray] | None:
        """A reading that is off alone: a share of what a motor was asked for, where it is also
        measured. A sensor behind the gear that reads too much shows in the motion, too.
        """
        if parameter != READING:
            return None
        motor = signals.subject.motors.index(location)
        if signals.sensed_behind[motor]:
            rows = np.zeros((len(signals.time), len(signals.subject.motors)))
            rows[:, motor] = spread * (signals.rigid @ signals.subject.motor_from_joint[motor])
            return {"motion": rows @ signals.subject.joint_from_motor.T, "drive": rows}
        if signals.measured is None or "drive" not in signals.residual:
            return {}
        rows = np.zeros_like(signals.measured)
        rows[:, motor] = spread * (signals.measured - signals.residual["drive"])[:, motor]
        return {"drive": rows}

    @override
    def excited(self, log: Log, motion: Motion) -> Excitation:
        kinds = "motor_current", "motor_torque", "motor_torque_command"
        motors = tuple(m for m in log.motors if any(log.has(kind, m) for kind in kinds))
        if not motors:
            why = "no current and no torque: not told from controller_gain or payload"
            return Excitation(self.identifier, False, (), why)
        moved = bool(motion.swinging.any())
        why = "current or torque under a changing load" if moved else "the load hardly changes"
        return Excitation(self.identifier, moved, motors if moved else (), why)

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        motor = signals.subject.motors.index(location)
        scale, reading = np.atleast_2d(np.asarray(values, float)).T[..., None]
        lost = (1.0 - scale) * (given(signals, motor) - braked(signals, motor))
        if signals.sensed_behind[motor]:
            return _sensed(signals, motor, lost, 1.0 - scale, reading)
        trace = at_motor(signals, motor, lost)
        if reading.any() and _is_commanded_and_measured(signals, motor):
            trace |= before_measurement(signals, {motor: reading * lost})
        return trace

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        placed = super().alteration(location, values, subject)
        assert isinstance(placed, Placed)
        driven = bool(np.isfinite(subject.supply[subject.motors.index(location)]))
        return replace(placed, constants={**placed.constants, "driven": driven})

    @override
    def variants(self, signals: Signals, location: str) -> np.ndarray:
        """Another motor; and a wrong reading, where the log tells both what was asked for and what
        was given.
        """
        both = _is_commanded_and_measured(signals, signals.subject.motors.index(location))
        return np.array([[1.0, 0.0], [1.0, 1.0]] if both else [[1.0, 0.0]])


def _sensed(
    signals: Signals, motor: int, lost: np.ndarray, share: np.ndarray, reading: np.ndarray
) -> dict[str, np.ndarray]:
    """Trace where a sensor behind the gear measures: `lost` before it, or a `share` of its
    reading.
    """
    misread = reading * share * signals.believed[:, motor]
    trace = before_measurement(signals, {motor: misread - (1 - reading) * lost})
    if reading.any():
        moved = np.multiply.outer(misread, signals.subject.joint_from_motor[:, motor])
        trace["motion"] = moved
    return trace


def _is_commanded_and_measured(signals: Signals, motor: int) -> bool:
    return is_measured(signals, motor) and is_commanded(signals, motor)
