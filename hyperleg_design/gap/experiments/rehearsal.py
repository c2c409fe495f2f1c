"""A planned motion rehearsed on the nominal model: what a log of it would hold if nothing were
wrong.

Where all gains are known the closed loop is simulated, drives off where the plan says so; else the
robot is taken to follow exactly, with the torque that inverse dynamics asks for.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.experiments.rig_room import followed
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.model.rig_spec import rig_spec
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.playback.replay import LONGEST_STEP
from hyperleg_design.gap.signals.conditioning import limited_torque


def knows_gains(subject: Subject) -> bool:
    """Decide whether the controller of every driven joint is known.

    Args:
        subject: the robot.

    Returns:
        True if all gains are known.
    """
    return bool(np.isfinite(subject.gains[~subject.passive]).all())


def rehearsed(
    subject: Subject,
    name: str,
    time: np.ndarray,
    target: np.ndarray,
    position: np.ndarray,
    *,
    torque: bool = True,
) -> Log:
    """Simulate the log of a planned motion on the nominal robot, without noise.

    Args:
        subject: with its base fixed.
        name: of the log.
        time: evenly spaced `(t,)` [s].
        target: `(t, n)` [rad]; NaN while the drives are off.
        position: planned motion `(t, n)` [rad], taken where gains are unknown.
        torque: whether the rig measures motor torque or current.

    Returns:
        The log.
    """
    step = float(time[1] - time[0])
    off = np.isnan(target).all(1)
    closed = knows_gains(subject)
    if closed:
        position, velocity, command = closed_loop(subject, step, target, position[0])
    else:
        velocity, needed = followed(subject, position, step)
        command = np.asarray(needed @ subject.motor_from_joint.T)
        command[off] = 0.0
    signals: dict[str, np.ndarray] = {}
    for i, joint in enumerate(subject.joints):
        signals |= {f"position/{joint}": position[:, i], f"velocity/{joint}": velocity[:, i]}
        if closed and not subject.passive[i]:
            signals[f"position_target/{joint}"] = target[:, i]
    for i, motor in enumerate(subject.motors):
        # A closed loop's command follows from targets and gains, as it does where the controller
        # sits in the drives.
        signals[f"motor_torque_command/{motor}"] = (
            np.where(off, 0.0, np.nan) if closed else command[:, i]
        )
        if torque:
            signals[f"motor_torque/{motor}"] = command[:, i]
    notes = "rehearsed on the nominal model"
    metadata = Metadata(robot=subject.path, base="fixed", gains=subject.known_gains, notes=notes)
    return Log(name, time, signals, metadata)


def swung(subject: Subject, start: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Simulate the nominal robot from rest with its drives off.

    Args:
        subject: with its base fixed.
        start: posture [rad], `(n,)`.
        time: of the ticks [s], `(t,)`.

    Returns:
        Positions [rad], `(t, n)`.
    """
    step = float(time[1] - time[0])
    return closed_loop(subject, step, np.full((len(time), len(start)), np.nan), start)[0]


def closed_loop(
    subject: Subject, step: float, target: np.ndarray, start: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Simulate the nominal robot along targets with MuJoCo's own servos; there is no torque where
    targets are unknown.

    Args:
        subject: with its base fixed and all gains known.
        step: between targets [s].
        target: `(t, n)` [rad]; NaN while the drives are off, which is at the end.
        start: posture at rest `(n,)` [rad].

    Returns:
        Positions [rad] and velocities [rad/s], `(t, n)` each, and motor torques [Nm], `(t, m)`.
    """
    import mujoco
    from mujoco import rollout

    substeps = max(int(np.ceil(step / LONGEST_STEP - 1e-9)), 1)
    model = rig_spec(subject, step / substeps).compile()
    driven = np.flatnonzero(~subject.passive)
    off = np.isnan(target).all(1)
    switch = int(np.argmax(off)) if off.any() else len(target)
    data = mujoco.MjData(model)
    data.qpos[:] = start
    state = np.empty(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    rows = [state[None, 1:]]
    for part, on in ((slice(0, switch), True), (slice(switch, len(target)), False)):
        control = np.repeat(np.nan_to_num(target[part][:, driven]), substeps, 0)
        if not len(control):
            continue
        model.opt.disableflags = int(mujoco.mjtDisableBit.mjDSBL_CONTACT) | (
            0 if on else int(mujoco.mjtDisableBit.mjDSBL_ACTUATION)
        )
        states_of_part, _ = rollout.rollout(model, data, state[None], control[None])
        state = states_of_part[0, -1]
        rows.append(states_of_part[0, substeps - 1 :: substeps, 1:])
    states = np.concatenate(rows)[: len(target)]
    position, velocity = states[:, : model.nq], states[:, model.nq : model.nq + model.nv]
    stiffness, damping = np.nan_to_num(subject.gains).T
    asked = stiffness * (np.nan_to_num(target) - position) - damping * velocity
    asked = np.where(off[:, None] | subject.passive, 0.0, asked)
    torque = limited_torque(
        subject, asked @ subject.motor_from_joint.T, velocity @ subject.joint_from_motor
    )
    return position, velocity, torque
