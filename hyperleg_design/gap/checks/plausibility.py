"""Whether a log's signals fit each other and the robot: units, signs, swapped joints, stuck
sensors, another robot's log.

Positions and velocities are compared as the change of position over a window against the integral
of velocity over it, which needs no differentiation of noise; a wrong unit shows as a slope of 57.3,
a swapped joint as one that fits another's motion.
"""

from __future__ import annotations

import difflib
import math
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.checks.rules import RULES
from hyperleg_design.gap.logs.frozen import frozen
from hyperleg_design.gap.results.finding import ERROR, NOTE, WARNING, Finding
from hyperleg_design.gap.signals.channels import applied, of_motors
from hyperleg_design.gap.signals.smoothing import bridged

if TYPE_CHECKING:
    from hyperleg_design.gap.logs.log import Log
    from hyperleg_design.gap.model.subject import Subject

DEGREES = 180 / math.pi
RPM = 30 / math.pi


def implausible(log: Log, subject: Subject | None = None) -> list[Finding]:
    """Find what does not fit in a log: units, signs, swapped joints, stuck sensors, another robot.

    Args:
        log: the log.
        subject: the robot; without it the log alone is checked.

    Returns:
        The findings.
    """
    found = [
        *_motion(log),
        *_targets(log, subject),
        *_magnitudes(log),
        *_torques(log, subject),
        *_stuck(log),
    ]
    return found + (_robot(log, subject) if subject is not None else [])


def _motion(log: Log) -> list[Finding]:
    joints = [j for j in log.joints if log.has("velocity", j)]
    if not joints:
        return []
    moved, integral = _windows(log, joints)
    slope, fit = _slopes(moved, integral)
    moving = (
        np.nanstd(moved, axis=0)
        > 3 * np.nanmedian(np.abs(np.diff(moved, axis=0)), axis=0) / math.sqrt(len(moved)) + 1e-4
    )
    found: list[Finding] = []
    units = (
        (DEGREES, "velocity in deg/s or position in another unit"),
        (1 / DEGREES, "position in degrees"),
        (RPM, "velocity in rpm"),
    )
    for i, joint in enumerate(joints):
        column = f"velocity/{joint}"
        if not moving[i] or not np.isfinite(fit[i]):
            continue
        if np.nanstd(integral[:, i]) == 0:
            found.append(
                Finding(
                    ERROR,
                    column,
                    "never changes though the joint moves",
                    "leave the column out, or mend the sensor",
                )
            )
            continue
        rivals = _correlations(moved, integral[:, i])
        rivals[i] = -1
        best = int(np.nanargmax(rivals)) if np.isfinite(rivals).any() else i
        unit = next(
            (
                text
                for value, text in units
                if abs(abs(slope[i]) / value - 1) < RULES.unit.tolerance
            ),
            "",
        )
        if abs(fit[i]) < RULES.unit.strange and rivals[best] > RULES.unit.fits:
            text = (
                f"follows the motion of {joints[best]} (correlation {rivals[best]:.2f}), not "
                f"its own ({fit[i]:.2f})"
            )
            found.append(
                Finding(ERROR, column, text, "the columns of two joints are swapped: rename them")
            )
        elif fit[i] < -RULES.unit.fits:
            found.append(
                Finding(
                    ERROR,
                    column,
                    "runs against the rate of its position",
                    "flip the sign of one of the two",
                )
            )
        elif fit[i] > RULES.unit.strange and unit:
            text = f"is {slope[i]:.3g} times the rate of its position: {unit}"
            found.append(Finding(ERROR, column, text, "convert to rad and rad/s"))
        elif fit[i] > RULES.unit.fits and abs(slope[i] - 1) > RULES.unit.tolerance:
            text = f"is {slope[i]:.3g} times the rate of its position"
            found.append(
                Finding(
                    WARNING,
                    column,
                    text,
                    "is it the motor's, before a reduction? then call it motor_velocity",
                )
            )
        elif fit[i] < RULES.unit.strange:
            text = f"hardly follows the rate of its position (correlation {fit[i]:.2f})"
            found.append(
                Finding(
                    WARNING, column, text, "check clock and filter of the velocity, or leave it out"
                )
            )
    return found


