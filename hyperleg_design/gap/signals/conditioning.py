"""From a log to `Signals`: an even time base, motion smoothed without delay, the motor torques that
are believed, and the residuals.

Motion comes from `smoothing`, a fixed-interval smoother whose noise is estimated from the log.
Everything else is interpolated onto the same ticks and not smoothed, because residuals and traces
are filtered alike later. Gaps in the clock or in a joint's positions are bridged, and marked as not
valid.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import KEPT_FROM
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.model.supply import driven_by_duty, over_nominal
from hyperleg_design.gap.signals import transmission
from hyperleg_design.gap.signals.balance import balance
from hyperleg_design.gap.signals.base_motion import base_motion
from hyperleg_design.gap.signals.channels import (
    GAP,
    applied,
    of_motors,
    resampled,
    resampled_or_none,
)
from hyperleg_design.gap.signals.control import control_residual
from hyperleg_design.gap.signals.ground import ground_residual
from hyperleg_design.gap.signals.inertial import inertial_residuals
from hyperleg_design.gap.signals.joint_motion import joint_motion
from hyperleg_design.gap.signals.limit_cycle import limit_cycle
from hyperleg_design.gap.signals.sensed import sensed_velocity
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.smoothing import Smooth
from hyperleg_design.simulation.drives import limits

EDGE = 4.0
"""Time that is left out beside gaps and at the ends of a log, times the crossover frequency of the
slowest smoother [rad]."""
LONGEST_EDGE = 0.25
"""Most of that time, however slow the smoother is [s]."""


def condition(log: Log, subject: Subject) -> Signals:
    """Make a log ready for the residuals.

    Args:
        log: with positions, and with targets, torque commands, torques or currents.
        subject: the robot; what the log declares of it (gains, torque constants, payload) is
            applied here.

    Returns:
        Motion, torques and residuals on even ticks.

    Raises:
        InputError: none of the robot's joints moves in this log, or nothing tells the torque of any
        motor.
    """
    subject = subject.declare(log.metadata)
    step = log.step
    ticks = log.time[0] + step * np.arange(int(np.floor(log.duration / step + 1e-6)) + 1)
    if len(ticks) < 16:
        raise InputError(log.name, "t", len(ticks), "is too short a log: expects at least 16 ticks")
    joints = joint_motion(log, subject, ticks)
    position, velocity = joints.position, joints.velocity
    motion, lacking, notes = joints.smooth, joints.lacking, [*joints.notes]
    base = None
    if subject.floating:
        base, derived = base_motion(log, subject, ticks)
        notes += derived
    voltage = _voltage(log, ticks)
    # the damping of a motor without current control is its own, by the speed that it really has
    seen = np.where(driven_by_duty(subject), np.nan, velocity)
    measured = _measured(log, subject, ticks)
    command, jump, target, control, others = _command(log, subject, ticks, motion, seen)
    residual = inertial_residuals(log, subject, ticks)
    speed, slip, refused = _motor_speeds(log, subject, ticks, motion.first, lacking)
    notes += refused
    if slip is not None:
        residual["transmission"] = slip
    limited = None if command is None else limited_torque(subject, command, speed, voltage, jump)
    believed = _believed(log, subject, measured, limited)
    shaken = limit_cycle(
        resampled(log.time, position, ticks), resampled(log.time, velocity, ticks), motion, step
    )
    margin = int(np.ceil(_edge(motion, lacking) / step))
    torques = balance(
        log, subject, ticks, joints, base, shaken, believed, measured is not None, margin
    )
    if torques.base is not None:
        residual["base"] = torques.base
    if torques.elimination is not None:
        notes.append(torques.elimination.note(subject.joints))
    residual["motion"] = torques.motion
    behind, before = torques.behind, torques.before
    if measured is not None and limited is not None:
        given = measured if before is None else measured + before
        residual["drive"], repeated = _drive_residual(subject, given, limited)
        notes += repeated
    elif behind is not None:
        notes.append(
            f"torque sensors behind the gears of {_names(subject.joints, behind)}: without "
            f"commands, friction, rotors and drives of these joints do not show"
        )
    if control is not None:
        residual["control"] = control
    if others:
        notes.append(
            f"motors whose logged commands are not those of a controller with stiffness and "
            f"damping: {', '.join(others)}"
        )
    valid = _valid(log, ticks, position[:, ~lacking], _edge(motion, lacking))
    signals = Signals(
        log=log,
        subject=subject,
        step=step,
        time=ticks,
        position=motion.value,
        velocity=motion.first,
        acceleration=motion.second,
        base=base,
        sensed=sensed_velocity(resampled(log.time, seen, ticks), motion, step),
        motor_speed=speed,
        target=target,
        command=command,
        measured=measured,
        believed=believed,
        rigid=torques.needed,
        temperature=resampled_or_none(
            log.time, of_motors(log, "motor_temperature", subject), ticks
        ),
        voltage=voltage,
        contact=torques.ground.foot_force,
        valid=valid,
        residual=residual,
        pad_force=torques.ground.pad_force,
        pushing=torques.ground.pushing,
        elimination=torques.elimination,
        touching=torques.ground.touching,
        bandwidth=motion.crossover / (2 * np.pi),
        noise=motion.level,
        jump=jump,
        limit_cycle=shaken,
        behind_gears=behind,
        before_sensors=before,
        notes=tuple(notes),
    )
    of_ground = ground_residual(signals)
    if of_ground is not None:
        residual["ground"] = of_ground
    return signals


def _motor_speeds(
    log: Log, subject: Subject, ticks: np.ndarray, velocity: np.ndarray, lacking: np.ndarray
) -> tuple[np.ndarray, np.ndarray | None, list[str]]:
    """Speeds of the motors, logged or by their joints `(t, m)` [rad/s]; the residual of the
    transmission, None where no speed of a motor is logged; and notes.
    """
    speed = velocity @ subject.joint_from_motor
    spin = resampled_or_none(log.time, of_motors(log, "motor_velocity", subject), ticks)
    if spin is None:
        return speed, None, []
    spin[:, np.abs(subject.joint_from_motor[lacking]).sum(0) > 0] = np.nan
    if not np.isfinite(spin).any():
        return speed, None, []
    slip, refused = transmission.transmission_residual(subject, spin, velocity, log.step)
    return np.where(np.isfinite(slip), spin, speed), slip, list(refused)


def _drive_residual(
    subject: Subject, measured: np.ndarray, limited: np.ndarray
) -> tuple[np.ndarray, list[str]]:
    """Measured motor torques minus the commands within limits `(t, m)` [Nm], and notes."""
    drive = measured - limited
    drive[:, ~subject.driven] = np.nan
    copied = np.isfinite(drive).any(0) & ~np.nan_to_num(drive).any(0)
    if not copied.any():
        return drive, []
    note = (
        f"motors whose measured torques repeat their commands, as those of drives without any "
        f"fault do: {', '.join(np.array(subject.motors)[copied])}"
    )
    return drive, [note]


def limited_torque(
    subject: Subject,
    torque: np.ndarray,
    speed: np.ndarray,
    voltage: np.ndarray | None = None,
    jump: np.ndarray | None = None,
) -> np.ndarray:
    """Bring motor torques within the peak torque and DC-motor line of the nominal motors.

    Args:
        subject: the robot.
        torque: of the motors `(t, m)` [Nm].
        speed: of the motors `(t, m)` [rad/s].
        voltage: of the battery `(t,)` [V], which motors without current control follow.
        jump: that the torque is more than this in one half of a tick and less in the other
            `(t, m)` [Nm].

    Returns:
        The torques [Nm], `(t, m)`.
    """
    peak, stall, free = subject.torque_limit, subject.stall_torque, subject.no_load_speed
    return limits.limited(torque, speed, peak, stall, free, over_nominal(subject, voltage), jump)


def _command(
    log: Log,
    subject: Subject,
    ticks: np.ndarray,
    motion: Smooth,
    speed: np.ndarray,
) -> tuple[
    np.ndarray | None,
    np.ndarray | None,
    np.ndarray | None,
    np.ndarray | None,
    tuple[str, ...],
]:
    """Motor torque that the controller asks for and its jumps, position targets, the residual of
    the control, and motors that it cannot speak of.

    Around a row at which a target is new, the old one that was kept until then acts as long.
    """
    raw_target = log.stack("position_target", subject.joints)
    logged = of_motors(log, "motor_torque_command", subject)
    command = resampled(log.time, logged, ticks)
    old = np.full_like(raw_target, np.nan)
    if are_kept(log):
        old[1:] = raw_target[:-1]
    old = np.where(np.isfinite(old), old, raw_target)
    target = resampled_or_none(log.time, (raw_target + old) / 2, ticks)
    control: np.ndarray | None = None
    jump: np.ndarray | None = None
    others: tuple[str, ...] = ()
    if target is not None:
        derived = np.stack([np.interp(log.time, ticks, v) for v in motion.first.T], -1)
        speed = np.where(np.isfinite(speed), speed, derived)
        stiffness, damping = subject.gains.T
        spring = stiffness * (raw_target - log.stack("position", subject.joints))
        half = stiffness * (raw_target - old) / 2
        damper = -damping * speed
        spring[:, subject.passive] = half[:, subject.passive] = damper[:, subject.passive] = 0.0
        if np.isfinite(logged).any():
            of_rotors = None
            if subject.one_to_one:
                spin = of_motors(log, "motor_velocity", subject)
                of_rotors = -damping * spin
            residual, others = control_residual(subject, logged, spring, damper, of_rotors)
            control = resampled_or_none(log.time, residual, ticks)
        supplied = over_nominal(subject, log.column("battery_voltage"))
        asked = supplied * applied(subject.motor_from_joint, spring - half) + applied(
            subject.motor_from_joint, damper
        )
        torque = resampled(log.time, asked, ticks)
        more = resampled(log.time, supplied * applied(subject.motor_from_joint, half), ticks)
        jump = np.where(np.isfinite(command), 0.0, np.nan_to_num(more))
        command = np.where(np.isfinite(command), command, torque)
    if subject.one_to_one and subject.passive.any():
        command[:, subject.passive] = 0.0
    known = np.isfinite(command[:, subject.driven]).any()
    return command if known else None, jump, target, control, others


def are_kept(log: Log) -> bool:
    """Tell whether targets are kept from row to row.

    Args:
        log: the log.
    """
    return (log.metadata.targets or ("kept" if log.step >= KEPT_FROM else "moving")) == "kept"


def _measured(log: Log, subject: Subject, ticks: np.ndarray) -> np.ndarray | None:
    """Measured torque of the motors `(t, m)` [Nm]: logged, else current times torque constant, else
    computed from logged joint torques; None where nothing was measured.
    """
    torque = of_motors(log, "motor_torque", subject)
    current = of_motors(log, "motor_current", subject) * subject.torque_constant
    torque = np.where(np.isfinite(torque), torque, current)
    from_joints = applied(subject.motor_from_joint, log.stack("joint_torque", subject.joints))
    measured = resampled(log.time, np.where(np.isfinite(torque), torque, from_joints), ticks)
    if not np.isfinite(measured).any():
        return None
    if subject.one_to_one:
        measured[:, subject.passive] = 0.0
    return measured


def _believed(
    log: Log, subject: Subject, measured: np.ndarray | None, limited: np.ndarray | None
) -> np.ndarray:
    if measured is None and limited is None:
        lacks = "targets"
        if log.names("position_target"):
            lacks = "gains (in the metadata, or in the robot's file) for its targets"
        currents = log.names("motor_current")
        if currents and not np.isfinite(subject.torque_constant).any():
            lacks = f"torque_constant in the metadata for its currents, or {lacks}"
        remedy = (
            f"tells the torque of no motor: it has neither torques nor currents that can be "
            f"read, and lacks {lacks}"
        )
        raise InputError(log.name, "motor_torque", None, remedy)
    if measured is None or limited is None:
        believed = measured if measured is not None else limited
        assert believed is not None
    else:
        believed = np.where(np.isfinite(measured).any(0), measured, limited)
    return believed.copy()


def _voltage(log: Log, ticks: np.ndarray) -> np.ndarray | None:
    voltage = resampled_or_none(log.time, log.column("battery_voltage")[:, None], ticks)
    return None if voltage is None else voltage[:, 0]


def _edge(motion: Smooth, lacking: np.ndarray) -> float:
    return min(EDGE / float(np.nanmin(motion.crossover[~lacking])), LONGEST_EDGE)


def _valid(log: Log, ticks: np.ndarray, position: np.ndarray, edge: float) -> np.ndarray:
    """Ticks away from the ends and from gaps in the clock or in any joint's positions."""
    step = log.step
    edge = min(edge, 0.1 * log.duration)
    valid = (ticks >= log.time[0] + edge) & (ticks <= log.time[-1] - edge)
    for column in position.T:
        at = log.time[np.isfinite(column)]
        ends = np.concatenate([[log.time[0]], at, [log.time[-1]]])
        for gap in np.flatnonzero(np.diff(ends) > GAP * step):
            valid &= (ticks < ends[gap] - edge) | (ticks > ends[gap + 1] + edge)
    return valid


def _names(names: tuple[str, ...], which: np.ndarray) -> str:
    return ", ".join(n for n, w in zip(names, which, strict=True) if w)
