"""Which simulations a physics step left in a state that means nothing."""

from __future__ import annotations

import numpy as np

FASTEST = 1e4
"""Speed of a coordinate past which a simulation counts as diverged [m/s or rad/s]."""
_BROKEN = slice(1, 6)
"""MuJoCo's warnings that mark a step as wrong: contacts or constraints left out, bad position,
velocity, acceleration."""


def all_sound(position: np.ndarray, velocity: np.ndarray, warnings: np.ndarray) -> bool:
    """Whether all simulations are well; quick, and on the safe side of `broken`.

    Args:
        position: MuJoCo's qpos, `(n, 7 + J)`.
        velocity: MuJoCo's qvel, `(n, 6 + J)`.
        warnings: MuJoCo's warnings, `(n, kinds, 2)`.

    Returns:
        True only where `broken` finds nothing.
    """
    bounded = np.einsum("nj,nj->", velocity, velocity) < FASTEST**2  # false for what is no number
    return bool(
        bounded and np.isfinite(np.einsum("nj->", position)) and not warnings[:, _BROKEN, 1].any()
    )


def broken(position: np.ndarray, velocity: np.ndarray, warnings: np.ndarray) -> dict[int, str]:
    """Find the simulations that went wrong.

    Args:
        position: MuJoCo's qpos, `(n, 7 + J)`.
        velocity: MuJoCo's qvel, `(n, 6 + J)`.
        warnings: MuJoCo's warnings, `(n, kinds, 2)`.

    Returns:
        The reason by simulation, in ascending order.
    """
    with np.errstate(invalid="ignore"):
        moving = np.abs(velocity).max(-1)
    lost = ~np.isfinite(position.sum(-1)) | ~(moving < FASTEST)
    warned = warnings[:, _BROKEN, 1].any(-1)
    return {
        int(i): "speed or position without bounds" if lost[i] else "warning of MuJoCo"
        for i in np.flatnonzero(lost | warned)
    }
