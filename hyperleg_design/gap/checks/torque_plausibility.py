"""Whether torques fit the controller that asks for them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hyperleg_design.gap.checks.rules import RULES
from hyperleg_design.gap.checks.slopes import DEGREES, fitted_slopes
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.results.finding import ERROR, WARNING, Finding
from hyperleg_design.gap.signals.channels import applied, of_motors


def implausible_torques(log: Log, subject: Subject | None) -> Iterator[Finding]:
    """Find torques that do not fit the declared gains, and currents that do not fit torques: wrong
    units.

    Args:
        log: the log.
        subject: the robot, if known.

    Returns:
        The findings.
    """
    checked_places: set[str] = set()
    for column, asked, torque in asked_torque(log, subject):
        place = column.partition("/")[2]
        if place in checked_places:
            continue
        checked_places.add(place)
        slope, fit = fitted_slopes(asked[:, None], torque[:, None])
        if fit[0] < -RULES.unit.fits:
            yield Finding(
                WARNING, column, "runs against what target and gains ask for", "check its sign"
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
            yield Finding(WARNING if geared else ERROR, column, text, remedy)
        elif fit[0] > RULES.unit.strange and _thousand(slope[0]):
            text = f"is {slope[0]:.3g} times what targets and declared gains ask for: it is in mNm"
            yield Finding(ERROR, column, text, "convert to Nm")
    for motor in log.motors:
        if not log.has("motor_current", motor):
            continue
        constant = log.metadata.torque_constant.get(motor)
        for kind in ("motor_torque", "motor_torque_command", "joint_torque"):
            if log.has(kind, motor) and constant:
                slope, fit = fitted_slopes(
                    log.column(f"{kind}/{motor}")[:, None],
                    constant * log.column(f"motor_current/{motor}")[:, None],
                )
                if fit[0] > RULES.unit.strange and _thousand(slope[0]):
                    text = (
                        f"makes {slope[0]:.3g} times the torque with the declared torque "
                        f"constant: it is in mA"
                    )
                    yield Finding(ERROR, f"motor_current/{motor}", text, "convert to A")
                break


def _thousand(slope: float) -> bool:
    """Whether a slope stands for a unit with milli before it."""
    return abs(slope / 1000 - 1) < 0.5


def asked_torque(log: Log, subject: Subject | None) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Compute what targets and declared gains ask for, beside what the log holds.

    Motors are asked through the robot's transmission; of an unknown robot they are taken to sit at
    the joints that they are called after.

    Args:
        log: the log.
        subject: the robot, if known.

    Returns:
        Columns of torques, what is asked for there, and what they hold, `(t,)` each [Nm].
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
    compared = []
    for kind, names, wanted in (
        ("joint_torque", joints, asked),
        ("motor_torque_command", motors, of_motor),
        ("motor_torque", motors, of_motor),
    ):
        logged = (
            log.stack(kind, names)
            if subject is None or kind == "joint_torque"
            else of_motors(log, kind, subject)
        )
        compared += [
            (f"{kind}/{name}", wanted[:, i], logged[:, i])
            for i, name in enumerate(names)
            if np.isfinite(logged[:, i]).any()
        ]
    return compared
