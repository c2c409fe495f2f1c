"""Commands that arrive late."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from hyperleg_design.gap.effects.effect import Effect, Parameter
from hyperleg_design.gap.effects.placing import ROBOT, before_measurement, commanded, driven_motors, is_commanded, limited
from hyperleg_design.gap.effects.series import delayed
from hyperleg_design.simulation.alteration import Alteration, Live, Tick

if TYPE_CHECKING:
    from hyperleg_design.gap.signals import Signals
    from hyperleg_design.gap.subject import Subject


class CommandDelay(Effect):
    """Drives follow the torque that the controller asked for some time ago: all of them (`robot`), or one motor.

    The whole loop is late: the torque is that of the targets and of the measured state of then. Trace, by the rule of `placing`:
    the command of then within the nominal limits minus that of now.
    """

    identifier: ClassVar[str] = "command_delay"
    kind: ClassVar[str] = "robot"
    summary: ClassVar[str] = "drives follow commands that are some milliseconds old"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("delay", "s", 0.0, 0.0, 0.05, 0.005, "up to 25 ms (PACE, arXiv 2509.06342)"),)

    def locations(self, subject: Subject) -> tuple[str, ...]:
        """The robot, and where it has several motors, each of them."""
        motors = driven_motors(subject)
        return (ROBOT, *(motors if len(motors) > 1 else ()))

    def place(self, location: str, subject: Subject) -> str:
        """The one that is meant; the only motor is the robot."""
        return ROBOT if (location,) == driven_motors(subject) else super().place(location, subject)

    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        """See `Effect.trace`."""
        delay = np.atleast_2d(np.asarray(values, float))[:, 0]
        changes = {}
        for motor, name in enumerate(signals.subject.motors):
            if location in (ROBOT, name) and is_commanded(signals, motor):
                asked = commanded(signals, motor)
                changes[motor] = limited(signals, motor, delayed(asked, delay, signals.step)) - limited(signals, motor, asked)
        return before_measurement(signals, changes)

    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        """See `Effect.alteration`."""
        motors = driven_motors(subject) if location == ROBOT else (location,)
        return LateCommand(motors, np.asarray(values, float)[..., 0])

    def starts(self, signals: Signals, location: str) -> np.ndarray:
        """A few delays."""
        return np.array([[0.003], [0.01], [0.025]])


@dataclass(frozen=True, eq=False)
class LateCommand(Alteration):
    """Some motors' commands come late, interpolated between simulation steps."""

    motors: tuple[str, ...]
    delay: Any
    """`()` or `(n,)` [s]."""


class _Late(Live):
    kept: ClassVar[tuple[str, ...]] = ("past", "begun")

    alteration: LateCommand

    def prepare(self) -> None:
        self.places = [self.machine.motor(name) for name in self.alteration.motors]
        steps = np.broadcast_to(np.maximum(np.asarray(self.alteration.delay, float), 0.0) / self.step, (self.count,))
        self.whole = np.floor(steps + 1e-9).astype(int)
        self.part = np.maximum(steps - self.whole, 0.0)[:, None]
        self.rows = np.arange(self.count)
        self.past = np.zeros((self.count, int(self.whole.max(initial=0)) + 2, len(self.places)))
        self.begun = np.zeros(self.count)

    def command(self, command: np.ndarray, tick: Tick) -> np.ndarray:
        fresh = command[:, self.places]
        # Before the first command the same one is taken to have been given all the time.
        self.past[self.begun == 0] = fresh[self.begun == 0][:, None]
        self.begun[:] = 1.0
        self.past[:, 1:] = self.past[:, :-1].copy()
        self.past[:, 0] = fresh
        command[:, self.places] = (1 - self.part) * self.past[self.rows, self.whole] + self.part * self.past[self.rows, self.whole + 1]
        return command


LateCommand.live = _Late
