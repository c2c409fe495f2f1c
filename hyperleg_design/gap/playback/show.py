"""One effect alone: the trace it leaves in a log of a standard motion, and how the closed loop
moves with and without it.

The standard motion is a chirp on one joint, its base fixed; or, for effects of the ground and of
the inertial sensor, a biped that bends its knees and presses its feet apart. It is simulated with
the effect, conditioned as any log, and the trace set beside the residual. Temperature and battery
voltage, which no simulation here has, are made up as stated below, so that effects which need them
have something to show.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.gap.effects import EFFECTS, effect
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.playback.replay import Plant
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.gap.signals.signals import RESIDUALS

if TYPE_CHECKING:
    from hyperleg_design.gap.effects.effect import Effect
    from hyperleg_design.gap.model.subject import Subject
    from hyperleg_design.gap.signals.signals import Signals
    from hyperleg_design.simulation.alteration import Alteration

TICK = 0.005
"""Of the shown logs [s]."""
SUBSTEPS = 4
DURATION, STANDING = 12.0, 6.0
"""Of the chirp, and of the biped's motion [s]."""
LOWEST, HIGHEST = 0.2, 6.0
"""Of the chirp [Hz]."""
AMPLITUDE = 0.4
"""Of the chirp at its lowest frequency [rad]; it falls as 1 / (1 + f / 2 Hz)."""
KNEE_BEND, SPREAD = 0.15, 0.55
"""Of the biped: bend of its thighs, and of both hips outward [rad]."""
BALANCE = (2.0, 0.3)
"""Ankle angle over tilt and over its rate [-, s]."""
LATERAL = (1.0, 0.2)
"""Hip and ankle roll, mirrored from side to side, over sideways place and speed of the base [rad/m,
rad s/m]."""
COLD, HOT = 25.0, 90.0
"""Made-up temperature of the motors: it rises evenly [degC]."""
FULL, EMPTY = 1.0, 0.8
"""Made-up voltage of the battery over the nominal one: it falls evenly."""
NOMINAL_VOLTAGE = 24.0
"""Made-up, where the model knows none [V]."""
NOTHING = 1e-9
"""Trace that counts as none [Nm, N]."""


@dataclass(frozen=True, eq=False)
class Shown:
    """An effect on the standard motion of `t` ticks."""

    effect: Effect
    robot: str
    location: str
    values: np.ndarray
    """Of the parameters."""
    time: np.ndarray
    """`(t,)` [s]."""
    residual_name: str
    """In which its trace is largest; empty where it leaves none."""
    row: str
    """Joint, motor, axis of the base or foot with the largest trace."""
    unit: str
    """Of the trace."""
    trace: np.ndarray
    """`(t,)`; NaN where unknown."""
    residual: np.ndarray
    """Of the same row in a simulated log with the effect, raw `(t,)`."""
    joint: str
    """Whose motion is shown."""
    position: np.ndarray
    velocity: np.ndarray
    torque: np.ndarray
    """Of that joint in the log with the effect `(t,)` [rad, rad/s, Nm]."""
    target: np.ndarray
    """`(t,)` [rad]."""
    before: np.ndarray
    after: np.ndarray
    """Position that the simulation reaches without and with the effect, as the sensor tells `(t,)`
    [rad]."""

    @property
    def parameters(self) -> dict[str, float]:
        """The values of the effect's parameters by name."""
        return {p.name: float(v) for p, v in zip(self.effect.parameters, self.values, strict=True)}


def effects_table() -> list[dict[str, Any]]:
    """Tabulate the catalogue of effects.

    Returns:
        One entry for each effect: identifier, kind of place, summary, and parameters with
        magnitudes and sources.
    """
    return [
        {
            "effect": one.identifier,
            "where": one.kind,
            "summary": one.summary,
            "parameters": [dataclasses.asdict(p) for p in one.parameters],
        }
        for one in EFFECTS.values()
    ]


