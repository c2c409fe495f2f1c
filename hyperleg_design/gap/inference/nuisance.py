"""The usual small nuisance parameters, which are no causes: priors of each, fitted anew for every
recording session.

Each is one parameter of an effect of the catalogue at one place, so that its trace is the effect's
own. Widths are assumed, of the order that data sheets and drawings are wrong by.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.effects import EFFECTS, belt
from hyperleg_design.gap.effects.placing import (
    ROBOT,
    before_measurement,
    driven_motors,
    is_commanded,
    is_logged,
    joint_inertia,
    joint_strength,
    motor_strength,
    motor_velocity,
)
from hyperleg_design.gap.effects.series import first_derivative
from hyperleg_design.gap.model import friction, pads
from hyperleg_design.gap.signals.channels import applied
from hyperleg_design.gap.signals.sliding import sliding
from hyperleg_design.gap.signals.transmission import turned
from hyperleg_design.simulation.drives.actuation import friction_damping

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hyperleg_design.gap.model.subject import Subject
    from hyperleg_design.gap.signals.filtering import FilteredLog
    from hyperleg_design.gap.signals.signals import Signals

TORQUE_CONSTANT = 0.03
COULOMB, COULOMB_LEAST = 0.08, 0.0008
"""Of the model's friction, and of the torque that the joint is made for."""
VISCOUS, VISCOUS_LEAST = 0.12, 0.0007
BREAKAWAY = 0.08
"""Of the model's Coulomb friction."""
LOAD_FRICTION = 0.006
OFFSET = 0.003
"""[rad]"""
MASS, CENTRE, SHORTEST = 0.03, 0.03, 0.03
"""Of the link's mass; of the distance of its centre of mass from its joint, at least of so many
metres."""
ROTOR, OWN_INERTIA = 0.06, 0.01
"""Of the rotor's inertia and of that of its joint."""
TORQUE_OFFSET, SPRING = 0.002, 0.002
"""Of the torque that the joint is made for, and that a radian."""
LATE, LATE_TICKS = 0.001, 0.15
"""[s] and ticks of the log, of all drives; a lag of one of them is half."""
READING = 1
"""Parameter of a torque constant by which currents are read wrongly."""
CURRENT = 0.005
"""Of the torque that a drive says that it gives, apart from its motor's."""
GAIN = 0.015
GYRO, ACCELEROMETER = 0.003, 0.05
"""[rad/s], [m/s^2]"""
GROUND, BEARING = 0.1, 0.5
"""Of the ground's friction; of how it gives and damps, which no simulator has from a
measurement."""
FORCES_SCALED, OF_FORCES = "contact_scale", 0.01
"""Share by which the forces under a foot are told too large or too small (assumed: load cells in
feet)."""
TURNOVER, SWUNG = "friction_turnover", "friction_in_chatter"
"""Friction of models turns over with speed, as tanh(v / v_s); that of robots at once, or over a way
on which bristles bend. By how much of these differences, nobody knows: no effect of the catalogue,
and no nuisance parameter that is small."""
GEARED, TOLD_LATE, GIVING = "speed_ratio", "speed_told_late", "stiff_belt"
"""Of motors whose speed is logged beside that of their joints, which shows what no other residual
does: a share of it, the time between both sensors' samples, and belts and gears as stiff as they
are, which give a little."""
SPEEDS = (GEARED, TOLD_LATE, GIVING)
OF_SPEED = 0.003
"""Of the joints' speed: cords run on their own thickness, linkages off their drawing (assumed)."""
STIFF, GIVES = 60.0, 0.001
"""Frequency of a rotor on a belt that nobody calls soft [Hz], and angle at a joint by which one
gives under all of its torque [rad]; the softer of both is usual."""
SOLE, SOLE_GIVES = "sole_height", "sole_gives"
"""Where under a pad the ground's force acts, as soles wear, and give under load."""
FORCES_LATE, TORQUES_LATE = "contact_told_late", "torque_told_late"
"""How late forces and torques are told, or early."""
STEPPED, OF_STEPPED = "friction_stepped", 0.5
"""Friction as simulators step it, the damping f(v) / v of a tick's speed times the next one's, less
friction as it is; a share of it."""
FILTERED, OF_FILTER = "speed_filtered", 0.0015
"""How late controllers take speeds for their damping [s]: drives filter them at 50-200 Hz, or
difference positions (assumed)."""
SOLES = 0.004
"""[m] (assumed)."""
UNLISTED = (*SPEEDS, SOLE, SOLE_GIVES, FORCES_LATE, FORCES_SCALED, TORQUES_LATE, STEPPED, FILTERED)
"""Usual errors that are no effects of the catalogue, each with one parameter."""
WAYS = (0.0015, 0.006)
"""On which it turns over, half of each [rad]; assumed, beside that of `effects.friction`."""
SWINGS, OF_SWING = (0.5, 2.0), 0.7
"""Other amplitudes of chatter over those that a log shows at its rate; share of the difference in
friction (assumed)."""
AT_ONCE, OF_WAY = 1.0, 0.3
"""Share of the model's friction that turns over at once, and on each of these ways."""


