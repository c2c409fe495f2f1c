"""Causes whose traces depend on other causes: logs with the commands, targets and torques that the
others leave.

A cause that is new in the logs under test acts on the robot as it was before. If the drives lag
already, a further delay shifts what they gave, not what they were asked for, and a softer
controller multiplies the error of targets that come late; a motor that gave 0.85 of what is
believed, and now gives 0.75 of that, has lost another 0.85 x 0.25. Friction under load grows with
all that a joint carries, a load on the hand included. The traces of a hypothesis are summed, so the
trace of such a cause is computed from torques that contain the others already.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.effects.families import IN_DRIVES, INERTIAL
from hyperleg_design.gap.effects.placing import is_logged, is_measured
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.samples import Samples
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.filtering import FilteredLog
from hyperleg_design.gap.signals.signals import Signals


def acting_on(
    effect: Effect, standing: bool, causes: Sequence[tuple[Cause, np.ndarray]]
) -> list[tuple[Cause, np.ndarray]]:
    """Choose the causes that change what an effect acts on: what drives lack in all logs, for one
    that is new in a drive, and masses, for friction under load.

    Args:
        effect: the effect.
        standing: whether it acts in all logs.
        causes: of a hypothesis, and their values `(k,)` each.

    Returns:
        Those of them.
    """
    if not standing and effect.identifier in IN_DRIVES:
        return [pair for pair in causes if pair[0].standing and pair[0].effect in IN_DRIVES]
    return [pair for pair in causes if effect.by_load and pair[0].effect in INERTIAL]


def values_of(causes: Sequence[tuple[Cause, np.ndarray]]) -> tuple[float, ...]:
    """List all values of some causes.

    Args:
        causes: and their values `(k,)` each.

    Returns:
        The values, one cause after the other.
    """
    return tuple(float(value) for _, values in causes for value in values)


def after(samples: Samples, causes: Sequence[tuple[Cause, np.ndarray]]) -> Samples:
    """Replace commands and motor torques of logs by those that some causes leave.

    Args:
        samples: of logs.
        causes: that act in drives, and their values `(k,)` each.

    Returns:
        The samples; their residuals are unchanged.
    """
    logs = tuple(_after(log, causes) for log in samples.filtered_logs)
    return replace(samples, filtered_logs=logs)


def carrying(samples: Samples, causes: Sequence[tuple[Cause, np.ndarray]], tests: int) -> Samples:
    """Add the torques that some masses need to the needed torques of logs.

    Args:
        samples: of logs, those under test first.
        causes: masses, and their values `(k,)` each.
        tests: number of logs under test; the others contain only causes that act in all logs.

    Returns:
        The samples; their residuals are unchanged.
    """
    logs = []
    for place, log in enumerate(samples.filtered_logs):
        rigid = log.signals.rigid
        for cause, values in causes:
            if cause.standing or place < tests:
                left = EFFECTS[cause.effect].trace(log.signals, cause.location, values[None])
                rigid = rigid + np.nan_to_num(left["motion"][0]) if "motion" in left else rigid
        logs.append(replace(log, signals=replace(log.signals, rigid=rigid)))
    return replace(samples, filtered_logs=tuple(logs))


def _after(log: FilteredLog, causes: Sequence[tuple[Cause, np.ndarray]]) -> FilteredLog:
    """A log with what controllers ask for and what motors give as some causes leave them; limits
    act on what is asked for at last, so that they are left out of the changes of it.
    """
    signals = log.signals
    free = replace(signals, subject=_unlimited(signals.subject))
    believed, asked = signals.believed, np.zeros_like(signals.believed)
    measured = [is_measured(signals, motor) for motor in range(asked.shape[1])]
    for cause, values in causes:
        _, lost = _given(signals, cause, values)
        drive, unlimited = _given(free, cause, values)
        believed = believed - lost
        asked += np.where(measured, drive, -unlimited)
    command, target = signals.command, signals.target
    if command is not None:
        command = command + asked
    if target is not None:
        target = target + _ahead(signals, asked)
    return replace(log, signals=replace(signals, command=command, believed=believed, target=target))


def _unlimited(subject: Subject) -> Subject:
    none = np.full_like(subject.torque_limit, np.inf)
    return replace(subject, torque_limit=none, stall_torque=none, no_load_speed=none)


def _given(signals: Signals, cause: Cause, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What a cause adds to measured motor torques, and what it takes of unmeasured ones `(t, m)`
    each [Nm].
    """
    left = EFFECTS[cause.effect].trace(signals, cause.location, values[None])
    nothing = np.zeros_like(signals.believed)
    drive = np.nan_to_num(left["drive"][0]) if "drive" in left else nothing
    if "motion" not in left:
        return drive, nothing
    return drive, np.nan_to_num(left["motion"][0]) @ signals.subject.motor_from_joint.T


def _ahead(signals: Signals, asked: np.ndarray) -> np.ndarray:
    """Change of the targets by which controllers ask for other torques; where commands are logged,
    they ask for these anyway.

    Args:
        signals: a conditioned log, `t` ticks.
        asked: change of what is asked of motors `(t, m)` [Nm].

    Returns:
        `(t, n)` [rad]; 0 where no stiffness is known.
    """
    subject = signals.subject
    logged = [is_logged(signals, motor) for motor in range(asked.shape[1])]
    torque = np.where(logged, 0.0, asked / signals.supplied) @ subject.joint_from_motor.T
    stiffness = np.where(subject.passive, 0.0, np.nan_to_num(subject.gains[:, 0]))
    return np.divide(torque, stiffness, out=np.zeros_like(torque), where=stiffness > 0)