def show(
    identifier: str,
    robot: str | None = None,
    *,
    location: str | None = None,
    settings: Sequence[str] = (),
) -> Shown:
    """Show an effect alone.

    Args:
        identifier: of the effect.
        robot: a design, MJCF or URDF; by default one joint on a servo, or the biped for effects
            that need the ground.
        location: where it sits; the first place that it can by default.
        settings: `PARAMETER=VALUE` each; the usual magnitude by default.

    Returns:
        Trace, residual and closed loop with and without the effect.

    Raises:
        InputError: no such effect, place or parameter, or a robot on which it cannot sit.
    """
    one = effect(identifier)
    standing = one.kind in ("foot", "sensor")
    subject = _subject(robot, standing)
    places = one.locations(subject)
    if location is None:
        if not places:
            raise InputError(
                identifier,
                "robot",
                subject.name,
                f"has no {one.kind} for it; choose another --robot",
            )
        location = places[-1] if one.kind == "link" and not standing else places[0]
    location = one.place(location, subject)
    values = _values(one, location, subject, settings)
    joint = _joint(subject, location)
    time = np.arange(round((STANDING if standing else DURATION) / TICK) + 1) * TICK
    target = _stand_targets(subject, time) if standing else _chirp(subject, joint, time)
    before, _ = _simulated(subject, target, time, ())
    after, log = _simulated(subject, target, time, (one.alteration(location, values, subject),))
    signals = condition(_told(one, log, values), subject)
    residual_name, row, unit, trace, residual = _largest(
        one.trace(signals, location, values[None]), signals
    )
    return Shown(
        effect=one,
        robot=subject.name,
        location=location,
        values=values,
        time=signals.time,
        residual_name=residual_name,
        row=row,
        unit=unit,
        trace=trace,
        residual=residual,
        joint=subject.joints[joint],
        position=signals.position[:, joint],
        velocity=signals.velocity[:, joint],
        torque=(signals.believed @ subject.joint_from_motor.T)[:, joint],
        target=target[:, joint],
        before=before[:, joint],
        after=after[:, joint],
    )


def _subject(robot: str | None, standing: bool) -> Subject:
    name = robot or (
        "hyperleg" if standing else str(resources.content_folder("sim") / "servo_rig.xml")
    )
    subject = load_subject(name)
    if subject.floating == standing:
        return subject
    blank = np.zeros(2)
    joints = {f"position/{name}": blank for name in subject.joints}
    base = Log(
        "standard motion",
        np.array([0.0, 1.0]),
        joints,
        Metadata(base="floating" if standing else "fixed"),
    )
    return load_subject(name, [base])


def _values(one: Effect, location: str, subject: Subject, settings: Sequence[str]) -> np.ndarray:
    values = one.example(location, subject)
    known = {p.name: i for i, p in enumerate(one.parameters)}
    for setting in settings:
        name, sign, text = setting.partition("=")
        if not sign or name not in known:
            raise InputError(
                "set", name, None, f"expects PARAMETER=VALUE, with one of {', '.join(known)}"
            )
        try:
            values[known[name]] = float(text)
        except ValueError:
            raise InputError("set", name, text, "expects a number") from None
        parameter = one.parameters[known[name]]
        if not parameter.low <= values[known[name]] <= parameter.high:
            raise InputError(
                "set",
                name,
                text,
                f"expects {parameter.low:g} .. {parameter.high:g} {parameter.unit}".rstrip(),
            )
    return values


def _joint(subject: Subject, location: str) -> int:
    """Joint that moves for an effect at a place."""
    if location in subject.joints:
        return subject.joints.index(location)
    if location in subject.motors:
        return int(np.argmax(np.abs(subject.joint_from_motor[:, subject.motors.index(location)])))
    if location in subject.links:
        carrier = int(subject.tree.link_joint[subject.tree.link(location)])
        return max(carrier, 0)
    knees = [i for i, name in enumerate(subject.joints) if "knee" in name]
    return knees[0] if knees else 0


