"""What each nuisance parameter leaves in the residuals of a log."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.effect import LOGGED, NEEDED, STEERED
from hyperleg_design.gap.effects.placing import (
    before_measurement,
    friction_trace,
    is_commanded,
    is_logged,
    is_measured,
    motor_velocity,
)
from hyperleg_design.gap.effects.series import first_derivative
from hyperleg_design.gap.effects.transmissions import belt
from hyperleg_design.gap.effects.unlisted.turned_imu import TurnedImu
from hyperleg_design.gap.effects.usual import least_friction
from hyperleg_design.gap.inference.nuisance import (
    BACK_EMF,
    FILTERED,
    FORCES_LATE,
    FORCES_SCALED,
    GEARED,
    IMU_TURNED,
    SOLE_GIVES,
    SPEEDS,
    STEPPED,
    SWINGS,
    SWUNG,
    TARGETS_AGED,
    TARGETS_LATE,
    TOLD_LATE,
    TORQUE_ZERO,
    TORQUES_LATE,
    TURNOVER,
    UNLISTED,
    WAYS,
    NuisanceParameter,
)
from hyperleg_design.gap.model import friction, pads
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.channels import applied
from hyperleg_design.gap.signals.conditioning import are_kept
from hyperleg_design.gap.signals.filtering import FilteredLog
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.sliding import dry_friction, sliding
from hyperleg_design.gap.signals.transmission import turned
from hyperleg_design.simulation.drives.actuation import friction_damping

if TYPE_CHECKING:
    from collections.abc import Sequence


def traces(signals: Signals, errors: Sequence[NuisanceParameter]) -> list[dict[str, np.ndarray]]:
    """Compute what each nuisance parameter leaves at one spread from its null.

    Torque constants scale the torque that the motion needs, not the measured one, and so do gains
    where no torque was measured. With the measured torque all of them together could scale the
    noise away, and masses and loads with it, which no motion contradicts.

    Args:
        signals: of a log.
        errors: the nuisance parameters.

    Returns:
        For each of them, by residual `(t, columns)`.
    """
    needed = np.asarray(signals.rigid @ signals.subject.motor_from_joint.T)
    modelled = replace(
        signals, believed=np.where(np.isfinite(needed), needed, signals.believed), target=None
    )
    sources = {LOGGED: signals, NEEDED: modelled, STEERED: _steered(signals)}
    by_parameter = []
    for error in errors:
        if error.effect in (TURNOVER, SWUNG):
            trace = (_turnover if error.effect == TURNOVER else _swung)(
                signals, error.location, error.parameter
            )
            by_parameter.append({b: v * error.spread for b, v in trace.items()})
            continue
        if error.effect in UNLISTED:
            by_parameter.append(_OWN.get(error.effect, _told)(signals, error))
            continue
        effect = EFFECTS[error.effect]
        alone = effect.nuisance_trace(signals, error.location, error.parameter, error.spread)
        if alone is not None:
            by_parameter.append(alone)
            continue
        values = effect.nulls
        low, high = effect.bounds(error.location, signals.subject)[:, error.parameter]
        sign = 1.0 if values[error.parameter] + error.spread <= high else -1.0
        values[error.parameter] = np.clip(values[error.parameter] + sign * error.spread, low, high)
        source = sources[effect.nuisance_torque]
        moved = (values[error.parameter] - effect.nulls[error.parameter]) / error.spread
        by_parameter.append(
            {b: v[0] / moved for b, v in effect.trace(source, error.location, values[None]).items()}
            if moved
            else {}
        )
    return by_parameter


def _steered(signals: Signals) -> Signals:
    """Replace the targets by those with which the controllers would ask for the needed torque,
    where torques are known from targets alone.
    """
    if not signals.steered:
        return signals
    assert signals.target is not None
    stiffness, damping = signals.subject.gains.T
    with np.errstate(divide="ignore", invalid="ignore"):
        target = signals.position + (signals.rigid + damping * signals.velocity) / stiffness
    return replace(signals, target=np.where(np.isfinite(target), target, signals.target))


def _speeds(signals: Signals, error: NuisanceParameter) -> dict[str, np.ndarray]:
    """Traces of `SPEEDS`: errors between a motor's speed and that of its joints."""
    if "transmission" not in signals.residual:
        return {}
    subject = signals.subject
    motor = subject.motors.index(error.location)
    if error.effect == GEARED:
        speed = motor_velocity(signals, motor)
    elif error.effect == TOLD_LATE:
        speed = -signals.acceleration @ subject.joint_from_motor[:, motor]
    else:
        speed = first_derivative(belt.transmitted(signals, motor), signals.step)
    return _alone(turned(signals, motor, error.spread * speed[None]))