@dataclass(frozen=True)
class NuisanceParameter:
    """One nuisance parameter."""

    effect: str
    location: str
    parameter: int
    spread: float
    """Standard deviation from the null, in the parameter's unit."""

    @property
    def name(self) -> str:
        """For people."""
        if self.effect in UNLISTED:
            return f"{self.effect} at {self.location}"
        parameter = (
            "share"
            if self.effect in (TURNOVER, SWUNG)
            else EFFECTS[self.effect].parameters[self.parameter].name
        )
        return f"{self.effect} at {self.location}: {parameter}"


def nuisance_parameters(
    subject: Subject, step: float, calibrated: bool = False
) -> list[NuisanceParameter]:
    """Nuisance parameters of a robot.

    Args:
        subject: the robot.
        step: of its logs [s].
        calibrated: whether reference logs tell of friction that the model does not have, which
            turns over as the model's does.
    """
    strength, inertia = joint_strength(subject), joint_inertia(subject)
    found: list[NuisanceParameter] = []
    for j, joint in enumerate(subject.joints):
        if subject.coulomb[j] > 0:
            found += [
                NuisanceParameter(TURNOVER, joint, i, OF_WAY if i else AT_ONCE)
                for i in range(1 + len(WAYS))
            ]
            found += [NuisanceParameter(SWUNG, joint, i, OF_SWING) for i in range(len(SWINGS))]
        elif calibrated:  # what is calibrated turns over at once already
            found += [NuisanceParameter(TURNOVER, joint, 1 + i, OF_WAY) for i in range(len(WAYS))]
        coulomb = COULOMB * subject.coulomb[j] + COULOMB_LEAST * strength[j]
        found += [
            NuisanceParameter("coulomb_friction", joint, 0, coulomb),
            NuisanceParameter(
                "viscous_friction",
                joint,
                0,
                VISCOUS * subject.viscous[j] + VISCOUS_LEAST * strength[j],
            ),
            NuisanceParameter(
                "stribeck_friction",
                joint,
                0,
                BREAKAWAY * subject.coulomb[j] + 0.3 * COULOMB_LEAST * strength[j],
            ),
            NuisanceParameter("load_dependent_friction", joint, 0, LOAD_FRICTION),
            NuisanceParameter("encoder_offset", joint, 0, OFFSET),
            NuisanceParameter("joint_spring", joint, 0, SPRING * strength[j]),
            NuisanceParameter("joint_spring", joint, 1, TORQUE_OFFSET * strength[j]),
            NuisanceParameter("controller_gain", joint, 0, GAIN),
            NuisanceParameter("controller_gain", joint, 1, GAIN),
        ]
    late, driven = LATE + LATE_TICKS * step, set(driven_motors(subject))
    found += [
        NuisanceParameter(effect, "robot", 0, late)
        for effect in ("command_delay", TORQUES_LATE, FORCES_LATE)
    ]
    found += [
        NuisanceParameter(STEPPED, "robot", 0, OF_STEPPED),
        NuisanceParameter(FILTERED, "robot", 0, OF_FILTER),
    ]
    found += [
        NuisanceParameter(effect, foot, 0, SOLES)
        for foot in subject.feet
        for effect in (SOLE, SOLE_GIVES)
    ]
    found += [NuisanceParameter(FORCES_SCALED, foot, 0, OF_FORCES) for foot in subject.feet]
    for m, motor in enumerate(subject.motors):
        column = np.abs(subject.joint_from_motor[:, m])
        main = int(np.argmax(column))
        rotor = (
            ROTOR * subject.rotor_inertia[m]
            + OWN_INERTIA * inertia[main] / max(float(column[main]), 1e-9) ** 2
        )
        found += [
            NuisanceParameter("torque_constant", motor, 0, TORQUE_CONSTANT),
            NuisanceParameter("torque_constant", motor, READING, CURRENT),
            NuisanceParameter("rotor_inertia", motor, 0, rotor),
            NuisanceParameter("actuator_bandwidth", motor, 0, 0.5 * late),
            NuisanceParameter(GEARED, motor, 0, OF_SPEED),
            NuisanceParameter(TOLD_LATE, motor, 0, late),
        ]
        if motor in driven:
            found.append(NuisanceParameter(GIVING, motor, 0, _give(subject, m)))
    for link in EFFECTS["link_mass"].locations(subject):
        own = subject.tree.link_inertial[subject.tree.link(link)]
        arm = max(float(np.linalg.norm(own[1:4] / own[0])), SHORTEST)
        found.append(NuisanceParameter("link_mass", link, 0, MASS * own[0]))
        found += [NuisanceParameter("link_com", link, axis, CENTRE * arm) for axis in range(3)]
    if subject.floating:
        found += [
            NuisanceParameter("imu_bias", "imu", i, GYRO if i < 3 else ACCELEROMETER)
            for i in range(6)
        ]
        for foot in subject.feet:
            found += [
                NuisanceParameter("ground_friction", foot, 0, GROUND),
                NuisanceParameter("ground_compliance", foot, 0, BEARING),
            ]
            found.append(NuisanceParameter("ground_compliance", foot, 1, BEARING))
    places = {name: set(one.locations(subject)) for name, one in EFFECTS.items()}
    places |= {name: set(subject.feet) for name in (SOLE, SOLE_GIVES, FORCES_SCALED)}
    places |= {name: {ROBOT} for name in (FORCES_LATE, TORQUES_LATE, STEPPED, FILTERED)}
    places |= {name: set(subject.joints) for name in (TURNOVER, SWUNG)} | dict.fromkeys(
        SPEEDS, driven
    )
    return [one for one in found if one.location in places[one.effect] and one.spread > 0]