def _chirp(subject: Subject, joint: int, time: np.ndarray) -> np.ndarray:
    """Targets `(t, n)`: one joint sweeps up in frequency about its rest, the others hold."""
    rate = np.log(HIGHEST / LOWEST) / DURATION
    frequency = LOWEST * np.exp(rate * time)
    phase = 2 * np.pi * LOWEST / rate * (np.exp(rate * time) - 1)
    low, high = subject.position_low[joint], subject.position_high[joint]
    centre, amplitude = float(subject.default[joint]), AMPLITUDE
    if np.isfinite(high - low):
        amplitude = min(amplitude, 0.4 * (high - low))
        centre = float(np.clip(centre, low + 1.1 * amplitude, high - 1.1 * amplitude))
    target = np.tile(subject.default, (len(time), 1))
    target[:, joint] = centre + amplitude / (1 + frequency / 2.0) * np.sin(phase)
    return target


def _stand_targets(subject: Subject, time: np.ndarray) -> np.ndarray:
    """Targets `(t, n)` of a biped that bends its knees once in two seconds and pushes its feet
    apart and together.
    """
    target = np.tile(subject.default, (len(time), 1))
    bend = KNEE_BEND * (1 - np.cos(np.pi * time)) / 2
    apart = SPREAD * np.sin(1.3 * np.pi * time)
    shares = {"hip_pitch": -bend, "knee": 2 * bend, "ankle_pitch": -bend}
    for place, joint in enumerate(subject.joints):
        for name, moved in shares.items():
            if joint.endswith(name):
                target[:, place] += moved
        if joint.endswith("hip_roll"):
            target[:, place] += apart
    return target


def _simulated(
    subject: Subject, target: np.ndarray, time: np.ndarray, alterations: Sequence[Alteration]
) -> tuple[np.ndarray, Log]:
    """Joint positions as told `(t, n)`, and the log of the run."""
    import mujoco

    plant = Plant(subject, alterations, 1, TICK / SUBSTEPS, 1)
    pose = np.array(plant.model.qpos0[None, :7]) if subject.floating else None
    if pose is not None:
        pose[0, 2] += _lift(plant.model, subject, target[0])
    plant.start(
        target[:1],
        np.zeros((1, len(subject.joints))),
        pose,
        np.zeros((1, 6)) if subject.floating else None,
    )
    model = plant.batch.get_model(0)
    data = mujoco.MjData(model)
    warmth, battery = _conditions(subject, time)
    ticks, target = len(time), np.array(target)
    onward = np.diff(target, axis=0, append=target[-1:])
    rows: dict[str, list[np.ndarray]] = {
        k: [] for k in ("position", "velocity", "torque", "pose", "base_velocity", "force")
    }
    for tick in range(ticks):
        position, velocity = plant.measured()
        rows["position"].append(position[0].copy())
        rows["velocity"].append(velocity[0].copy())
        rows["pose"].append(plant.qpos[0, :7].copy())
        rows["base_velocity"].append(plant.qvel[0, :6].copy())
        if subject.floating:
            rows["force"].append(_pad_forces(plant, model, data, subject))
            target[tick] += _balance(subject, plant.qpos[0, :7], plant.qvel[0, :6])
        for substep in range(SUBSTEPS):
            # setpoints go on evenly between ticks: held ones would leave a trace of their own
            now = target[tick : tick + 1] + substep / SUBSTEPS * onward[tick]
            driven = plant.step("target", now, warmth[tick : tick + 1], battery[tick : tick + 1])
            if substep == 0:
                # MuJoCo's velocity belongs half a step before its position
                rows["velocity"][-1] = (rows["velocity"][-1] + plant.measured()[1][0]) / 2
                rows["base_velocity"][-1] = (rows["base_velocity"][-1] + plant.qvel[0, :6]) / 2
                rows["torque"].append(driven.believed[0].copy())
    found = {name: np.array(values) for name, values in rows.items() if values}
    return found["position"], _log(subject, target, time, found)


