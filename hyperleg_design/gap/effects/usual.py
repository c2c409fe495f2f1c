"""How well robots are usually known, as far as several effects share it; assumed."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.effects.strength import joint_strength
from hyperleg_design.gap.model.subject import Subject

LATE, LATE_TICKS = 0.002, 0.15
"""Usual delay between a command or measurement and its row in a log: a time [s], and a share of the
log's step [-] (assumed)."""
COULOMB_LEAST = 0.0008
"""Usual friction of a joint whose model has none, over the torque that the joint is made for [-]
(assumed)."""


def lateness(step: float) -> float:
    """Compute the usual delay of commands and measurements.

    Args:
        step: of the logs [s].

    Returns:
        The delay [s].
    """
    return LATE + LATE_TICKS * step


def least_friction(subject: Subject) -> np.ndarray:
    """Friction that joints usually have beyond their model's `(n,)` [Nm].

    Args:
        subject: the robot.

    Returns:
        The torques `(n,)` [Nm].
    """
    return COULOMB_LEAST * joint_strength(subject)
