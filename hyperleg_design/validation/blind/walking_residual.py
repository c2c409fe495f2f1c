"""How far an effect shows in the logs of a robot on its feet."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.mjcf import mujoco_model
from hyperleg_design.robot.models import rigid_body_model
from hyperleg_design.validation.blind.plants.walking import pad_names
from hyperleg_design.validation.blind.residual import CUTOFF, EDGE, SLOW, SOFT, multiple
from hyperleg_design.validation.blind.robots.chain import Chain
from hyperleg_design.validation.blind.walking_record import ESTIMATE


def shown(effect: str, with_effect: Sequence[Log], clean: Sequence[Log], robot: Chain) -> float:
    """Compute how many times over the floor an effect shows.

    It shows in the residuals, or, of the ground, in where the base stands and how pads are loaded.

    Args:
        effect: its identifier.
        with_effect: logs of runs with it.
        clean: logs of the same runs without.
        robot: chain of the robot.

    Returns:
        Multiple of the floor [-].
    """
    if effect in ("ground_friction", "ground_compliance"):
        levels = []
        for kind, noise in (
            ("base_position", 2 * ESTIMATE[0]),
            ("base_orientation", 2 * ESTIMATE[1]),
        ):
            for a in "wxyz" if kind == "base_orientation" else "xyz":
                gaps = [
                    np.interp(c.time, w.time, w.column(f"{kind}/{a}")) - c.column(f"{kind}/{a}")
                    for w, c in zip(with_effect, clean, strict=True)
                ]
                levels.append(np.sqrt(np.mean(np.concatenate(gaps) ** 2)) / noise / 3.0)
        return float(max(levels))
    ours = [walking_residual(w, robot) for w in with_effect]
    theirs = [walking_residual(c, robot) for c in clean]
    lengths = [min(len(a), len(b)) for a, b in zip(ours, theirs, strict=True)]
    return multiple(
        [a[:k] for a, k in zip(ours, lengths, strict=True)],
        [b[:k] for b, k in zip(theirs, lengths, strict=True)],
    )


@cache
def _nominal() -> tuple[Any, list[tuple[str, str, np.ndarray]]]:
    """Pinocchio model with a free base, and the pads: name, link and place in the link `(3,)`."""
    design = load_design("hyperleg")
    model = mujoco_model(design)
    pads = [
        (p, model.body(int(model.geom(p).bodyid[0])).name, model.geom(p).pos.copy())
        for p in pad_names(model)
    ]
    return rigid_body_model(design), pads


def walking_residual(log: Log, robot: Chain) -> np.ndarray:
    """Compute what the nominal model leaves over, filtered.

    Args:
        log: of a robot on its feet.
        robot: its chain.

    Returns:
        Base, joints and drives `(t, 6 + n + m)` [N, Nm]; NaN where a joint may stick.
    """
    import pinocchio as pin
    from scipy.signal import butter, sosfiltfilt

    rigid, pads = _nominal()
    step = float(np.median(np.diff(log.time)))
    time = np.arange(log.time[0], log.time[-1], step)
    sos = butter(2, min(CUTOFF * 2 * step, 0.8), output="sos")

    def even(kind: str, names: Sequence[str]) -> np.ndarray:
        return np.stack([np.interp(time, log.time, log.column(f"{kind}/{n}")) for n in names], -1)

    def smooth(values: np.ndarray) -> np.ndarray:
        return np.asarray(sosfiltfilt(sos, values, axis=0))

    raw = even("position", robot.joints)
    position = smooth(raw)
    turning = smooth(even("gyro", "xyz"))
    force = smooth(even("accelerometer", "xyz"))
    velocity = smooth(np.gradient(position, step, axis=0))
    acceleration = smooth(np.gradient(velocity, step, axis=0))
    spin = np.gradient(turning, step, axis=0)
    quaternion = smooth(even("base_orientation", "wxyz"))
    measured = even("motor_torque", robot.motors)
    loads = smooth(even("contact_force", [f"{p}_{a}" for p, *_ in pads for a in "xyz"])).reshape(
        len(time), len(pads), 3
    )
    links = list(dict.fromkeys(link for _, link, _ in pads))
    gravity = rigid.model.gravity.linear.copy()
    needed = np.empty((len(time), 6 + len(robot.joints)))
    try:
        # the accelerometer's specific force has gravity in it
        rigid.model.gravity.linear = np.zeros(3)
        for k in range(len(time)):
            w, x, y, z = quaternion[k] / np.linalg.norm(quaternion[k])
            world = pin.Quaternion(w, x, y, z).toRotationMatrix()
            q = np.concatenate([np.zeros(3), [0, 0, 0, 1], position[k]])
            row = rigid.inverse_dynamics(
                q,
                np.concatenate([np.zeros(3), turning[k], velocity[k]]),
                np.concatenate([force[k], spin[k], acceleration[k]]),
            )
            for link in links:
                jacobian = rigid.frame_jacobian(q, link)
                frame = rigid.data.oMf[rigid.model.getFrameId(link)].rotation
                for number, (_, owner, place) in enumerate(pads):
                    if owner == link:
                        push = world.T @ loads[k, number]
                        row = row - jacobian.T @ np.concatenate(
                            [push, np.cross(frame @ place, push)]
                        )
            needed[k] = row
    finally:
        rigid.model.gravity.linear = gravity
    slow = np.abs(velocity) < SLOW
    joints = (
        measured @ robot.joint_from_motor.T
        - needed[:, 6:]
        - robot.coulomb * np.tanh(velocity / SOFT)
        - robot.viscous * velocity
    )
    asked = (
        robot.stiffness * (even("position_target", robot.joints) - raw)
        - robot.damping * even("velocity", robot.joints)
    ) @ np.linalg.pinv(robot.joint_from_motor).T
    rows = [
        smooth(-needed[:, :6]),
        np.where(slow, np.nan, smooth(joints)),
        smooth(measured - asked),
    ]
    cut = round(EDGE / step)
    return np.concatenate(rows, -1)[cut:-cut]
