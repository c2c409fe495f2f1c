"""Where a trace shows: the rule for effects between a command and the joints, and what effects
share to apply it.

    command --(gains, delay, bandwidth, limits, voltage)--> measured torque --(constant, cogging,
    friction, gears)--> joints

What lies after the measurement shows in the residual of motion. What lies before it, a change `d`
of the torque that the drive gives, shows in the residual of the drive as `+d` and leaves that of
motion alone, which trusts the measurement. Of motors whose torque nobody measured, motion trusts
the command, and the same change shows there, as `-M d`.

A measured torque counts as what the drive takes itself to give, as current times a declared
constant is; so do joint torques, unless a sensor between gear and link measures them. Then the
constant, cogging, rotors and friction lie before the measurement, too, and only the links after it.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import compress

import numpy as np

from hyperleg_design.gap.model.machine import machine_of
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.memoized import memoized
from hyperleg_design.simulation.drives import limits

SIDES = ("encoders at the joints", "encoders at the rotors")
"""Choices of the parameter `side`: whose positions logs and controllers know."""
ROBOT = "robot"
BATTERY = "battery"
machine = memoized(machine_of)
"""Drives of a subject, computed once."""


def driven_motors(subject: Subject) -> tuple[str, ...]:
    """Motors that exist: those of passive joints do not.

    Args:
        subject: the robot.

    Returns:
        Their names.
    """
    return tuple(compress(subject.motors, subject.driven))


def at_joint(
    signals: Signals, joint: int, torque: np.ndarray, *, resists: bool = False
) -> dict[str, np.ndarray]:
    """Trace of a torque that a joint takes from its drive, beyond the model `(k, t)` [Nm].

    Args:
        signals: a conditioned log, `t` ticks.
        joint: index of the joint.
        torque: `(k, t)` [Nm].
        resists: whether it acts before a torque sensor behind the gear, as friction does.

    Returns:
        The trace by name of the residual.
    """
    if resists and signals.behind_gears is not None and signals.behind_gears[joint]:
        share = signals.subject.motor_from_joint[:, joint]
        return {"drive": -torque[..., None] * share}
    rows = _rows(torque, len(signals.subject.joints))
    rows[:, joint] = torque
    return {"motion": rows.swapaxes(1, 2)}


def friction_trace(signals: Signals, torque: np.ndarray) -> dict[str, np.ndarray]:
    """Trace of torques that friction takes at all joints, beyond the model.

    Args:
        signals: a conditioned log, `t` ticks.
        torque: `(..., t, n)` [Nm].

    Returns:
        The trace by name of the residual.
    """
    behind = signals.behind_gears
    if behind is None:
        return {"motion": torque}
    drive = -np.where(behind, torque, 0.0) @ signals.subject.motor_from_joint.T
    return {"drive": drive, "motion": np.where(behind, 0.0, torque)}


def at_motor(signals: Signals, motor: int, torque: np.ndarray) -> dict[str, np.ndarray]:
    """Trace of a torque that is lost between a motor and the joints, on the motor's side `(k, t)`
    [Nm].

    Args:
        signals: a conditioned log, `t` ticks.
        motor: index of the motor.
        torque: on the motor's side `(k, t)` [Nm].

    Returns:
        The trace by name of the residual.
    """
    if signals.sensed_behind[motor]:
        return before_measurement(signals, {motor: -torque})
    rows = _rows(torque, len(signals.subject.joints))
    _add(rows, signals, motor, torque)
    return {"motion": rows.swapaxes(1, 2)}


def before_measurement(
    signals: Signals,
    changes: Mapping[int, np.ndarray],
    control: Mapping[int, np.ndarray] | None = None,
) -> dict[str, np.ndarray]:
    """Trace of changes of what drives give, by the rule of this module, and of what controllers ask
    of them.

    Args:
        signals: a conditioned log, `t` ticks.
        changes: of the torque, by index of the motor `(k, t)` [Nm].
        control: of logged commands, likewise, where the residual of the control shows them.

    Returns:
        The trace by name of the residual.
    """
    rows: dict[str, np.ndarray] = {}
    for motor, share in (control or {}).items() if "control" in signals.residual else ():
        rows.setdefault("control", _rows(share, len(signals.subject.motors)))[:, motor] = share
    for motor, change in changes.items():
        if is_measured(signals, motor):
            rows.setdefault("drive", _rows(change, len(signals.subject.motors)))[:, motor] += change
        else:
            moved = rows.setdefault("motion", _rows(change, len(signals.subject.joints)))
            _add(moved, signals, motor, -change)
    return {residual_name: values.swapaxes(1, 2) for residual_name, values in rows.items()}


def is_measured(signals: Signals, motor: int) -> bool:
    """Whether the residual of motion trusts a measurement of this motor.

    Args:
        signals: a conditioned log, `t` ticks.
        motor: index of the motor.

    Returns:
        True if so.
    """
    return signals.measured is not None and bool(np.isfinite(signals.measured[:, motor]).any())


def is_commanded(signals: Signals, motor: int) -> bool:
    """Whether it is known what the controller asks of this motor.

    Args:
        signals: a conditioned log, `t` ticks.
        motor: index of the motor.

    Returns:
        True if so.
    """
    return signals.command is not None and bool(np.isfinite(signals.command[:, motor]).any())


def commanded(signals: Signals, motor: int) -> np.ndarray:
    """What the controller asks of a motor, before limits `(t,)` [Nm].

    Args:
        signals: a conditioned log, `t` ticks.
        motor: index of the motor.

    Returns:
        The torque `(t,)` [Nm].
    """
    assert signals.command is not None
    return signals.command[:, motor]


def is_logged(signals: Signals, motor: int) -> bool:
    """Whether a log tells what the controller asks of this motor.

    Args:
        signals: a conditioned log, `t` ticks.
        motor: index of the motor.

    Returns:
        True if so.
    """
    subject, log = signals.subject, signals.log
    return any(
        log.has("motor_torque_command", name)
        for name in (subject.motors[motor], subject.motor_aliases[motor])
    )


def given(signals: Signals, motor: int) -> np.ndarray:
    """Torque believed of a motor `(t,)` [Nm].

    One that gains and targets alone tell, from smoothed motion: noise of the sensors is in the
    residual already, and no effect scales it.

    Args:
        signals: a conditioned log, `t` ticks.
        motor: index of the motor.

    Returns:
        The torque `(t,)` [Nm].
    """
    believed = signals.believed[:, motor]
    if signals.before_sensors is not None and signals.sensed_behind[motor]:
        if is_commanded(signals, motor):
            return limited(signals, motor, commanded(signals, motor))
        return believed + signals.before_sensors[:, motor]
    parts = _spring_and_damper(signals, motor)
    if parts is None:
        return believed
    asked = parts[0] - parts[1]
    return np.where(np.isfinite(asked), limited(signals, motor, asked), believed)


def braked(signals: Signals, motor: int) -> np.ndarray:
    """Torque by which the windings of a motor without current control brake it, where `given` holds
    it; it grows with the square of the torque constant.

    Args:
        signals: a conditioned log, `t` ticks.
        motor: index of the motor.

    Returns:
        The torque `(t,)` [Nm]; 0 of motors with current control, or whose torque is logged.
    """
    parts = _spring_and_damper(signals, motor)
    if parts is None or not np.isfinite(signals.subject.supply[motor]):
        return np.zeros(len(signals.time))
    return np.nan_to_num(parts[1])


def _spring_and_damper(signals: Signals, motor: int) -> tuple[np.ndarray, np.ndarray] | None:
    """What the controllers of a motor ask for by positions, and what they take off by speeds `(t,)`
    [Nm] each; None where its torque is logged.
    """
    if signals.target is None or is_measured(signals, motor) or is_logged(signals, motor):
        return None
    subject = signals.subject
    stiffness, damping = np.where(subject.passive[:, None], 0.0, subject.gains).T
    share = subject.motor_from_joint[motor]
    own = share != 0
    spring = (signals.target - signals.position)[:, own] @ (stiffness * share)[own]
    return signals.supplied[:, motor] * spring, signals.sensed[:, own] @ (damping * share)[own]


def motor_position(signals: Signals, motor: int) -> np.ndarray:
    """Compute the angle of one motor, M^T q `(t,)` [rad].

    Args:
        signals: a conditioned log, `t` ticks.
        motor: index of the motor.
    """
    return np.asarray(signals.position @ signals.subject.joint_from_motor[:, motor])


def motor_velocity(signals: Signals, motor: int) -> np.ndarray:
    """Compute the speed of one motor, M^T q_dot `(t,)` [rad/s].

    Args:
        signals: a conditioned log, `t` ticks.
        motor: index of the motor.
    """
    return np.asarray(signals.velocity @ signals.subject.joint_from_motor[:, motor])


def limited(
    signals: Signals,
    motor: int,
    torque: np.ndarray,
    *,
    peak: float | np.ndarray = np.inf,
    voltage: float | np.ndarray = 1.0,
    line: tuple[float | np.ndarray, float | np.ndarray] | None = None,
) -> np.ndarray:
    """Torque of one motor within its limits, as `conditioning.limited_torque` [Nm].

    Args:
        signals: a conditioned log.
        motor: place of the motor.
        torque: `(..., t)` [Nm].
        peak: further limit [Nm], broadcasts against `torque`.
        voltage: over the nominal one; scales stall torque and no-load speed, broadcasts against
            `torque`.
        line: stall torque [Nm] and no-load speed [rad/s], broadcast likewise; by default the
            motor's own.
    """
    subject = signals.subject
    stall, free = line or (subject.stall_torque[motor], subject.no_load_speed[motor])
    return limits.limited(
        torque,
        signals.motor_speed[:, motor],
        np.minimum(subject.torque_limit[motor], peak),
        stall,
        free,
        np.maximum(voltage, 0.0) * signals.supplied[:, motor],
        None if signals.jump is None else signals.jump[:, motor],
    )


def _rows(torque: np.ndarray, count: int) -> np.ndarray:
    """Zeros `(k, count, t)`: one row after the other in memory, as they are filled."""
    return np.zeros((len(torque), count, torque.shape[1]))


def _add(rows: np.ndarray, signals: Signals, motor: int, torque: np.ndarray) -> None:
    """Add a motor's torque `(k, t)` to the joints `(k, n, t)` that it moves; NaN stays with
    these.
    """
    column = signals.subject.joint_from_motor[:, motor]
    for joint in np.flatnonzero(column).tolist():
        rows[:, joint] += column[joint] * torque
