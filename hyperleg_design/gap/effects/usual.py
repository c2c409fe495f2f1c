"""How well robots are usually known, as far as several effects share it; assumed."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.effects.placing import joint_strength
from hyperleg_design.gap.model.subject import Subject

LATE, LATE_TICKS = 0.001, 0.15
"""[s] and ticks of the log, of all drives; one of them lags by half as much beside them."""
COULOMB_LEAST = 0.0008
"""Of the torque that the joint is made for: friction where the model has none."""


def lateness(step: float) -> float:
    """How late what is told usually is [s].

    Args:
        step: of the logs [s].

    Returns:
        The time [s].
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