def traces(
    signals: Signals, errors: Sequence[NuisanceParameter], calibrated: bool = False
) -> list[dict[str, np.ndarray]]:
    """Trace of each error at one spread from its null, by residual `(t, columns)`.

    Torque constants scale the torque that the motion needs, not the measured one, and so do gains
    where nobody measured any: else all of them together could scale the noise away, masses and
    loads along with it, which no motion contradicts. So does friction under load where the model
    has none and reference logs calibrate it: else its share of a torque that is mostly friction
    explains all of it.
    """
    needed = np.asarray(signals.rigid @ signals.subject.motor_from_joint.T)
    modelled = replace(
        signals, believed=np.where(np.isfinite(needed), needed, signals.believed), target=None
    )
    steered = _steered(signals)
    bare = {
        joint
        for joint, coulomb in zip(signals.subject.joints, signals.subject.coulomb, strict=True)
        if calibrated and not coulomb
    }
    found = []
    for one in errors:
        if one.effect in (TURNOVER, SWUNG):
            trace = (_turnover if one.effect == TURNOVER else _swung)(
                signals, one.location, one.parameter
            )
            found.append({b: v * one.spread for b, v in trace.items()})
            continue
        if one.effect in UNLISTED:
            alone = {STEPPED: _stepped, FILTERED: _filtered}.get(
                one.effect, _speeds if one.effect in SPEEDS else _told
            )
            found.append(alone(signals, one))
            continue
        effect = EFFECTS[one.effect]
        if one.effect == "torque_constant" and one.parameter == READING:
            found.append(_read(signals, one.location, one.spread))
            continue
        values = effect.nulls
        low, high = effect.bounds(one.location, signals.subject)[:, one.parameter]
        sign = 1.0 if values[one.parameter] + one.spread <= high else -1.0
        values[one.parameter] = np.clip(values[one.parameter] + sign * one.spread, low, high)
        source = {"torque_constant": modelled, "controller_gain": steered}.get(one.effect, signals)
        if one.effect == "load_dependent_friction" and one.location in bare:
            source = modelled
        moved = (values[one.parameter] - effect.nulls[one.parameter]) / one.spread
        found.append(
            {b: v[0] / moved for b, v in effect.trace(source, one.location, values[None]).items()}
            if moved
            else {}
        )
    return found


