"""On which side of their gear a log tells of motors that drive one joint each.

A file's `gear` stands between its actuator and the joint. Subjects count such motors at the joint;
logs hold torques, currents and speeds on either side, and seldom say which. The motion does:
torques are held against those that it needs, speeds against the joints'. Where it does not tell, a
column under the actuator's own name is the actuator's, one under the joint's is the joint's.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.channels import of_motors, resampled
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.signals import Signals

KINDS = ("motor_torque", "motor_torque_command", "motor_current", "motor_velocity")
PLAIN = 1.5
"""Ratio from which a gear is too far from 1 to be taken for an effect; nearer ones go by names."""
BACKWARDS = 10.0
"""Misfit of a wrong sign, among logarithms of ratios."""
FEWEST = 50
"""Ticks of both that are compared."""


def on_the_joints_side(subject: Subject, logs: Sequence[Log]) -> Subject:
    """Find out on which side of their gears the motors of a robot's file are logged.

    Args:
        subject: the robot.
        logs: of the robot.

    Returns:
        The subject with `motor_scale` and a note, where its file has gears.
    """
    if not subject.one_to_one or np.all(subject.gear == 1):
        return subject
    logged_kinds = [kind for kind in KINDS if any(log.names(kind) for log in logs)]
    if not logged_kinds:
        return subject
    conditioned_logs = [
        signals for log in logs if (signals := _conditioned(log, subject)) is not None
    ]
    scales = {
        kind: 1 / subject.gear if kind == "motor_velocity" else subject.gear
        for kind in logged_kinds
        if _before_gear(subject, logs, conditioned_logs, kind)
    }
    if not scales:
        return subject
    note = (
        f"{', '.join(scales)}: of the motors, before the gears of the robot's file; told at the "
        f"joints here"
    )
    return dataclasses.replace(subject, motor_scale=scales, notes=(*subject.notes, note))


def _conditioned(log: Log, subject: Subject) -> Signals | None:
    try:
        return condition(log, subject)
    except InputError:  # whoever conditions it next says why
        return None


def _before_gear(
    subject: Subject, logs: Sequence[Log], ready: Sequence[Signals], kind: str
) -> bool:
    at_joint = at_motor = 0.0
    for signals in ready:
        slopes = _slopes(signals, kind)
        known = np.isfinite(slopes) & (
            (np.abs(np.log(np.abs(subject.gear))) > np.log(PLAIN)) | (subject.gear < 0)
        )
        at_joint += float(_misfit(slopes[known]).sum())
        at_motor += float(_misfit(slopes[known] / subject.gear[known]).sum())
    if at_joint != at_motor:
        return at_motor < at_joint
    own = {name for log in logs for name in log.names(kind)}
    return any(
        alias in own and alias != motor
        for motor, alias in zip(subject.motors, subject.motor_aliases, strict=True)
    )


def _misfit(ratio: np.ndarray) -> np.ndarray:
    return np.abs(np.log(np.abs(ratio))) + np.where(ratio < 0, BACKWARDS, 0.0)


def _slopes(signals: Signals, kind: str) -> np.ndarray:
    """Ratio of what the motion of the joints needs to what a log holds, by least squares, inverted
    for speeds: the gear where the log is on the motor's side of it `(m,)`.
    """
    log, subject = signals.log, signals.subject
    slopes = np.full(len(subject.motors), np.nan)
    logged = resampled(log.time, of_motors(log, kind, subject), signals.time)
    if kind == "motor_current":
        logged = logged * subject.torque_constant
    needed = signals.velocity if kind == "motor_velocity" else signals.rigid
    for motor in range(len(subject.motors)):
        known = np.isfinite(logged[:, motor]) & np.isfinite(needed[:, motor]) & signals.valid
        logged_part, needed_part = logged[known, motor], needed[known, motor]
        if (
            known.sum() >= FEWEST
            and logged_part.any()
            and needed_part.any()
            and logged_part @ needed_part
        ):
            # either regression is biased low by noise and by what the model lacks; their geometric
            # mean less so
            slopes[motor] = np.sign(logged_part @ needed_part) * np.sqrt(
                (needed_part @ needed_part) / (logged_part @ logged_part)
            )
    return 1 / slopes if kind == "motor_velocity" else slopes