def _targets(log: Log, subject: Subject | None) -> list[Finding]:
    joints = [j for j in log.joints if log.has("position_target", j)]
    if not joints:
        return []
    position, target = log.stack("position", joints), log.stack("position_target", joints)
    lag = _common_lag(log, position, target)
    if lag:
        position, target = position[lag:], target[:-lag]
    _, fit = _slopes(position, target)
    found: list[Finding] = []
    for i, joint in enumerate(joints):
        column = f"position_target/{joint}"
        if not np.isfinite(fit[i]) or np.nanstd(target[:, i]) < 1e-3:
            continue
        ratio = float(np.nanstd(target[:, i]) / max(np.nanstd(position[:, i]), 1e-12))
        rivals = _correlations(position, target[:, i])
        rivals[i] = -1
        best = int(np.nanargmax(rivals)) if np.isfinite(rivals).any() else i
        if (
            abs(fit[i]) < RULES.unit.strange
            and rivals[best] > RULES.unit.fits
            and _correlations(target, position[:, i])[best] > RULES.unit.fits
        ):
            text = (
                f"is followed by {joints[best]} (correlation {rivals[best]:.2f}), not by "
                f"{joint} ({fit[i]:.2f})"
            )
            found.append(
                Finding(ERROR, column, text, "the columns of two joints are swapped: rename them")
            )
        elif fit[i] < -RULES.unit.fits and ratio < 10 and not _pushed(log, subject, joint):
            # what stands on the ground, and whose torques nobody logged, may be pushed against its
            # targets
            severity = WARNING if log.metadata.base == "floating" else ERROR
            found.append(
                Finding(
                    severity, column, "runs against its position", "flip the sign of one of the two"
                )
            )
        elif fit[i] > RULES.unit.strange and (
            abs(ratio / DEGREES - 1) < 0.4 or abs(ratio * DEGREES - 1) < 0.4
        ):
            # a soft joint may follow its target as little; then neither turns as far as degrees
            # would say
            severity = (
                ERROR
                if max(np.nanmax(np.abs(target[:, i])), np.nanmax(np.abs(position[:, i])))
                > RULES.unit.half_turn
                else WARNING
            )
            text = (
                f"moves {ratio:.3g} times as far as its position: one of the two "
                f"{'is' if severity == ERROR else 'may be'} in degrees"
            )
            found.append(Finding(severity, column, text, "convert both to rad"))
    return found


def _pushed(log: Log, subject: Subject | None, joint: str) -> bool:
    """Whether torques at a joint are those that its target asks for, so that it is a load that
    moves it the other way.
    """
    motors = {joint}
    if subject is not None and joint in subject.joints:
        turned = subject.motor_from_joint[:, subject.joints.index(joint)] != 0
        motors |= {motor for motor, here in zip(subject.motors, turned, strict=True) if here}
    held = [
        (asked, torque)
        for column, asked, torque in _asked(log, subject)
        if column.partition("/")[2] in motors
    ]
    return any(
        _slopes(asked[:, None], torque[:, None])[1][0] > RULES.unit.strange
        for asked, torque in held
    )


def _magnitudes(log: Log) -> list[Finding]:
    found: list[Finding] = []
    for column, values in log.signals.items():
        kind = column.partition("/")[0]
        if not np.isfinite(values).any():
            continue
        largest = float(np.nanmax(np.abs(values)))
        middle = float(np.nanpercentile(np.abs(values), 90))
        if (
            kind in ("position", "position_target")
            and float(np.nanmax(values) - np.nanmin(values)) > RULES.unit.largest_angle
        ):
            text = (
                f"spans {float(np.nanmax(values) - np.nanmin(values)):.3g} rad, two turns or more"
            )
            found.append(
                Finding(
                    WARNING,
                    column,
                    text,
                    "if it is in degrees, convert to rad; a joint that turns on and on is well",
                )
            )
        limit, unit = {
            "motor_current": (RULES.unit.largest_current, "mA: convert to A"),
            "battery_voltage": (RULES.unit.largest_voltage, "mV: convert to V"),
            "motor_temperature": (
                RULES.unit.largest_temperature,
                "kelvin or fahrenheit: convert to degC",
            ),
            "gyro": (RULES.unit.largest_rate, "deg/s: convert to rad/s"),
        }.get(kind, (math.inf, ""))
        if middle > limit or (kind == "gyro" and largest > 2 * limit):
            found.append(
                Finding(
                    ERROR,
                    column,
                    f"reaches {largest:.4g}, no such thing in this unit",
                    f"looks like {unit}",
                )
            )
    if all(log.has("accelerometer", axis) for axis in "xyz"):
        # axes that are told in turn are each known all along
        weight = float(
            np.median(
                np.linalg.norm([bridged(axis) for axis in log.vector("accelerometer").T], axis=0)
            )
        )
        if not 5 < weight < 20:
            text = f"has a median length of {weight:.3g} m/s^2 where gravity makes 9.8"
            found.append(
                Finding(
                    ERROR,
                    "accelerometer",
                    text,
                    "convert from g, or leave gravity in: +9.81 upward at rest",
                )
            )
    if all(log.has("base_orientation", axis) for axis in "wxyz"):
        length = np.linalg.norm(log.vector("base_orientation"), axis=1)
        if abs(float(np.nanmedian(length)) - 1) > 0.01:
            found.append(
                Finding(
                    ERROR,
                    "base_orientation",
                    "is no unit quaternion",
                    "give w, x, y, z, world from base",
                )
            )
    return found