def _steered(signals: Signals) -> Signals:
    """With targets by which the controllers would ask for just what the motion needs, where its
    residual rests on them alone.
    """
    if signals.target is None or signals.measured is not None or "control" in signals.residual:
        return signals
    stiffness, damping = signals.subject.gains.T
    with np.errstate(divide="ignore", invalid="ignore"):
        target = signals.position + (signals.rigid + damping * signals.velocity) / stiffness
    return replace(signals, target=np.where(np.isfinite(target), target, signals.target))


def _read(signals: Signals, motor: str, share: float) -> dict[str, np.ndarray]:
    """A share of what a motor was asked for, where it is also measured."""
    place = signals.subject.motors.index(motor)
    if signals.measured is None or "drive" not in signals.residual:
        return {}
    rows = np.zeros_like(signals.measured)
    rows[:, place] = share * (signals.measured - signals.residual["drive"])[:, place]
    return {"drive": rows}


def _give(subject: Subject, motor: int) -> float:
    """Compliance of a belt or gear as they are, on the motor's side [rad/Nm]."""
    inertia = float(subject.rotor_inertia[motor])
    of_belt = 1 / (inertia * (2 * np.pi * STIFF) ** 2) if inertia > 0 else 0.0
    of_gear = (
        GIVES
        * float(np.abs(subject.joint_from_motor[:, motor]).max())
        / motor_strength(subject, motor)
    )
    return max(of_belt, of_gear)


def _speeds(signals: Signals, one: NuisanceParameter) -> dict[str, np.ndarray]:
    """Usual errors of a motor's speed beside its joints'."""
    if "transmission" not in signals.residual:
        return {}
    subject = signals.subject
    motor = subject.motors.index(one.location)
    if one.effect == GEARED:
        speed = motor_velocity(signals, motor)
    elif one.effect == TOLD_LATE:
        speed = -signals.acceleration @ subject.joint_from_motor[:, motor]
    else:
        speed = first_derivative(belt.transmitted(signals, motor), signals.step)
    return {
        residual_name: rows[0]
        for residual_name, rows in turned(signals, motor, one.spread * speed[None]).items()
    }


def _stepped(signals: Signals, one: NuisanceParameter) -> dict[str, np.ndarray]:
    """Friction as simulators step it, less friction at once."""
    subject, half = signals.subject, signals.acceleration * signals.step / 2
    damping = friction_damping(
        subject.coulomb,
        np.zeros_like(subject.coulomb),
        signals.velocity - half,
        subject.friction_speed,
    )
    smooth = subject.coulomb * friction.turned(signals.velocity, subject.friction_speed)
    return {"motion": one.spread * (damping * (signals.velocity + half) - smooth)}


def _filtered(signals: Signals, one: NuisanceParameter) -> dict[str, np.ndarray]:
    """What speeds that controllers know late make them ask for; a motor's own back-EMF is never
    late.
    """
    subject = signals.subject
    damping = np.where(
        subject.passive | ~np.isfinite(subject.gains).all(1), 0.0, subject.gains[:, 1]
    )
    asked = applied(subject.motor_from_joint, one.spread * damping * signals.acceleration)
    control, changes = np.zeros_like(asked), {}
    controlled = [
        is_commanded(signals, m) and not np.isfinite(subject.supply[m])
        for m in range(len(subject.motors))
    ]
    for motor in np.flatnonzero(controlled).tolist():
        if is_logged(signals, motor):
            control[:, motor] = asked[:, motor]
        else:
            changes[motor] = asked[None, :, motor]
    found = {
        residual_name: rows[0]
        for residual_name, rows in before_measurement(signals, changes).items()
    }
    return found | ({"control": control} if "control" in signals.residual else {})