def _stepped(signals: Signals, error: NuisanceParameter) -> dict[str, np.ndarray]:
    """Trace of `STEPPED`: friction as simulators integrate it, less friction at the speed
    itself.
    """
    subject, half = signals.subject, signals.acceleration * signals.step / 2
    damping = friction_damping(
        subject.coulomb,
        np.zeros_like(subject.coulomb),
        signals.velocity - half,
        subject.friction_speed,
    )
    smooth = subject.coulomb * friction.turned(signals.velocity, subject.friction_speed)
    return friction_trace(signals, error.spread * (damping * (signals.velocity + half) - smooth))


def _filtered(signals: Signals, error: NuisanceParameter) -> dict[str, np.ndarray]:
    """Trace of `FILTERED`: torque that controllers ask for by the delay of their speeds. Motors
    without current control are damped by their own back-EMF, which has no delay.
    """
    subject = signals.subject
    _, damping = _gains(subject)
    asked = applied(subject.motor_from_joint, error.spread * damping * signals.acceleration)
    return _asked(signals, np.where(np.isfinite(subject.supply), 0.0, asked))


def _late_targets(signals: Signals, error: NuisanceParameter) -> dict[str, np.ndarray]:
    """Trace of `TARGETS_LATE`: torque that controllers ask for by older targets."""
    return {} if signals.target is None else _asked(signals, _by_older_targets(signals, error))


def _aged(signals: Signals, error: NuisanceParameter) -> dict[str, np.ndarray]:
    """Trace of `TARGETS_AGED`: as of late targets; and a torque that is measured at one moment of
    the step differs as much from the mean, which moves the robot.
    """
    if signals.target is None or not are_kept(signals.log):
        return {}
    asked = _by_older_targets(signals, error)
    traced = _asked(signals, asked)
    sampled = [is_measured(signals, m) and is_commanded(signals, m) for m in range(asked.shape[1])]
    if any(sampled):
        motion = np.where(sampled, asked, 0.0) @ signals.subject.joint_from_motor.T
        traced["motion"] = traced.get("motion", 0.0) + motion
    return traced


def _by_older_targets(signals: Signals, error: NuisanceParameter) -> np.ndarray:
    """Change of what controllers ask motors for by older targets `(t, m)` [Nm]."""
    assert signals.target is not None
    stiffness, _ = _gains(signals.subject)
    older = -error.spread * first_derivative(signals.target.T, signals.step).T
    return np.nan_to_num(applied(signals.subject.motor_from_joint, stiffness * older))


def _gains(subject: Subject) -> np.ndarray:
    """Stiffness and damping of the controllers, 0 where there are none `(2, n)`."""
    without = subject.passive | ~np.isfinite(subject.gains).all(1)
    return np.where(without, 0.0, subject.gains.T)


def _asked(signals: Signals, torque: np.ndarray) -> dict[str, np.ndarray]:
    """Trace of a change of what controllers ask motors for `(t, m)` [Nm]."""
    torque = np.nan_to_num(torque)
    control, changes = np.zeros_like(torque), {}
    for motor in range(torque.shape[1]):
        if not is_commanded(signals, motor):
            continue
        if is_logged(signals, motor):
            control[:, motor] = torque[:, motor]
        else:
            changes[motor] = torque[None, :, motor]
    traced = _alone(before_measurement(signals, changes))
    return traced | ({"control": control} if "control" in signals.residual else {})


def _back_emf(signals: Signals, error: NuisanceParameter) -> dict[str, np.ndarray]:
    """Trace of `BACK_EMF`: torque that is missing where the motor accelerates. A motor without
    current control has all of its back-EMF in its model.
    """
    subject = signals.subject
    motor = subject.motors.index(error.location)
    if not is_commanded(signals, motor) or np.isfinite(subject.supply[motor]):
        return {}
    missing = -error.spread * (signals.acceleration @ subject.joint_from_motor[:, motor])
    return _alone(before_measurement(signals, {motor: missing[None]}))


def _turned_imu(signals: Signals, error: NuisanceParameter) -> dict[str, np.ndarray]:
    """Trace of `IMU_TURNED`."""
    turn = error.spread * np.eye(3)[error.parameter]
    return _alone(TurnedImu().trace(signals, error.location, turn[None]))


def _zero(signals: Signals, error: NuisanceParameter) -> dict[str, np.ndarray]:
    """Trace of `TORQUE_ZERO`: what a sensor reads too much, its motor seems to give and its joint
    not to need.
    """
    motor = signals.subject.motors.index(error.location)
    if not signals.sensed_behind[motor] or not is_measured(signals, motor):
        return {}
    read = np.zeros_like(signals.believed)
    read[:, motor] = error.spread
    traced = {"motion": -applied(signals.subject.joint_from_motor, read)}
    return traced | ({"drive": read} if "drive" in signals.residual else {})