def _balance(subject: Subject, pose: np.ndarray, moving: np.ndarray) -> np.ndarray:
    """Added to the targets so that the biped stays on its feet `(n,)` [rad]; pose `(7,)` and
    velocity `(6,)` as MuJoCo has them.
    """
    w, x, y, z = pose[3:]
    sideways = LATERAL[0] * pose[1] + LATERAL[1] * moving[1]
    pitch = BALANCE[0] * 2 * (w * y - z * x) + BALANCE[1] * moving[4]
    found = np.zeros(len(subject.joints))
    for place, joint in enumerate(subject.joints):
        side = 1.0 if joint.startswith("left") else -1.0
        if joint.endswith("ankle_pitch"):
            found[place] = pitch
        elif joint.endswith("hip_roll"):
            found[place] = side * sideways
        elif joint.endswith("ankle_roll"):
            found[place] = -side * sideways
    return found


def _lift(model: Any, subject: Subject, position: np.ndarray) -> float:
    """How far to lift the base so that the lowest pad touches the floor [m]."""
    import mujoco

    from hyperleg_design.gap.model.rigid import pad_points

    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, model.qpos0[3:7])
    points = pad_points(subject, position[None], rotation.reshape(1, 3, 3))[0]
    return -float((points @ rotation.reshape(3, 3).T)[:, 2].min() + model.qpos0[2])


def _pad_forces(plant: Plant, model: Any, data: Any, subject: Subject) -> np.ndarray:
    """Forces of the floor on each pad, world frame `(3 P,)` [N]; a contact counts for the nearest
    pad of its link.
    """
    import mujoco

    plant.batch.get_model(0, model)  # with the friction that a step writes into it
    plant.batch.get_data(0, data)
    mujoco.mj_forward(model, data)
    total = np.zeros((len(subject.pads), 3))
    wrench = np.zeros(6)
    bodies = np.array([model.body(subject.tree.links[p.link]).id for p in subject.pads])
    places = np.array([p.position for p in subject.pads])
    points = data.xpos[bodies] + np.einsum(
        "pij,pj->pi", data.xmat[bodies].reshape(-1, 3, 3), places
    )
    for index in range(data.ncon):
        contact = data.contact[index]
        for geom, sign in ((int(contact.geom1), -1.0), (int(contact.geom2), 1.0)):
            own = np.flatnonzero(bodies == model.geom_bodyid[geom])
            if len(own):
                mujoco.mj_contactForce(model, data, index, wrench)
                nearest = own[np.argmin(np.linalg.norm(points[own] - contact.pos, axis=1))]
                total[nearest] += sign * (contact.frame.reshape(3, 3).T @ wrench[:3])
    return total.ravel()


def _log(
    subject: Subject, target: np.ndarray, time: np.ndarray, found: dict[str, np.ndarray]
) -> Log:
    columns: dict[str, np.ndarray] = {}
    for place, joint in enumerate(subject.joints):
        columns[f"position/{joint}"], columns[f"velocity/{joint}"] = (
            found["position"][:, place],
            found["velocity"][:, place],
        )
        columns[f"position_target/{joint}"] = target[:, place]
    warmth, columns["battery_voltage"] = _conditions(subject, time)
    for place, motor in enumerate(subject.motors):
        columns[f"motor_torque/{motor}"] = found["torque"][:, place]
        columns[f"motor_temperature/{motor}"] = warmth[:, place]
    if subject.floating:
        columns |= _base_columns(subject, time, found)
    gains = {
        j: (float(k), float(d))
        for j, (k, d) in zip(subject.joints, subject.gains, strict=True)
        if np.isfinite(k + d)
    }
    metadata = Metadata(
        robot=subject.path, base=subject.base, gains=gains, notes="standard motion, simulated"
    )
    return Log("standard motion", time, columns, metadata)