def _told(signals: Signals, one: NuisanceParameter) -> dict[str, np.ndarray]:
    """Usual errors of what is told of forces and torques."""
    subject = signals.subject
    if one.effect == TORQUES_LATE:
        known = signals.measured is not None
        return (
            {"motion": -one.spread * first_derivative(signals.rigid.T, signals.step).T}
            if known
            else {}
        )
    if signals.pad_force is None:
        return {}
    force, rotation = (
        np.nan_to_num(signals.pad_force),
        None if signals.base is None else signals.base.rotation,
    )
    own = np.array([subject.feet[p.foot] == one.location for p in subject.pads])
    if one.effect == FORCES_LATE:
        torque, wrench = (
            -one.spread * first_derivative(values.T, signals.step).T
            for values in pads.contact_torque(subject, signals.position, rotation, force)
        )
    elif one.effect == FORCES_SCALED:
        scaled = one.spread * np.where(own[:, None], force, 0.0)
        torque, wrench = pads.contact_torque(subject, signals.position, rotation, scaled)
    else:
        force = np.where(own[:, None], force, 0.0)
        load = np.maximum(force[..., 2], 0.0)
        share = (
            load / max(float(load[load > 0].mean()), 1e-9)
            if one.effect == SOLE_GIVES and load.any()
            else 1.0
        )
        higher, lower = (
            pads.contact_torque(subject, signals.position, rotation, force, lift)
            for lift in (one.spread * share, 0.0)
        )
        torque, wrench = (a - b for a, b in zip(higher, lower, strict=True))
    return {"motion": torque} | ({"base": wrench} if "base" in signals.residual else {})


def _turnover(signals: Signals, joint: str, way: int) -> dict[str, np.ndarray]:
    """Friction that turns over at once less that of the model as it is; or on a way, less that at
    once.
    """
    subject, rows = signals.subject, np.zeros_like(signals.position)
    j = subject.joints.index(joint)
    at_once = sliding(signals)[:, j]
    swing = None if signals.limit_cycle is None else signals.limit_cycle.speed[:, j]
    turned = friction.turned(signals.velocity[:, j], subject.friction_speed[j], swing)
    shape = stop(signals.position[:, j], WAYS[way - 1]) - at_once if way else at_once - turned
    rows[:, j] = turning(subject)[j] * shape
    return {"motion": rows}


def turning(subject: Subject) -> np.ndarray:
    """Friction whose turning over is a nuisance parameter `(n,)` [Nm]: the model's, or a usual
    error where it has none.
    """
    return np.where(subject.coulomb > 0, subject.coulomb, COULOMB_LEAST * joint_strength(subject))


def _swung(signals: Signals, joint: str, place: int) -> dict[str, np.ndarray]:
    """Friction of the model of a joint that chatters by another amplitude, less that by the one
    that the log shows.
    """
    subject = signals.subject
    j = subject.joints.index(joint)
    if signals.limit_cycle is None or not signals.limit_cycle.speed[:, j].any():
        return {}
    rows, speed, width = (
        np.zeros_like(signals.position),
        signals.velocity[:, j],
        subject.friction_speed[j],
    )
    swing = signals.limit_cycle.speed[:, j]
    rows[:, j] = subject.coulomb[j] * (
        friction.turned(speed, width, SWINGS[place] * swing) - friction.turned(speed, width, swing)
    )
    return {"motion": rows}


def stop(position: np.ndarray, way: float) -> np.ndarray:
    """Prandtl's stop operator of positions `(t,)`: from -1 to 1 on twice a way [rad], starting from
    where it is going first.
    """
    moved = np.diff(position, prepend=position[0]) / way
    far = np.abs(position - position[0]) > way
    state = float(np.sign(position[np.argmax(far)] - position[0])) if far.any() else 0.0
    out = np.empty(len(position))
    for tick, step in enumerate(moved.tolist()):
        state = min(max(state + step, -1.0), 1.0)
        out[tick] = state
    return out


def columns(
    filtered_log: FilteredLog, errors: Sequence[NuisanceParameter], calibrated: bool = False
) -> dict[int, np.ndarray]:
    """Samples of all errors at one spread each, by row `(errors, samples)`."""
    found = {
        row: np.zeros((len(errors), filtered_log.count(row)))
        for row in range(len(filtered_log.rows))
    }
    for place, trace in enumerate(traces(filtered_log.signals, errors, calibrated)):
        for row, one in enumerate(filtered_log.rows):
            if one.residual_name in trace:
                values = trace[one.residual_name][:, one.column]
                if np.any(np.nan_to_num(values) != 0):
                    found[row][place] = filtered_log.sample(row, values[None])[0]
    return found
