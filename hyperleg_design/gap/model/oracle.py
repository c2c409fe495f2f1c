"""Inverse dynamics of a loaded file, checked against MuJoCo's own `mj_inverse` on the whole file.

The two are written independently: MuJoCo composes inertias, this package runs Newton and Euler's
equations on the tree it read. What a reader of files left out or read wrongly shows here at once.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hyperleg_design.gap.model.rigid import inverse_dynamics
from hyperleg_design.gap.model.subject import Subject

STATES = 5
"""Random states that are compared."""
SPEED, ACCELERATION = 1.0, 5.0
"""Largest joint speed [rad/s] and acceleration [rad/s^2] of these states."""
TOLERANCE = 1e-4
"""Largest difference over the largest torque of the robot in these states that passes [-]; both
sides compute in double precision, and inertias of a file are rounded to six digits."""


def disagreements(subject: Subject, whole: Any) -> tuple[str, ...]:
    """Notes of joints whose torques differ from those of MuJoCo.

    Compared are inertia, gravity, velocity terms, viscous friction and springs; contacts, limits,
    equality constraints, actuators and dry friction are off on both sides.

    Args:
        subject: robot read from a file, its base at rest.
        whole: compiled MuJoCo model of the same file, with its tendons.

    Returns:
        One note that names the joints and the largest difference; empty where all agree.
    """
    position, velocity, acceleration = _states(subject)
    own = inverse_dynamics(subject, position, velocity, acceleration)
    own = own + subject.viscous * velocity + subject.spring * (position - subject.spring_rest)
    theirs = mujoco_torques(whole, subject.joints, position, velocity, acceleration)
    difference = np.abs(own - theirs).max(0)
    scale = max(float(np.abs(theirs).max()), float(np.abs(own).max()), 1e-12)
    wrong = np.flatnonzero(difference > TOLERANCE * scale)
    if not len(wrong):
        return ()
    worst = int(wrong[np.argmax(difference[wrong])])
    names = ", ".join(subject.joints[j] for j in wrong[:6]) + (", ..." if len(wrong) > 6 else "")
    return (
        f"torques differ from MuJoCo's inverse dynamics of the whole file at {names}: by up to "
        f"{difference[worst]:.3g} Nm of {np.abs(theirs[:, worst]).max():.3g} Nm at "
        f"{subject.joints[worst]}; the file holds forces that are not read (springs or friction of "
        f"tendons over several joints, gravity compensation, fluid)",
    )


def mujoco_torques(
    model: Any,
    joints: tuple[str, ...],
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
) -> np.ndarray:
    """Torques of `mj_inverse` without constraints, other joints and the base at rest.

    Args:
        model: compiled MuJoCo model; its options come back as they were.
        joints: names `(n,)`.
        position: `(t, n)` [rad].
        velocity: the same [rad/s].
        acceleration: the same [rad/s^2].

    Returns:
        `(t, n)` [Nm].
    """
    import mujoco

    flags = int(model.opt.disableflags)
    model.opt.disableflags = flags | int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    data = mujoco.MjData(model)
    free = model.jnt_qposadr[model.jnt_type == mujoco.mjtJoint.mjJNT_FREE]
    places = np.array([model.joint(name).qposadr[0] for name in joints])
    dofs = np.array([model.joint(name).dofadr[0] for name in joints])
    torque = np.empty(position.shape)
    try:
        for row in range(len(position)):
            mujoco.mj_resetData(model, data)
            for start in free:
                data.qpos[start + 3 : start + 7] = (1.0, 0.0, 0.0, 0.0)
            data.qpos[places], data.qvel[dofs] = position[row], velocity[row]
            data.qacc[dofs] = acceleration[row]
            mujoco.mj_inverse(model, data)
            torque[row] = data.qfrc_inverse[dofs]
    finally:
        model.opt.disableflags = flags
    return torque


def _states(subject: Subject) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(0)
    shape = (STATES, len(subject.joints))
    low = np.where(np.isfinite(subject.position_low), subject.position_low, subject.default - 1)
    high = np.where(np.isfinite(subject.position_high), subject.position_high, subject.default + 1)
    return (
        rng.uniform(low, np.maximum(low, high), shape),
        rng.uniform(-SPEED, SPEED, shape),
        rng.uniform(-ACCELERATION, ACCELERATION, shape),
    )
