"""Whether a log's signals fit each other and the robot: units, signs, swapped joints, stuck
sensors, another robot's log.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterator

import numpy as np

from hyperleg_design.gap.checks.motion_plausibility import implausible_motion
from hyperleg_design.gap.checks.rules import RULES
from hyperleg_design.gap.checks.target_plausibility import implausible_targets
from hyperleg_design.gap.checks.torque_plausibility import implausible_torques
from hyperleg_design.gap.logs.frozen import frozen
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.joint_units import unit_at
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.results.finding import ERROR, NOTE, WARNING, Finding
from hyperleg_design.gap.signals.smoothing import bridged

LARGEST = {
    "motor_current": (RULES.unit.largest_current, "mA: convert to A"),
    "battery_voltage": (RULES.unit.largest_voltage, "mV: convert to V"),
    "motor_temperature": (RULES.unit.largest_temperature, "kelvin or fahrenheit: convert to degC"),
    "gyro": (RULES.unit.largest_rate, "deg/s: convert to rad/s"),
}
"""By signal, what no robot exceeds, and the unit in which it then is."""


def implausible(log: Log, subject: Subject | None = None) -> list[Finding]:
    """Find what does not fit in a log: units, signs, swapped joints, stuck sensors, another robot.

    Args:
        log: the log.
        subject: the robot; without it the log alone is checked.

    Returns:
        The findings.
    """
    return [
        *implausible_motion(log),
        *implausible_targets(log, subject),
        *_magnitudes(log),
        *implausible_torques(log, subject),
        *_stuck(log),
        *(_robot(log, subject) if subject is not None else ()),
    ]


def _magnitudes(log: Log) -> Iterator[Finding]:
    for column, values in log.signals.items():
        kind = column.partition("/")[0]
        if not np.isfinite(values).any():
            continue
        largest = float(np.nanmax(np.abs(values)))
        middle = float(np.nanpercentile(np.abs(values), 90))
        span = float(np.nanmax(values) - np.nanmin(values))
        if kind in ("position", "position_target") and span > RULES.unit.largest_angle:
            text = f"spans {span:.3g} rad, two turns or more"
            remedy = (
                "convert to rad if it is in degrees; ignore this for a joint that turns without end"
            )
            yield Finding(WARNING, column, text, remedy)
        limit, unit = LARGEST.get(kind, (math.inf, ""))
        if middle > limit or (kind == "gyro" and largest > 2 * limit):
            text = f"reaches {largest:.4g}, more than any robot does: the unit seems to be another"
            yield Finding(ERROR, column, text, f"looks like {unit}")
    if all(log.has("accelerometer", axis) for axis in "xyz"):
        # axes that are told in turn are each known all along
        force = [bridged(axis) for axis in log.vector("accelerometer").T]
        weight = float(np.median(np.linalg.norm(force, axis=0)))
        if not 5 < weight < 20:
            text = f"has a median length of {weight:.3g} m/s^2 where gravity makes 9.8"
            remedy = "convert from g, or leave gravity in: +9.81 upward at rest"
            yield Finding(ERROR, "accelerometer", text, remedy)
    if all(log.has("base_orientation", axis) for axis in "wxyz"):
        length = np.linalg.norm(log.vector("base_orientation"), axis=1)
        if abs(float(np.nanmedian(length)) - 1) > 0.01:
            remedy = "give w, x, y, z, world from base"
            yield Finding(ERROR, "base_orientation", "is no unit quaternion", remedy)


def _stuck(log: Log) -> Iterator[Finding]:
    for joint in log.joints:
        values = log.column(f"position/{joint}")
        target = log.column(f"position_target/{joint}")
        speed = log.column(f"velocity/{joint}")
        known = np.isfinite(values)
        if not known.any():
            continue
        driven = float(np.nanmax(target) - np.nanmin(target)) if np.isfinite(target).any() else 0.0
        turned = float(np.nanmax(np.abs(speed))) if np.isfinite(speed).any() else 0.0
        if np.nanmax(values) == np.nanmin(values):
            if driven > 0.05 or turned > 0.1:
                remedy = "mend the sensor; this joint tells nothing"
                yield Finding(
                    ERROR, f"position/{joint}", "never changes though the joint is driven", remedy
                )
            else:
                yield Finding(
                    NOTE, f"position/{joint}", "never changes", "move this joint to learn of it"
                )
            continue
        stuck = frozen(log, joint)
        if stuck is not None:
            length = float(log.time[stuck.stop - 1] - log.time[stuck.start])
            text = (
                f"is frozen for {length:.2g} s from {log.time[stuck.start]:.4g} s while the "
                f"joint is driven"
            )
            remedy = "a stuck sensor or a blocked joint: this stretch is left out"
            yield Finding(WARNING, f"position/{joint}", text, remedy)


def _robot(log: Log, subject: Subject) -> Iterator[Finding]:
    known, own = set(subject.joints), log.joints
    strangers = [joint for joint in own if joint not in known]
    if len(strangers) == len(own):
        text = f"has joints {', '.join(own[:4])}; the robot has {', '.join(subject.joints[:4])}"
        remedy = "choose the robot of the log, or rename the columns"
        yield Finding(ERROR, "", f"is a log of another robot: it {text}", remedy)
        return
    if strangers:
        near = [
            f"{s} ({m[0]}?)" if (m := difflib.get_close_matches(s, subject.joints, 1)) else s
            for s in strangers
        ]
        text = f"joints that the robot does not have: {', '.join(near[:5])}"
        yield Finding(ERROR, f"position/{strangers[0]}", text, "rename or remove them")
    lacking = [joint for joint in subject.joints if joint not in own]
    if lacking:
        text = f"joints of the robot without positions: {', '.join(lacking[:6])}"
        yield Finding(WARNING, "", text, "they are taken to stand still; log them if they move")
    lower, upper = subject.position_low, subject.position_high
    outside = []
    for i, joint in enumerate(subject.joints):
        if joint in own and upper[i] > lower[i]:
            values = log.column(f"position/{joint}")
            beyond = max(float(np.nanmax(values) - upper[i]), float(lower[i] - np.nanmin(values)))
            if beyond > 0.1 * (upper[i] - lower[i]):
                outside.append((joint, beyond, beyond > upper[i] - lower[i]))
    if outside:
        far = [o for o in outside if o[2]]
        text = ", ".join(
            f"{joint} by {beyond:.3g} {unit_at(subject, 'joint', joint, 'rad')}"
            for joint, beyond, _ in (far or outside)[:4]
        )
        severity = ERROR if far else WARNING
        yield Finding(
            severity,
            f"position/{(far or outside)[0][0]}",
            f"beyond the robot's range: {text}",
            "check unit, zero and sign, and the robot",
        )
