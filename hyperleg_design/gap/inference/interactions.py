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
from typing import NamedTuple

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.effects.families import IN_DRIVES, INERTIAL
from hyperleg_design.gap.effects.placing import is_logged, is_measured
from hyperleg_design.gap.inference.samples import Samples
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals


class Acting(NamedTuple):
    """A cause with its size."""

    effect: str
    location: str
    standing: bool
    """Whether it acts in all logs."""
    values: np.ndarray
    """Of its parameters `(k,)`."""


def acting_on(effect: Effect, standing: bool, causes: Sequence[Acting]) -> list[Acting]:
    """Choose the causes that change what an effect acts on: what drives lack in all logs, for one
    that is new in a drive, and masses, for friction under load.

    Args:
        effect: the effect.
        standing: whether it acts in all logs.
        causes: of a hypothesis.

    Returns:
        Those of them.
    """
    if not standing and effect.identifier in IN_DRIVES:
        return [cause for cause in causes if cause.standing and cause.effect in IN_DRIVES]
    return [cause for cause in causes if effect.by_load and cause.effect in INERTIAL]


def values_of(causes: Sequence[Acting]) -> tuple[float, ...]:
    """List all values of some causes.

    Args:
        causes: the causes.

    Returns:
        The values, one cause after the other.
    """
    return tuple(float(value) for cause in causes for value in cause.values)


def beside(samples: Samples, effect: Effect, causes: Sequence[Acting], tests: int) -> Samples:
    """Replace the logs of samples by what some causes leave of them.

    Args:
        samples: of logs, those under test first.
        effect: that acts on it.
        causes: those of `acting_on`.
        tests: number of logs under test; the others contain only causes that act in all logs.

    Returns:
        The samples; their residuals are unchanged.
    """
    logs = []
    for place, log in enumerate(samples.filtered_logs):
        own = [cause for cause in causes if cause.standing or place < tests]
        logs.append(replace(log, signals=left_by(log.signals, effect, own)))
    return replace(samples, filtered_logs=tuple(logs))


def left_by(signals: Signals, effect: Effect, causes: Sequence[Acting]) -> Signals:
    """Compute what some causes leave of a log for an effect: commands, targets and torques of the
    drives, or for friction under load the torques that masses need.

    Args:
        signals: a conditioned log.
        effect: that acts on it.
        causes: those of `acting_on` that act in this log.

    Returns:
        The log; its residuals are unchanged.
    """
    return (_carrying if effect.by_load else _after)(signals, causes)


def _carrying(signals: Signals, causes: Sequence[Acting]) -> Signals:
    """A log whose needed torques contain those of some masses."""
    rigid = signals.rigid
    for cause in causes:
        left = _trace(signals, cause)
        rigid = rigid + np.nan_to_num(left["motion"][0]) if "motion" in left else rigid
    return replace(signals, rigid=rigid)


def _after(signals: Signals, causes: Sequence[Acting]) -> Signals:
    """A log with what controllers ask for and what motors give as some causes leave them; limits
    act on what is asked for at last, so that they are left out of the changes of it.
    """
    free = replace(signals, subject=_unlimited(signals.subject))
    believed, asked = signals.believed, np.zeros_like(signals.believed)
    measured = [is_measured(signals, motor) for motor in range(asked.shape[1])]
    for cause in causes:
        _, lost = _given(signals, cause)
        drive, unlimited = _given(free, cause)
        believed = believed - lost
        asked += np.where(measured, drive, -unlimited)
    command, target = signals.command, signals.target
    if command is not None:
        command = command + asked
    if target is not None:
        target = target + _ahead(signals, asked)
    return replace(signals, command=command, believed=believed, target=target)


def _unlimited(subject: Subject) -> Subject:
    none = np.full_like(subject.torque_limit, np.inf)
    return replace(subject, torque_limit=none, stall_torque=none, no_load_speed=none)


def _trace(signals: Signals, cause: Acting) -> dict[str, np.ndarray]:
    return EFFECTS[cause.effect].trace(signals, cause.location, cause.values[None])


def _given(signals: Signals, cause: Acting) -> tuple[np.ndarray, np.ndarray]:
    """What a cause adds to measured motor torques, and what it takes of unmeasured ones `(t, m)`
    each [Nm].
    """
    left = _trace(signals, cause)
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
