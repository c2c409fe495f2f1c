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
from hyperleg_design.gap.effects.placing import is_logged, is_measured
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.samples import Samples
from hyperleg_design.gap.signals.filtering import FilteredLog
from hyperleg_design.gap.signals.signals import Signals


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
    signals = log.signals
    command, believed, target = signals.command, signals.believed, signals.target
    given = np.zeros_like(believed)
    for cause, values in causes:
        left = EFFECTS[cause.effect].trace(signals, cause.location, values[None])
        drive = np.nan_to_num(left["drive"][0]) if "drive" in left else np.zeros_like(given)
        lost = np.zeros_like(given)
        if "motion" in left:
            lost = np.nan_to_num(left["motion"][0]) @ signals.subject.motor_from_joint.T
        measured = [is_measured(signals, motor) for motor in range(given.shape[1])]
        command = None if command is None else command + drive
        believed = believed - lost
        given += np.where(measured, drive, -lost)
    if target is not None:
        target = target + _ahead(signals, given)
    return replace(log, signals=replace(signals, command=command, believed=believed, target=target))


def _ahead(signals: Signals, given: np.ndarray) -> np.ndarray:
    """Change of the targets by which controllers ask for other torques; where commands are logged,
    they ask for these anyway.

    Args:
        signals: a conditioned log, `t` ticks.
        given: change of what motors give `(t, m)` [Nm].

    Returns:
        `(t, n)` [rad]; 0 where no stiffness is known.
    """
    subject = signals.subject
    logged = [is_logged(signals, motor) for motor in range(given.shape[1])]
    asked = np.where(logged, 0.0, given / signals.supplied) @ subject.joint_from_motor.T
    stiffness = np.where(subject.passive, 0.0, np.nan_to_num(subject.gains[:, 0]))
    return np.divide(asked, stiffness, out=np.zeros_like(asked), where=stiffness > 0)
