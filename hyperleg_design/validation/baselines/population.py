"""Whole logs replayed with many sets of `drive_set` parameters side by side, in the simulator of
`gap/playback/replay.py`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from hyperleg_design.gap.playback.plant import Plant
from hyperleg_design.gap.playback.replay import LONGEST_STEP
from hyperleg_design.gap.playback.windows import whole_log
from hyperleg_design.gap.signals.channels import held
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.sliding import WIDTH
from hyperleg_design.simulation.alteration import Alteration, Live, Tick, resistance
from hyperleg_design.validation.baselines.drive_set import DriveSet


class _Drives(Live):
    alteration: Drives

    def measured(self, position: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return position + self.alteration.bias, velocity

    def joint_damping(self, tick: Tick) -> np.ndarray:
        return (
            resistance(self.alteration.friction, tick.velocity, self.alteration.width)
            + self.alteration.damping
        )


@dataclass(frozen=True, eq=False)
class Drives(Alteration):
    """Friction, damping and encoder bias of all joints, one row a simulation `(k, n)` each."""

    live: ClassVar[type[Live] | None] = _Drives
    friction: Any
    damping: Any
    bias: Any
    width: Any
    """Velocity at which friction has three quarters of its size: that of the model where some of it
    is taken away [rad/s]."""


def predicted(signals: Signals, drives: DriveSet, values: np.ndarray) -> np.ndarray:
    """Joint positions as encoders tell them over the whole log, first to last valid tick.

    Args:
        signals: conditioned log with targets.
        drives: parameters of the robot.
        values: `(k, P)`.

    Returns:
        `(k, T, n)` [rad]; NaN after a simulation diverged.
    """
    subject = drives.subject
    values = np.atleast_2d(values)
    window = whole_log(signals)
    ticks = window.ticks[0]
    assert signals.target is not None
    target = held(signals.target, subject.default)
    substeps = max(int(np.ceil(signals.step / LONGEST_STEP - 1e-9)), 1)
    step = signals.step / substeps
    friction = drives.part(values, "friction")
    width = np.where(
        friction < 0, subject.friction_speed, np.minimum(WIDTH, subject.friction_speed)
    )
    alteration = Drives(
        friction, drives.part(values, "damping"), drives.part(values, "bias"), width
    )
    plant = Plant(subject, (alteration,), len(values), step)
    joints = len(subject.joints)
    plant.batch.expand("dof_armature")[:, plant.model.nv - joints :] += drives.part(
        values, "armature"
    )
    first = ticks[0]
    start = np.broadcast_to(signals.position[first], (len(values), joints))
    velocity = signals.velocity[first] - step / 2 * signals.acceleration[first]
    plant.start(start, np.broadcast_to(velocity, start.shape), None, None)
    late = np.maximum(drives.part(values, "delay"), 0.0) / step
    whole, part = np.floor(late).astype(int), (late - np.floor(late))[:, None]
    out = np.full((len(values), len(ticks), joints), np.nan)
    for k, tick in enumerate(ticks):
        out[:, k] = plant.measured()[0]
        if k == len(ticks) - 1:
            break
        battery = None if signals.voltage is None else np.full(len(values), signals.voltage[tick])
        temperature = (
            None
            if signals.temperature is None
            else np.repeat(signals.temperature[tick][None], len(values), 0)
        )
        for sub in range(substeps):
            now = int(tick) * substeps + sub - whole
            before = target[np.maximum(now - 1, 0) // substeps]
            value = (1 - part) * target[np.maximum(now, 0) // substeps] + part * before
            plant.step("target", value, temperature, battery)
    return out


def squared_error(signals: Signals, predicted_position: np.ndarray) -> np.ndarray:
    """Mean square of the whole-log position error, over ticks and joints, of each set `(k,)`
    [rad^2]; infinite where one diverged.

    Args:
        signals: the conditioned log.
        predicted_position: of each set of values `(k, t, n)` [rad].

    Returns:
        The mean squares `(k,)` [rad^2].
    """
    ticks = whole_log(signals).ticks[0]
    error = np.where(
        signals.valid[ticks][:, None], signals.position[ticks] - predicted_position, 0.0
    )
    mean = np.sum(error**2, (1, 2)) / max(signals.valid[ticks].sum() * error.shape[2], 1)
    return np.where(np.isfinite(mean), mean, np.inf)


def position_gap(signals: Sequence[Signals], drives: DriveSet, values: np.ndarray) -> np.ndarray:
    """Root mean square of the whole-log position error over all logs, by set of values `(k,)`
    [rad].

    Args:
        signals: the conditioned logs.
        drives: the parameters.
        values: sets of values `(k, P)`.

    Returns:
        The errors `(k,)` [rad].
    """
    total, weight = np.zeros(len(np.atleast_2d(values))), 0.0
    for log_signals in signals:
        length = log_signals.time[-1] - log_signals.time[0]
        total = total + length * squared_error(log_signals, predicted(log_signals, drives, values))
        weight += length
    return np.asarray(np.sqrt(total / weight))
