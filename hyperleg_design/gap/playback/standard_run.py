"""A simulated log of a standard motion, with the effects that act in it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from hyperleg_design.gap.logs.columns import columns_of
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.model.machine import machine_of
from hyperleg_design.gap.model.mechanism import quaternion_rotation
from hyperleg_design.gap.model.pads import pad_points
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.playback.plant import Plant
from hyperleg_design.simulation.alteration import Alteration

TICK = 0.005
"""Of the shown logs [s]."""
SUBSTEPS = 4
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


def simulated_log(
    subject: Subject, target: np.ndarray, time: np.ndarray, alterations: Sequence[Alteration]
) -> tuple[np.ndarray, Log]:
    """Simulate a motion that a robot follows, with alterations.

    Args:
        subject: the robot.
        target: of the joints `(t, n)` [rad].
        time: `(t,)` [s].
        alterations: what acts in the simulation beside the nominal robot.

    Returns:
        Joint positions as the encoders tell them `(t, n)` [rad], and the log of the run.
    """
    import mujoco

    plant = Plant(subject, alterations, 1, TICK / SUBSTEPS)
    pose = np.array(plant.model.qpos0[None, :7]) if subject.floating else None
    if pose is not None:
        pose[0, 2] += _lift(plant.model, subject, target[0])
    at_rest = np.zeros((1, len(subject.joints)))
    plant.start(target[:1], at_rest, pose, np.zeros((1, 6)) if subject.floating else None)
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
    recorded = {name: np.array(values) for name, values in rows.items() if values}
    return recorded["position"], _log(subject, target, time, recorded)


def _balance(subject: Subject, pose: np.ndarray, moving: np.ndarray) -> np.ndarray:
    """Correction of the targets by which the biped stays on its feet `(n,)` [rad]; pose `(7,)` and
    velocity `(6,)` as MuJoCo has them.
    """
    w, x, y, z = pose[3:]
    sideways = LATERAL[0] * pose[1] + LATERAL[1] * moving[1]
    pitch = BALANCE[0] * 2 * (w * y - z * x) + BALANCE[1] * moving[4]
    correction = np.zeros(len(subject.joints))
    for place, joint in enumerate(subject.joints):
        side = 1.0 if joint.startswith("left") else -1.0
        if joint.endswith("ankle_pitch"):
            correction[place] = pitch
        elif joint.endswith("hip_roll"):
            correction[place] = side * sideways
        elif joint.endswith("ankle_roll"):
            correction[place] = -side * sideways
    return correction


def _lift(model: Any, subject: Subject, position: np.ndarray) -> float:
    """How far to lift the base so that the lowest pad touches the floor [m]."""
    import mujoco

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
    subject: Subject, target: np.ndarray, time: np.ndarray, recorded: dict[str, np.ndarray]
) -> Log:
    columns: dict[str, np.ndarray] = {}
    for place, joint in enumerate(subject.joints):
        columns[f"position/{joint}"] = recorded["position"][:, place]
        columns[f"velocity/{joint}"] = recorded["velocity"][:, place]
        columns[f"position_target/{joint}"] = target[:, place]
    warmth, columns["battery_voltage"] = _conditions(subject, time)
    for place, motor in enumerate(subject.motors):
        columns[f"motor_torque/{motor}"] = recorded["torque"][:, place]
        columns[f"motor_temperature/{motor}"] = warmth[:, place]
    if subject.floating:
        columns |= _base_columns(subject, time, recorded)
    gains, notes = subject.known_gains, "standard motion, simulated"
    metadata = Metadata(robot=subject.path, base=subject.base, gains=gains, notes=notes)
    return Log("standard motion", time, columns, metadata)


def _conditions(subject: Subject, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Made-up temperature of the motors `(t, m)` [degC] and voltage of the battery `(t,)` [V]."""
    nominal, progress = machine_of(subject).voltage, time / time[-1]
    warmth = np.tile((COLD + (HOT - COLD) * progress)[:, None], (1, len(subject.motors)))
    return warmth, (nominal if np.isfinite(nominal) else NOMINAL_VOLTAGE) * (
        FULL + (EMPTY - FULL) * progress
    )


def _base_columns(
    subject: Subject, time: np.ndarray, recorded: dict[str, np.ndarray]
) -> dict[str, np.ndarray]:
    pose, moving = recorded["pose"], recorded["base_velocity"]
    rotation = quaternion_rotation(pose[:, 3:7])
    acceleration = np.gradient(moving[:, :3], time, axis=0) - subject.gravity
    into = np.einsum("tij,jk->tik", rotation, subject.imu_rotation)
    vectors = {
        "base_position": pose[:, :3],
        "base_velocity": moving[:, :3],
        "gyro": moving[:, 3:] @ subject.imu_rotation,
        "accelerometer": np.einsum("tij,ti->tj", into, acceleration),
    }
    columns = columns_of(vectors, "xyz") | columns_of({"base_orientation": pose[:, 3:7]}, "wxyz")
    for index, pad in enumerate(subject.pads):
        columns |= {
            f"contact_force/{pad.name}_{axis}": recorded["force"][:, 3 * index + i]
            for i, axis in enumerate("xyz")
        }
    return columns
