"""Rigid bodies: mass, centre of mass and inertia, batched."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True, eq=False)
class Inertial:
    """Inertial of a link in its own frame (at its joint, axes of the pelvis in the zero
    posture).
    """

    mass: np.ndarray
    """Mass [kg], `(...)`."""
    com: np.ndarray
    """Centre of mass [m] `(..., 3)`."""
    inertia: np.ndarray
    """Inertia about the centre of mass [kg m^2], `(..., 3, 3)`."""


def shifted(mass: Any, offset: np.ndarray) -> np.ndarray:
    """Compute the inertia of a point mass about another point.

    Args:
        mass: `(...)` [kg].
        offset: from the one point to the other, `(..., 3)` [m].

    Returns:
        The inertia, `(..., 3, 3)` [kg m^2].
    """
    squared = np.sum(offset**2, -1)[..., None, None] * np.eye(3)
    return np.asarray(mass)[..., None, None] * (
        squared - offset[..., :, None] * offset[..., None, :]
    )
