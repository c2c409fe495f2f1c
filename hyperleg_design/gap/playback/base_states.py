"""States of a floating base, from which predictions start."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.model.pads import pad_points
from hyperleg_design.gap.signals.signals import Signals


def base_states(
    signals: Signals, ticks: np.ndarray, before: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Compute the states of a floating base at some ticks.

    The height is such that the lowest pad touches the ground where it was not measured, and an
    unknown velocity is that of a lowest pad at rest.

    Args:
        signals: conditioned log.
        ticks: their indices, `(w,)`.
        before: time by which the velocities are earlier than the ticks [s].

    Returns:
        Pose `(w, 7)`, and velocity, linear in the world and angular in the base's frame, `(w, 6)`.
    """
    import mujoco

    base, subject = signals.base, signals.subject
    assert base is not None
    rotation = base.rotation[ticks]
    place = base.position[ticks].copy()
    velocity = np.einsum("tij,tj->ti", rotation, base.linear_velocity[ticks])
    if not np.isfinite(place).all():
        points = np.einsum(
            "tij,tpj->tpi", rotation, pad_points(subject, signals.position[ticks], rotation)
        )
        low = points[..., 2].min(1) if points.shape[1] else np.zeros(len(ticks))
        on_ground = np.stack([np.zeros(len(ticks)), np.zeros(len(ticks)), -low], -1)
        place = np.where(np.isfinite(place), place, on_ground)
    if not np.isfinite(velocity).all():
        velocity = np.where(np.isfinite(velocity), velocity, _still_foot_velocity(signals, ticks))
    quaternion = np.zeros((len(ticks), 4))
    for row, matrix in enumerate(rotation):
        mujoco.mju_mat2Quat(quaternion[row], np.ascontiguousarray(matrix).ravel())
    velocity = velocity - before * (
        np.einsum("tij,tj->ti", rotation, base.specific_force[ticks]) + subject.gravity
    )
    spin = base.angular_velocity[ticks] - before * base.angular_acceleration[ticks]
    return np.concatenate([place, quaternion], 1), np.concatenate([velocity, spin], 1)


def _still_foot_velocity(signals: Signals, ticks: np.ndarray) -> np.ndarray:
    """Velocity of the base in the world at which its lowest pad stands still `(w, 3)`."""
    base, subject = signals.base, signals.subject
    assert base is not None
    if not subject.pads:
        return np.zeros((len(ticks), 3))
    before, after = np.maximum(ticks - 1, 0), np.minimum(ticks + 1, len(signals.time) - 1)

    def points(at: np.ndarray) -> np.ndarray:
        rotation = base.rotation[at]
        return np.einsum(
            "tij,tpj->tpi", rotation, pad_points(subject, signals.position[at], rotation)
        )

    lowest = np.argmin(points(ticks)[..., 2], 1)
    change = np.take_along_axis(points(after) - points(before), lowest[:, None, None], 1)[:, 0]
    return np.asarray(-change / (signals.time[after] - signals.time[before])[:, None])
