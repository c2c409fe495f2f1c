"""How a floating base moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class BaseMotion:
    """How the base moves; of a fixed base, there is none."""

    position: np.ndarray
    """In the world `(t, 3)` [m]; NaN where nobody measured it."""
    rotation: np.ndarray
    """World from base `(t, 3, 3)`."""
    linear_velocity: np.ndarray
    """In the base's frame `(t, 3)` [m/s]; NaN where nobody measured it."""
    angular_velocity: np.ndarray
    """In the base's frame `(t, 3)` [rad/s]."""
    specific_force: np.ndarray
    """Acceleration minus gravity at the base's origin, in the base's frame `(t, 3)` [m/s^2]."""
    angular_acceleration: np.ndarray
    """In the base's frame `(t, 3)` [rad/s^2]."""