def _torques(log: Log, subject: Subject | None) -> list[Finding]:
    """Measured torque against what the declared gains ask for, and current against torque: units of
    gains and currents.
    """
    found: list[Finding] = []
    told: set[str] = set()
    for column, asked, torque in _asked(log, subject):
        place = column.partition("/")[2]
        if place in told:
            continue
        told.add(place)
        slope, fit = _slopes(asked[:, None], torque[:, None])
        if fit[0] < -RULES.unit.fits:
            found.append(
                Finding(
                    WARNING, column, "runs against what target and gains ask for", "check its sign"
                )
            )
        elif fit[0] > RULES.unit.strange and any(
            abs(slope[0] / v - 1) < RULES.unit.tolerance for v in (DEGREES, 1 / DEGREES)
        ):
            text = (
                f"is {slope[0]:.3g} times what the declared gains ask for: the gains look like "
                f"Nm/deg, or the torque is off"
            )
            geared = subject is None and not column.startswith("joint_torque")
            remedy = "declare gains in Nm/rad and Nms/rad" + (
                ", unless a gear of that ratio lies between" if geared else ""
            )
            found.append(Finding(WARNING if geared else ERROR, column, text, remedy))
    for motor in log.motors:
        if not log.has("motor_current", motor):
            continue
        constant = log.metadata.torque_constant.get(motor)
        for kind in ("motor_torque", "motor_torque_command", "joint_torque"):
            if log.has(kind, motor) and constant:
                slope, fit = _slopes(
                    log.column(f"{kind}/{motor}")[:, None],
                    constant * log.column(f"motor_current/{motor}")[:, None],
                )
                if fit[0] > RULES.unit.strange and abs(slope[0] / 1000 - 1) < 0.5:
                    text = (
                        f"makes {slope[0]:.3g} times the torque with the declared torque "
                        f"constant: it is in mA"
                    )
                    found.append(Finding(ERROR, f"motor_current/{motor}", text, "convert to A"))
                break
    return found


