"""The nominal friction of joints: smoothed Coulomb friction, viscous friction and springs; and
Prandtl's stop operator, by which friction turns over on a way.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.model.subject import Subject

PHASES = 48
"""Phases of an oscillation over which friction is averaged."""


def sliding_share(velocity: np.ndarray, width: np.ndarray | float, swing: np.ndarray) -> np.ndarray:
    """Compute the mean of tanh((v + a sin(phi)) / width) over a swing.

    Args:
        velocity: v [rad/s], `(...)`.
        width: [rad/s].
        swing: a [rad/s], `(...)`.

    Returns:
        The mean [-], `(...)`.
    """
    phases = (np.arange(PHASES) + 0.5) * 2 * np.pi / PHASES
    return np.asarray(
        sum(np.tanh((velocity + swing * np.sin(phase)) / width) for phase in phases) / PHASES
    )


def friction_torque(
    subject: Subject, position: np.ndarray, velocity: np.ndarray, swing: np.ndarray | None = None
) -> np.ndarray:
    """Compute nominal friction and springs, which a drive has to overcome.

    Args:
        subject: the robot.
        position: [rad], `(..., n)`.
        velocity: [rad/s], `(..., n)`.
        swing: of a limit cycle, `limit_cycle.LimitCycle.speed` [rad/s]; none by default.

    Returns:
        The torque [Nm], `(..., n)`.
    """
    return np.asarray(
        rubbing_torque(subject, velocity, swing) + subject.spring * (position - subject.spring_rest)
    )


def rubbing_torque(
    subject: Subject, velocity: np.ndarray, swing: np.ndarray | None = None
) -> np.ndarray:
    """Compute nominal friction alone.

    Args:
        subject: the robot.
        velocity: [rad/s], `(..., n)`.
        swing: as in `friction_torque`.

    Returns:
        The torque [Nm], `(..., n)`.
    """
    return np.asarray(
        subject.coulomb * turned(velocity, subject.friction_speed, swing)
        + subject.viscous * velocity
    )


def turned(
    velocity: np.ndarray, width: np.ndarray | float, swing: np.ndarray | None = None
) -> np.ndarray:
    """Compute the share of the nominal Coulomb friction that acts at some velocities.

    Args:
        velocity: [rad/s], `(..., n)`.
        width: over which friction turns over [rad/s].
        swing: of a limit cycle [rad/s], over which the mean is taken; none by default.

    Returns:
        The share, -1 .. 1 [-], `(..., n)`.
    """
    share = np.tanh(velocity / width)
    if swing is not None and swing.any():
        share = np.where(swing > 0, sliding_share(velocity, width, swing), share)
    return np.asarray(share)


def stop(position: np.ndarray, way: float) -> np.ndarray:
    """Compute the stop operator of positions: from -1 to 1 on twice a way, starting from where
    they go first.

    Args:
        position: [rad] `(t,)`.
        way: [rad].

    Returns:
        `(t,)`.
    """
    moved = np.diff(position, prepend=position[0]) / way
    far = np.abs(position - position[0]) > way
    state = float(np.sign(position[np.argmax(far)] - position[0])) if far.any() else 0.0
    out = np.empty(len(position))
    for tick, step in enumerate(moved.tolist()):
        state = min(max(state + step, -1.0), 1.0)
        out[tick] = state
    return out