def _alone(trace: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The only row of a trace `(1, t, columns)` in each residual."""
    return {residual_name: rows[0] for residual_name, rows in trace.items()}


def _told(signals: Signals, error: NuisanceParameter) -> dict[str, np.ndarray]:
    """Traces of errors of logged forces and torques: delays, scale, and where forces act."""
    subject = signals.subject
    if error.effect == TORQUES_LATE:
        known = signals.measured is not None
        return (
            {"motion": -error.spread * first_derivative(signals.rigid.T, signals.step).T}
            if known
            else {}
        )
    if signals.pushing is None:
        return {}
    force = signals.pushing
    rotation = None if signals.base is None else signals.base.rotation
    own = np.array([subject.feet[p.foot] == error.location for p in subject.pads])
    if error.effect == FORCES_LATE:
        later = -error.spread * np.gradient(force, signals.step, axis=0)
        torque, wrench = pads.contact_torque(subject, signals.position, rotation, later)
    elif error.effect == FORCES_SCALED:
        scaled = error.spread * np.where(own[:, None], force, 0.0)
        torque, wrench = pads.contact_torque(subject, signals.position, rotation, scaled)
    else:
        force = np.where(own[:, None], force, 0.0)
        load = np.maximum(force[..., 2], 0.0)
        share = (
            load / max(float(load[load > 0].mean()), 1e-9)
            if error.effect == SOLE_GIVES and load.any()
            else 1.0
        )
        higher, lower = (
            pads.contact_torque(subject, signals.position, rotation, force, lift)
            for lift in (error.spread * share, 0.0)
        )
        torque, wrench = (a - b for a, b in zip(higher, lower, strict=True))
    return {"motion": torque} | ({"base": wrench} if "base" in signals.residual else {})


_OWN = {
    STEPPED: _stepped,
    FILTERED: _filtered,
    TARGETS_AGED: _aged,
    TARGETS_LATE: _late_targets,
    BACK_EMF: _back_emf,
    IMU_TURNED: _turned_imu,
    TORQUE_ZERO: _zero,
    **dict.fromkeys(SPEEDS, _speeds),
}
"""Traces of parameters that belong to no effect of the catalogue; of all others `_told`."""


def _turnover(signals: Signals, joint: str, way: int) -> dict[str, np.ndarray]:
    """Trace of `TURNOVER`: friction that reverses at once, less that of the model; or (`way` from
    1) friction that reverses over a way, less friction that reverses at once.
    """
    subject, rows = signals.subject, np.zeros_like(signals.position)
    j = subject.joints.index(joint)
    at_once = sliding(signals)[:, j]
    swing = None if signals.limit_cycle is None else signals.limit_cycle.speed[:, j]
    turned = friction.turned(signals.velocity[:, j], subject.friction_speed[j], swing)
    shape = (
        friction.stop(signals.position[:, j], WAYS[way - 1]) - at_once if way else at_once - turned
    )
    rows[:, j] = np.maximum(dry_friction(signals), least_friction(subject))[j] * shape
    return friction_trace(signals, rows)


def _swung(signals: Signals, joint: str, place: int) -> dict[str, np.ndarray]:
    """Trace of `SWUNG`: mean friction of a joint in a limit cycle of another amplitude, less that
    at the amplitude that the log shows.
    """
    subject = signals.subject
    j = subject.joints.index(joint)
    if signals.limit_cycle is None or not signals.limit_cycle.speed[:, j].any():
        return {}
    rows = np.zeros_like(signals.position)
    speed = signals.velocity[:, j]
    width = subject.friction_speed[j]
    swing = signals.limit_cycle.speed[:, j]
    rows[:, j] = subject.coulomb[j] * (
        friction.turned(speed, width, SWINGS[place] * swing) - friction.turned(speed, width, swing)
    )
    return friction_trace(signals, rows)


def columns(
    filtered_log: FilteredLog, errors: Sequence[NuisanceParameter]
) -> dict[int, np.ndarray]:
    """Sample what each nuisance parameter leaves at one spread from its null.

    Args:
        filtered_log: of one log.
        errors: the nuisance parameters.

    Returns:
        By index of the row `(errors, samples)`.
    """
    sampled = {
        row: np.zeros((len(errors), filtered_log.count(row)))
        for row in range(len(filtered_log.rows))
    }
    for place, physical in enumerate(traces(filtered_log.signals, errors)):
        trace = filtered_log.signals.shown(physical)
        for row, entry in enumerate(filtered_log.rows):
            if entry.residual_name in trace:
                values = trace[entry.residual_name][:, entry.column]
                if np.any(np.nan_to_num(values) != 0):
                    sampled[row][place] = filtered_log.sample(row, values[None])[0]
    return sampled
