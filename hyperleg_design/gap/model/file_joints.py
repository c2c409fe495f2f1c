"""Joints of a compiled robot file: the single ones, their friction, springs and ranges."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError


def single_joints(model: Any) -> list[int]:
    """List the joints that are hinges or slides.

    Args:
        model: the compiled model.

    Returns:
        Their indices.
    """
    return [int(joint) for joint in _single(model)[0]]


def _single(model: Any) -> tuple[np.ndarray, np.ndarray]:
    """Joints that are hinges or slides, and their velocities."""
    import mujoco

    kinds = mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE
    joints = np.flatnonzero(np.isin(model.jnt_type, kinds))
    return joints, np.asarray(model.jnt_dofadr)[joints]


def refuse_negative(model: Any, path: Path) -> None:
    """Refuse friction, damping and rotors below zero, which MuJoCo compiles and no robot has.

    Args:
        model: the compiled model.
        path: of its file.

    Raises:
        InputError: some joint has one.
    """
    joints, dofs = _single(model)
    for field in ("frictionloss", "damping", "armature"):
        values = getattr(model, f"dof_{field}")[dofs]
        for joint, value in zip(joints.tolist(), values.tolist(), strict=True):
            if value < 0:
                where = f"{model.joint(joint).name}.{field}"
                raise InputError(str(path), where, value, "is negative: give 0 or more")


def friction(model: Any) -> tuple[np.ndarray, np.ndarray]:
    """Read the dry and viscous friction of the joints.

    Args:
        model: the compiled model.

    Returns:
        Dry [Nm] and viscous [Nms/rad], `(n,)` each.
    """
    _, dofs = _single(model)
    return np.array(model.dof_frictionloss[dofs]), np.array(model.dof_damping[dofs])


def springs(model: Any) -> tuple[np.ndarray, np.ndarray]:
    """Read the springs of the joints.

    Args:
        model: the compiled model.

    Returns:
        Stiffness [Nm/rad] and rest position [rad], `(n,)` each.
    """
    joints, _ = _single(model)
    rest = model.qpos_spring[model.jnt_qposadr[joints]]
    return np.array(model.jnt_stiffness[joints]), np.array(rest)


def limits(model: Any) -> tuple[np.ndarray, np.ndarray]:
    """Read the ranges of motion.

    Args:
        model: the compiled model.

    Returns:
        Lower and upper ends [rad], `(n,)` each; infinite where unlimited.
    """
    joints, _ = _single(model)
    limited = np.asarray(model.jnt_limited)[joints].astype(bool)
    low, high = model.jnt_range[joints].T
    return np.where(limited, low, -np.inf), np.where(limited, high, np.inf)


def take_out_friction(model: Any) -> None:
    """Remove joint friction and keep springs: replays put friction in themselves.

    Args:
        model: the compiled model, which is changed.
    """
    model.dof_frictionloss[:] = 0.0
    model.dof_damping[:] = 0.0
