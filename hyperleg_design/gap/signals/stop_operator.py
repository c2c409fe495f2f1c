"""Prandtl's stop operator: friction that turns over on a way."""

from __future__ import annotations

import numpy as np


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