def _conditions(subject: Subject, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Made-up temperature of the motors `(t, m)` [degC] and voltage of the battery `(t,)` [V]."""
    from hyperleg_design.gap.model.machine import machine_of

    nominal, progress = machine_of(subject).voltage, time / time[-1]
    warmth = np.tile((COLD + (HOT - COLD) * progress)[:, None], (1, len(subject.motors)))
    return warmth, (nominal if np.isfinite(nominal) else NOMINAL_VOLTAGE) * (
        FULL + (EMPTY - FULL) * progress
    )


def _base_columns(
    subject: Subject, time: np.ndarray, found: dict[str, np.ndarray]
) -> dict[str, np.ndarray]:
    from hyperleg_design.gap.model.mechanism import quaternion_rotation

    pose, moving = found["pose"], found["base_velocity"]
    rotation = quaternion_rotation(pose[:, 3:7])
    acceleration = np.gradient(moving[:, :3], time, axis=0) - subject.gravity
    into = np.einsum("tij,jk->tik", rotation, subject.imu_rotation)
    named = {
        "base_position": (pose[:, :3], "xyz"),
        "base_orientation": (pose[:, 3:7], "wxyz"),
        "base_velocity": (moving[:, :3], "xyz"),
        "gyro": (moving[:, 3:] @ subject.imu_rotation, "xyz"),
        "accelerometer": (np.einsum("tij,ti->tj", into, acceleration), "xyz"),
    }
    columns = {
        f"{kind}/{axis}": values[:, i]
        for kind, (values, axes) in named.items()
        for i, axis in enumerate(axes)
    }
    for index, pad in enumerate(subject.pads):
        columns |= {
            f"contact_force/{pad.name}_{axis}": found["force"][:, 3 * index + i]
            for i, axis in enumerate("xyz")
        }
    return columns


def _told(one: Effect, log: Log, values: np.ndarray) -> Log:
    """The log as the robot's own inertial sensor would have told it."""
    if one.kind != "sensor":
        return log
    bias = {
        f"{kind}/{axis}": values[3 * k + i]
        for k, kind in enumerate(("gyro", "accelerometer"))
        for i, axis in enumerate("xyz")
    }
    return dataclasses.replace(
        log, signals={name: column + bias.get(name, 0.0) for name, column in log.signals.items()}
    )


def _largest(
    traces: dict[str, np.ndarray], signals: Signals
) -> tuple[str, str, str, np.ndarray, np.ndarray]:
    """The first of the residuals in which there is a trace, its row with the largest, its unit,
    that trace, and the residual.
    """
    subject = signals.subject
    wrench = ("force x", "force y", "force z", "moment x", "moment y", "moment z")
    names = {
        "motion": subject.joints,
        "drive": subject.motors,
        "transmission": subject.motors,
        "base": wrench,
    }
    names["ground"] = tuple(f"{foot} {axis}" for foot in subject.feet for axis in "xyz")
    for residual_name in ("motion", "drive", "ground", "base", "transmission"):
        if residual_name not in traces:
            continue
        rows = np.where(signals.valid[:, None], traces[residual_name][0], np.nan)
        if residual_name == "motion":
            rows = np.where(np.isfinite(signals.residual["motion"]), rows, np.nan)
        size = np.sqrt(np.where(np.isfinite(rows), rows, 0.0) ** 2).mean(0)
        place = int(np.argmax(size))
        if size[place] > NOTHING:
            unit = (
                ("N" if place < 3 else "Nm")
                if residual_name == "base"
                else RESIDUALS[residual_name][1]
            )
            residual = np.where(
                np.isfinite(rows[:, place]), signals.residual[residual_name][:, place], np.nan
            )
            return residual_name, names[residual_name][place], unit, rows[:, place], residual
    unknown = np.full(len(signals.time), np.nan)
    return "", "", "Nm", unknown, unknown
