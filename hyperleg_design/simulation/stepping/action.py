"""What an environment accepts as actions."""

from __future__ import annotations

import numpy as np

from hyperleg_design.errors import InputError


def checked_action(action: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Check the actions of a policy.

    Args:
        action: as the policy gives them.
        shape: simulations and joints.

    Returns:
        The actions in double precision.

    Raises:
        InputError: wrong shape, or values that are not finite.
    """
    action = np.asarray(action)
    if action.shape != shape:
        raise InputError(
            "policy",
            "action",
            action.shape,
            f"must have the shape {shape}; is the policy made for another robot?",
        )
    if not np.isfinite(action.sum()) and not np.all(np.isfinite(action)):
        bad = np.flatnonzero(~np.isfinite(action).all(1))
        raise InputError(
            "policy",
            "action",
            action[bad[0]].tolist(),
            f"is not finite in {len(bad)} simulations, first in {bad[0]}",
        )
    return action.astype(float)
