"""The nominal friction of joints: smoothed Coulomb friction, viscous friction and springs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hyperleg_design.gap.model.subject import Subject


PHASES = 48
"""Of a swing over which friction is averaged."""


def sliding_share(velocity: np.ndarray, width: np.ndarray | float, swing: np.ndarray) -> np.ndarray:
    """Mean of tanh((v + a sin(phi)) / width) over a swing; arguments of one shape, or broadcast
    [rad/s].
    """
    phases = (np.arange(PHASES) + 0.5) * 2 * np.pi / PHASES
    return np.asarray(
        sum(np.tanh((velocity + swing * np.sin(phase)) / width) for phase in phases) / PHASES
    )


def friction_torque(
    subject: Subject, position: np.ndarray, velocity: np.ndarray, swing: np.ndarray | None = None
) -> np.ndarray:
    """Nominal friction and springs that a drive has to overcome `(..., n)` [Nm]; `swing` of
    `limit_cycle.LimitCycle.speed`.
    """
    return np.asarray(
        rubbing_torque(subject, velocity, swing) + subject.spring * (position - subject.spring_rest)
    )


def rubbing_torque(
    subject: Subject, velocity: np.ndarray, swing: np.ndarray | None = None
) -> np.ndarray:
    """Nominal friction alone `(..., n)` [Nm]; arguments as of `friction_torque`."""
    return np.asarray(
        subject.coulomb * turned(velocity, subject.friction_speed, swing)
        + subject.viscous * velocity
    )


def turned(
    velocity: np.ndarray, width: np.ndarray | float, swing: np.ndarray | None = None
) -> np.ndarray:
    """Share of the nominal Coulomb friction at some velocities, from -1 to 1, over a limit cycle's
    swing.
    """
    share = np.tanh(velocity / width)
    if swing is not None and swing.any():
        share = np.where(swing > 0, sliding_share(velocity, width, swing), share)
    return np.asarray(share)