def _asked(log: Log, subject: Subject | None) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Columns of torques, what targets and declared gains ask for there, and what they hold `(t,)`
    each [Nm].

    Motors are asked through the robot's transmission; of an unknown robot they are taken to sit at
    the joints that they are called after.
    """
    gains = log.metadata.gains
    joints = subject.joints if subject is not None else tuple(log.joints)
    asked = np.full((len(log.time), len(joints)), np.nan)
    for i, joint in enumerate(joints):
        if joint in gains and joint in log.joints and log.has("position_target", joint):
            stiffness, damping = gains[joint]
            error = log.column(f"position_target/{joint}") - log.column(f"position/{joint}")
            speed = (
                log.column(f"velocity/{joint}")
                if log.has("velocity", joint)
                else np.gradient(log.column(f"position/{joint}"), log.time)
            )
            asked[:, i] = stiffness * error - damping * speed
    motors = joints if subject is None else subject.motors
    of_motor = asked if subject is None else applied(subject.motor_from_joint, asked)
    found = []
    for kind, names, wanted in (
        ("joint_torque", joints, asked),
        ("motor_torque_command", motors, of_motor),
        ("motor_torque", motors, of_motor),
    ):
        held = (
            log.stack(kind, names)
            if subject is None or kind == "joint_torque"
            else of_motors(log, kind, subject)
        )
        found += [
            (f"{kind}/{name}", wanted[:, i], held[:, i])
            for i, name in enumerate(names)
            if np.isfinite(held[:, i]).any()
        ]
    return found


def _stuck(log: Log) -> list[Finding]:
    found: list[Finding] = []
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
                found.append(
                    Finding(
                        ERROR,
                        f"position/{joint}",
                        "never changes though the joint is driven",
                        "mend the sensor; this joint tells nothing",
                    )
                )
            else:
                found.append(
                    Finding(
                        NOTE, f"position/{joint}", "never changes", "move this joint to learn of it"
                    )
                )
            continue
        stuck = frozen(log, joint)
        if stuck is not None:
            length = float(log.time[stuck.stop - 1] - log.time[stuck.start])
            text = (
                f"is frozen for {length:.2g} s from {log.time[stuck.start]:.4g} s while the "
                f"joint is driven"
            )
            found.append(
                Finding(
                    WARNING,
                    f"position/{joint}",
                    text,
                    "a stuck sensor or a blocked joint: this stretch is left out",
                )
            )
    return found


def _robot(log: Log, subject: Subject) -> list[Finding]:
    known, own = set(subject.joints), log.joints
    strangers = [joint for joint in own if joint not in known]
    if len(strangers) == len(own):
        text = f"has joints {', '.join(own[:4])}; the robot has {', '.join(subject.joints[:4])}"
        return [
            Finding(
                ERROR,
                "",
                f"is a log of another robot: it {text}",
                "choose the robot of the log, or rename the columns",
            )
        ]
    found = []
    if strangers:
        near = [
            f"{s} ({m[0]}?)" if (m := difflib.get_close_matches(s, subject.joints, 1)) else s
            for s in strangers
        ]
        found.append(
            Finding(
                ERROR,
                f"position/{strangers[0]}",
                f"joints that the robot does not have: {', '.join(near[:5])}",
                "rename or remove them",
            )
        )
    lacking = [joint for joint in subject.joints if joint not in own]
    if lacking:
        text = f"joints of the robot without positions: {', '.join(lacking[:6])}"
        found.append(
            Finding(WARNING, "", text, "they are taken to stand still; log them if they move")
        )
    lower, upper = (
        np.broadcast_to(subject.position_low, len(subject.joints)),
        np.broadcast_to(subject.position_high, len(subject.joints)),
    )
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
            f"{joint} by {beyond:.3g} rad" for joint, beyond, _ in (far or outside)[:4]
        )
        severity = ERROR if far else WARNING
        found.append(
            Finding(
                severity,
                f"position/{(far or outside)[0][0]}",
                f"beyond the robot's range: {text}",
                "check unit, zero and sign, and the robot",
            )
        )
    return found


def _windows(log: Log, joints: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Change of position, and integral of velocity, over windows `(k, n)` [rad]."""
    width = max(1, round(RULES.unit.window / log.step))
    position, velocity = log.stack("position", joints), log.stack("velocity", joints)
    steps = np.diff(log.time)[:, None]
    area = np.concatenate(
        [
            np.zeros((1, len(joints))),
            np.cumsum(np.nan_to_num(0.5 * (velocity[1:] + velocity[:-1])) * steps, 0),
        ]
    )
    lost = np.cumsum(~np.isfinite(velocity), 0)
    moved, integral = position[width:] - position[:-width], area[width:] - area[:-width]
    unknown = (lost[width:] > lost[:-width]) | (
        (log.time[width:] - log.time[:-width]) > 2 * width * log.step
    )[:, None]
    moved[unknown] = np.nan
    stride = max(1, width // 2)
    return moved[::stride], integral[::stride]


def _common_lag(log: Log, position: np.ndarray, target: np.ndarray) -> int:
    """Rows by which positions follow targets, up to half a second, the same for all joints,
    whichever follows which.
    """
    limit = min(round(0.5 / log.step), len(position) // 4)
    stride = max(1, len(position) // 4000)

    def unit(values: np.ndarray) -> np.ndarray:
        values = np.nan_to_num(values - np.nanmean(values, 0))
        return np.asarray(values / np.maximum(np.linalg.norm(values, axis=0), 1e-12))

    best, lag = -math.inf, 0
    for rows in np.unique(np.linspace(0, limit, 26).astype(int)) if limit > 0 else []:
        fit = unit(position[rows::stride]).T @ unit(target[: len(target) - rows : stride])
        total = float(fit.max(0).sum())
        if total > best + 1e-6:
            best, lag = total, int(rows)
    return lag


def _slopes(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Slope of y over x, and their correlation, column by column `(n,)`; NaN where one of them
    stands still.
    """
    known = np.isfinite(x) & np.isfinite(y)
    count = np.maximum(known.sum(0), 1)
    x, y = np.where(known, x, 0.0), np.where(known, y, 0.0)
    x, y = np.where(known, x - x.sum(0) / count, 0.0), np.where(known, y - y.sum(0) / count, 0.0)
    xx, yy, xy = (x * x).sum(0), (y * y).sum(0), (x * y).sum(0)
    with np.errstate(divide="ignore", invalid="ignore"):
        slope, fit = xy / xx, xy / np.sqrt(xx * yy)
    fit = np.where((xx > 0) & (yy == 0), 0.0, fit)  # one stands still while the other moves
    return np.asarray(slope), np.asarray(np.where(known.sum(0) < 8, np.nan, fit))


def _correlations(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Of each column of x `(t, n)` with y `(t,)`."""
    found = _slopes(x, np.broadcast_to(y[:, None], x.shape))[1]
    return np.where(np.isfinite(found), found, -1.0)
