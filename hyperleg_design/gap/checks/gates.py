"""What no diagnosis can use: few ticks, positions without values, torques of impossible size."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hyperleg_design.gap.checks.rules import RULES
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.results.finding import ERROR, WARNING, Finding


def unusable(log: Log, subject: Subject | None = None) -> list[Finding]:
    """Findings that refuse a log, or doubt it, whatever its clock and units look like.

    Args:
        log: what was read.
        subject: the robot; without it, torques are compared with `UnitRules.largest_torque` only.

    Returns:
        Errors and warnings; empty for a log that is fit.
    """
    return [*_ticks_and_positions(log), *_sizes(log, subject)]


def _ticks_and_positions(log: Log) -> Iterator[Finding]:
    if len(log.time) < RULES.clock.fewest:
        yield Finding(
            ERROR,
            "t",
            f"has {len(log.time)} ticks, too few for velocities and accelerations",
            f"record {RULES.clock.fewest} at the very least; 20 s at 100 Hz are good",
        )
    for joint in log.joints:
        if not log.has("position", joint):
            remedy = "log it, or leave the joint's columns out if it stands still"
            yield Finding(ERROR, f"position/{joint}", "holds no values", remedy)


def _sizes(log: Log, subject: Subject | None) -> Iterator[Finding]:
    for column, values in log.signals.items():
        kind, _, name = column.partition("/")
        if kind not in ("joint_torque", "motor_torque", "motor_torque_command"):
            continue
        size = np.abs(values[np.isfinite(values)])
        if not len(size):
            continue
        usual = float(np.percentile(size, RULES.unit.percentile))
        limit = _limit(kind, name, subject)
        if usual > RULES.unit.largest_torque or usual > RULES.unit.beyond * limit:
            than = f"{usual / limit:.3g} times the drive's {limit:.3g} Nm" if limit < np.inf else ""
            what = f"is {than or f'{usual:.3g} Nm'} for a tenth of the log: no such torque"
            yield Finding(ERROR, column, what, "convert to Nm")
        elif usual > RULES.unit.doubtful * limit:
            what = f"is {usual / limit:.3g} times the drive's {limit:.3g} Nm for a tenth of the log"
            yield Finding(
                WARNING, column, what, "check its unit, and the limit in the robot's file"
            )


def _limit(kind: str, name: str, subject: Subject | None) -> float:
    """Largest torque of a motor, or of all motors of a joint together [Nm]; infinite if unknown."""
    if subject is None:
        return np.inf
    if kind == "joint_torque" or name not in subject.motors:
        if name not in subject.joints:
            return np.inf
        row = np.abs(subject.joint_from_motor[subject.joints.index(name)])
        limits = subject.torque_limit[row > 0]
        limit = float(row[row > 0] @ limits) if len(limits) else np.inf
    else:
        limit = float(subject.torque_limit[subject.motors.index(name)])
    return limit if limit > 0 else np.inf
