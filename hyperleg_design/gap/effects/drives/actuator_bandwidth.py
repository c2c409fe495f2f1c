"""Torque that follows its command with a lag."""

from __future__ import annotations

from collections.abc import Mapping, Set
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import Need
from hyperleg_design.gap.effects.families import BEYOND_COMMANDS
from hyperleg_design.gap.effects.kinds import MotorEffect
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placed import MotorHooks
from hyperleg_design.gap.effects.placing import before_measurement, commanded, is_commanded, limited
from hyperleg_design.gap.effects.series import lagged
from hyperleg_design.gap.effects.usual import lateness
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Tick
from hyperleg_design.simulation.drives.limits import Limits

BANDWIDTH = 10.0
"""Content of the command that tells a motor's bandwidth from delay [Hz]."""
SOURCE = "torque loops of 15-100 Hz, 2-10 ms, on series-elastic and servo drives (assumed)"


class _Lagging(MotorHooks):
    """Exact for a command that is held for a simulation step."""

    hidden_state: ClassVar[tuple[str, ...]] = ("given", "begun")
    time_constant: np.ndarray

    def prepare(self) -> None:
        super().prepare()
        machine, lag = self.machine, self.time_constant
        self.gain = np.where(lag > 1e-9, -np.expm1(-self.step / np.maximum(lag, 1e-9)), 1.0)
        self.nominal = Limits(machine.no_load_speed, machine.stall_torque, machine.peak_torque)
        self.given, self.begun = np.zeros(self.count), np.zeros(self.count)

    def command(self, command: np.ndarray, tick: Tick) -> np.ndarray:
        wanted = self.nominal.clip(command, tick.motor_velocity)[:, self.place]
        settled = np.where(self.begun == 0, wanted, self.given)
        self.given[:] = settled + self.gain * (wanted - settled)
        self.begun[:] = 1.0
        lagging = np.broadcast_to(self.gain < 1, self.given.shape)
        command[:, self.place] = np.where(lagging, self.given, command[:, self.place])
        return command


class ActuatorBandwidth(MotorEffect):
    """A drive's torque follows the command within its limits through a first-order lag, T tau' =
    command - tau.

    Trace, by the rule of `placing`: the lagged command minus the command.
    """

    identifier: ClassVar[str] = "actuator_bandwidth"
    nuisance_rank: ClassVar[int] = 2
    summary: ClassVar[str] = "a drive's torque follows its command through a first-order lag"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("time_constant", "s", 0.0, 0.0, 0.1, 0.005, SOURCE),
    )
    lags: ClassVar[bool] = True
    hooks: ClassVar[type[MotorHooks]] = _Lagging
    needs: ClassVar[Need] = Need(
        lambda motion: motion.command > BANDWIDTH,
        f"commands reach past {BANDWIDTH:.0f} Hz",
        f"commands hold nothing above {BANDWIDTH:.0f} Hz: looks like delay",
        asked=True,
    )
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "log torque or current": BEYOND_COMMANDS,
        "chirp past 8 Hz": {"controller_gain", "rotor_inertia", "viscous_friction"},
    }

    @override
    def nuisance_spreads(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """Half as late as all drives together."""
        return dict.fromkeys(self.locations(subject), np.array([0.5 * lateness(step)]))

    @override
    def usual_errors(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """Of one drive as of all, as a delay."""
        return dict.fromkeys(self.locations(subject), np.array([lateness(step)]))

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        motor = signals.subject.motors.index(location)
        if not is_commanded(signals, motor):
            return {}
        given = limited(signals, motor, commanded(signals, motor))
        lag = np.atleast_2d(np.asarray(values, float))[:, 0]
        return before_measurement(signals, {motor: lagged(given, lag, signals.step) - given})

    @override
    def starts(self, signals: Signals, location: str) -> np.ndarray:
        """Lags of a quick, a usual and a slow drive."""
        return np.array([[0.003], [0.01], [0.03]])
