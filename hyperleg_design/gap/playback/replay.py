"""Forward predictions in MuJoCo of what a log shows: short windows from conditioned states, or the
whole log, with any change.

A replay follows the logged position targets through the nominal controller (closed loop), or the
logged torques (open loop, which drifts: short windows only). MuJoCo steps as a leapfrog, its
velocity half a step behind its position; windows start, and velocities are told, with that half
step made up for. Joint friction is a damping D(v) of the velocity before the step, on the mean of
the velocities before and after it, or, the stiffer it is, the more on the one after: x = D h / I
above 2 would ring at the mean, dry friction at rest chatter, so theta = max(1/2, 1 - 1/x) of it is
implicit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.effects.effect import Change
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.playback.base_states import base_states
from hyperleg_design.gap.playback.overlay import alterations
from hyperleg_design.gap.playback.plant import Plant
from hyperleg_design.gap.playback.windows import Windows, short_windows
from hyperleg_design.gap.signals.channels import held, resampled_or_none
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.stops import wrong_limits
from hyperleg_design.simulation.alteration import Alteration

LONGEST_STEP = 0.00125
"""Of the simulation [s]: above it the controllers' discretisation shows
(assumed)."""
INPUTS = ("target", "command", "torque")
"""What a replay can follow."""


@dataclass(frozen=True, eq=False)
class Replay:
    """What k changed simulations predict for w windows of T ticks each, first tick included."""

    windows: Windows
    position: np.ndarray
    velocity: np.ndarray
    """As the joint sensors would tell `(k, w, T, n)` [rad, rad/s]; NaN after a simulation
    diverged."""
    torque: np.ndarray
    """That the drives take themselves to give `(k, w, T, m)` [Nm]; of the last tick, as of the one
    before."""
    base: np.ndarray
    """Position and quaternion, w first, of a floating base `(k, w, T, 7)`; empty of a fixed one."""

    def errors(self, signals: Signals) -> tuple[np.ndarray, np.ndarray]:
        """Compute logged minus predicted positions and velocities.

        Args:
            signals: of the log that was replayed.

        Returns:
            Errors [rad] and [rad/s], `(k, w, T, n)` each; NaN at ticks that are not fit for use.
        """
        ticks = self.windows.ticks
        fit = signals.valid[ticks][..., None]
        position = np.where(fit, signals.position[ticks] - self.position, np.nan)
        return position, np.where(fit, signals.velocity[ticks] - self.velocity, np.nan)


def best_input(signals: Signals) -> str:
    """Choose what a replay of a log follows by itself: targets where all gains are known, else
    torques; commands where sensors behind the gears do not tell the torque of the motors.

    Args:
        signals: conditioned log.

    Returns:
        One of `INPUTS`.
    """
    subject = signals.subject
    if signals.target is not None:
        driven = ~subject.passive & np.isfinite(signals.target).any(0)
        if (
            driven.any()
            and np.isfinite(subject.gains[driven]).all()
            and (driven | subject.passive).all()
        ):
            return "target"
    command = signals.command if signals.behind_gears is not None else None
    if command is not None and np.isfinite(command[:, subject.driven]).any(0).all():
        return "command"
    return "torque"


def replay(
    signals: Signals,
    changes: Sequence[Change | Sequence[Alteration]] = ((),),
    windows: Windows | None = None,
    *,
    follow: str = "",
    keeps_targets: bool = True,
) -> Replay:
    """Predict windows of a log, once with each change.

    Args:
        signals: conditioned log.
        changes: what to add to the nominal simulation, each a `Change` or alterations; empty, the
            nominal one.
        windows: by default `short_windows`.
        follow: one of `INPUTS`; `best_input` by default.
        keeps_targets: whether the controller keeps a target until the next row, as one that is set
            at the rate of the log; otherwise targets move evenly from row to row, as those of a
            controller that is faster than the log.

    Returns:
        Predicted positions and velocities of each change and window.

    Raises:
        InputError: an input that this log does not have, or a change that this robot cannot have.
    """
    windows = windows or short_windows(signals)
    follow = follow or best_input(signals)
    inputs = _inputs(signals, follow)
    substeps = max(int(np.ceil(signals.step / LONGEST_STEP - 1e-9)), 1)
    how = windows, follow, inputs, keeps_targets and follow == "target", substeps
    runs = [_run(signals, _alterations(change, signals.subject), *how) for change in changes]
    return Replay(windows, *(np.stack([run[i] for run in runs]) for i in range(4)))


def _alterations(change: Change | Sequence[Alteration], subject: Subject) -> tuple[Alteration, ...]:
    if not change:
        return ()
    if isinstance(change, dict) or hasattr(change, "items"):
        return alterations(change, subject)  # type: ignore[arg-type]
    return tuple(change)


def _inputs(signals: Signals, follow: str) -> np.ndarray:
    """What to follow, with unknown ticks held at the last known value and unknown channels at
    rest.
    """
    if follow not in INPUTS:
        raise InputError("replay", "follow", follow, f"expects one of {', '.join(INPUTS)}")
    log = signals.log
    target = log.stack("position_target", signals.subject.joints)
    known = {
        "target": resampled_or_none(log.time, target, signals.time),
        "command": signals.command,
        "torque": signals.believed,
    }
    if signals.before_sensors is not None:
        known["torque"] = signals.believed + signals.before_sensors
    followed = known[follow]
    if followed is None:
        raise InputError(
            signals.log.name, follow, None, f"is not in this log; it has {best_input(signals)}"
        )
    at_rest = signals.subject.default if follow == "target" else np.zeros(followed.shape[1])
    return held(followed, at_rest)


def _run(
    signals: Signals,
    alterations: tuple[Alteration, ...],
    windows: Windows,
    follow: str,
    inputs: np.ndarray,
    hold_inputs: bool,
    substeps: int,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    subject, ticks = signals.subject, windows.ticks
    count, length = ticks.shape
    unlimited = wrong_limits(subject, signals.position)
    plant = Plant(subject, alterations, count, signals.step / substeps, unlimited)
    first, half = windows.start, signals.step / substeps / 2
    base = base_states(signals, first, half) if subject.floating else (None, None)
    begun = signals.velocity[first] - half * signals.acceleration[first]
    plant.start(signals.position[first], begun, *base)
    joints, motors = len(subject.joints), len(subject.motors)
    change = np.zeros((count, joints))
    position = np.full((count, length, joints), np.nan)
    velocity = np.full((count, length, joints), np.nan)
    torque = np.full((count, length, motors), np.nan)
    pose = np.full((count, length, 7 if subject.floating else 0), np.nan)
    for k in range(length):
        position[:, k], velocity[:, k] = plant.measured()
        pose[:, k] = plant.qpos[:, : pose.shape[-1]]
        if k == length - 1:
            torque[:, k] = torque[:, max(k - 1, 0)]
            break
        now, after = ticks[:, k], ticks[:, k + 1]
        battery = None if signals.voltage is None else signals.voltage[now]
        temperature = None if signals.temperature is None else signals.temperature[now]
        for sub in range(substeps):
            part = sub / substeps
            value = inputs[now] if hold_inputs else (1 - part) * inputs[now] + part * inputs[after]
            driven = plant.step(follow, value, temperature, battery)
            if sub == 0:
                torque[:, k] = driven.believed
                late = plant.measured()[1]
                velocity[:, k], change = (velocity[:, k] + late) / 2, (late - velocity[:, k]) / 2
    velocity[:, -1] += change
    return position, velocity, torque, pose
