"""Commands, or targets, that arrive late."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.effects.excitation import Need
from hyperleg_design.gap.effects.families import BEYOND_COMMANDS
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placing import (
    ROBOT,
    before_measurement,
    commanded,
    driven_motors,
    is_commanded,
    is_logged,
    limited,
)
from hyperleg_design.gap.effects.series import delayed
from hyperleg_design.gap.effects.usual import lateness
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration, Live, Tick

LATE = ("all that controllers ask for", "their targets alone")
"""Choices of the parameter `late`."""
TARGETS = 0.5
"""Value of it from which it is the targets."""
COMMAND = 0.5
"""Content of the command from which a delay shows [Hz]."""


class CommandDelay(Effect):
    """Drives follow commands of some time ago: all of them (`robot`), or one motor.

    What comes late is the torque that the controller asked for (`late` 0), so that the whole loop
    is: the torque is that of the targets and of the measured state of then. Or it is the targets
    alone (1), on the way to controllers that know their own joints' state at once. Trace, by the
    rule of `placing`: the command with what is late less that of now, within the nominal limits. Of
    motors whose commands are logged, late targets show in the residual of the control instead.
    """

    identifier: ClassVar[str] = "command_delay"
    kind: ClassVar[str] = "robot"
    summary: ClassVar[str] = "drives follow commands or targets that are some milliseconds old"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("delay", "s", 0.0, 0.0, 0.1, 0.005, "up to 25 ms (PACE, arXiv 2509.06342)"),
        Parameter("late", "", 0.0, 0.0, 1.0, 1.0, "a choice", shape=True, choices=LATE),
    )
    needs: ClassVar[Need] = Need(
        lambda motion: motion.command > COMMAND,
        "commands change fast enough",
        f"commands hold nothing above {COMMAND} Hz",
        asked=True,
    )
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "log torque or current": BEYOND_COMMANDS,
        "chirp past 8 Hz": {"actuator_bandwidth", "controller_gain", "viscous_friction"},
    }
    look_alikes: ClassVar[Mapping[str, str]] = {
        "actuator_bandwidth": "gain and phase at high frequency"
    }

    @override
    def nuisance_spreads(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """Of all drives together."""
        return {ROBOT: np.append(lateness(step), np.zeros(len(self.parameters) - 1))}

    @override
    def usual_errors(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """Of one drive as of all."""
        of_all = self.nuisance_spreads(subject, step)[ROBOT]
        return dict.fromkeys(self.locations(subject), of_all)

    @override
    def locations(self, subject: Subject) -> tuple[str, ...]:
        """The robot, and where it has several motors, each of them."""
        motors = driven_motors(subject)
        return (ROBOT, *(motors if len(motors) > 1 else ()))

    @override
    def place(self, location: str, subject: Subject) -> str:
        """The location that a name means; the only motor is the robot."""
        return ROBOT if (location,) == driven_motors(subject) else super().place(location, subject)

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        delay, late = np.atleast_2d(np.asarray(values, float)).T
        targets = late >= TARGETS
        by_targets = targets.any() and _targets_are_known(signals, location)
        moved = _stale_target_torque(signals, np.where(targets, delay, 0.0)) if by_targets else None
        changes, control = {}, {}
        for motor, name in enumerate(signals.subject.motors):
            if location not in (ROBOT, name) or not is_commanded(signals, motor):
                continue
            asked = commanded(signals, motor)
            after = delayed(asked, np.where(targets, 0.0, delay), signals.step)
            if moved is not None:
                share = signals.supplied[:, motor] * np.tensordot(
                    moved, signals.subject.motor_from_joint[motor], 1
                )
                if is_logged(signals, motor):
                    control[motor] = share
                else:
                    after = after + share
            changes[motor] = limited(signals, motor, after) - limited(signals, motor, asked)
        return before_measurement(signals, changes, control)

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        motors = driven_motors(subject) if location == ROBOT else (location,)
        own = [subject.motors.index(motor) for motor in motors]
        moved = np.flatnonzero(subject.motor_from_joint[own].any(0))
        delay, late = np.moveaxis(np.asarray(values, float), -1, 0)
        command = np.where(late < TARGETS, delay, 0.0)
        return LateCommand(
            motors, tuple(subject.joints[j] for j in moved), command, delay - command
        )

    @override
    def fixed(self, values: np.ndarray) -> np.ndarray:
        """Nothing is between commands and targets."""
        return np.array([False, True])

    @override
    def starts(self, signals: Signals, location: str) -> np.ndarray:
        """A few delays, of commands and, where they are known, of targets."""
        ways = (0.0, 1.0) if _targets_are_known(signals, location) else (0.0,)
        return np.array([[delay, way] for way in ways for delay in (0.003, 0.01, 0.025, 0.06)])


def _targets_are_known(signals: Signals, location: str) -> bool:
    """Whether the targets that can be late by themselves are known: those of one motor only where
    it drives a joint alone.
    """
    return signals.target is not None and (location == ROBOT or signals.subject.one_to_one)


def _stale_target_torque(signals: Signals, delay: np.ndarray) -> np.ndarray:
    """Additional joint torque that controllers ask for because their targets are old `(k, t, n)`
    [Nm]; 0 where a target or a gain is unknown.
    """
    assert signals.target is not None
    stiffness = np.where(signals.subject.passive, 0.0, np.nan_to_num(signals.subject.gains[:, 0]))
    torque = np.zeros((len(delay), *signals.target.shape))
    for joint in np.flatnonzero(stiffness).tolist():
        target = signals.target[:, joint]
        if np.isfinite(target).any():
            torque[..., joint] = stiffness[joint] * (delayed(target, delay, signals.step) - target)
    return torque


class _DelayLine:
    """Delays values by the times of each simulation, interpolated between steps."""

    def __init__(self, delay: Any, count: int, step: float, places: Sequence[int]) -> None:
        steps = np.broadcast_to(np.maximum(np.asarray(delay, float), 0.0) / step, (count,))
        self.whole = np.floor(steps + 1e-9).astype(int)
        self.part = np.maximum(steps - self.whole, 0.0)[:, None]
        self.rows, self.places = np.arange(count), list(places)
        self.values = np.zeros((count, int(self.whole.max(initial=0)) + 2, len(self.places)))
        self.begun = np.zeros(count)

    def delayed(self, values: np.ndarray) -> np.ndarray:
        """Store the values of this step, and return those of `delay` seconds ago.

        Args:
            values: of this step `(n, all places)`.

        Returns:
            The delayed values `(n, places)`.
        """
        fresh = values[:, self.places]
        # The values before the first step are taken to be those of the first step.
        self.values[self.begun == 0] = fresh[self.begun == 0][:, None]
        self.begun[:] = 1.0
        self.values[:, 1:] = self.values[:, :-1].copy()
        self.values[:, 0] = fresh
        return np.asarray(
            (1 - self.part) * self.values[self.rows, self.whole]
            + self.part * self.values[self.rows, self.whole + 1]
        )


class _Late(Live):
    hidden_state: ClassVar[tuple[str, ...]] = (
        "commands",
        "commands_begun",
        "targets",
        "targets_begun",
    )

    alteration: LateCommand

    def prepare(self) -> None:
        late = self.alteration
        motors = [self.machine.motor(name) for name in late.motors]
        joints = [self.machine.joint(name) for name in late.joints]
        self.of_motors = _DelayLine(late.delay, self.count, self.step, motors)
        self.of_joints = _DelayLine(late.target_delay, self.count, self.step, joints)
        self.commands, self.commands_begun = self.of_motors.values, self.of_motors.begun
        self.targets, self.targets_begun = self.of_joints.values, self.of_joints.begun

    def command(self, command: np.ndarray, tick: Tick) -> np.ndarray:
        command[:, self.of_motors.places] = self.of_motors.delayed(command)
        return command

    def target(self, target: np.ndarray, tick: Tick) -> np.ndarray:
        target[:, self.of_joints.places] = self.of_joints.delayed(target)
        return target


@dataclass(frozen=True, eq=False)
class LateCommand(Alteration):
    """Some motors' commands, and some joints' targets, come late, interpolated between simulation
    steps.
    """

    live: ClassVar[type[Live] | None] = _Late
    motors: tuple[str, ...]
    joints: tuple[str, ...]
    delay: Any
    """Of commands, `()` or `(n,)` [s]."""
    target_delay: Any = 0.0
    """Of the targets alone, `()` or `(n,)` [s]."""
