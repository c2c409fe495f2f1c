"""Torques that another motion than the logged one would need: for effects by which logged positions
are wrong.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.model import pads, rigid
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.memoized import memoized


def needed(
    signals: Signals,
    position: np.ndarray,
    velocity: np.ndarray | None = None,
    acceleration: np.ndarray | None = None,
    *,
    rotors: bool = True,
) -> dict[str, np.ndarray]:
    """Compute the torque that a motion needs, less what contact gives.

    Args:
        signals: a conditioned log; its base moves as logged.
        position: of the joints `(t, n)` [rad].
        velocity: `(t, n)` [rad/s]; as logged by default.
        acceleration: `(t, n)` [rad/s^2]; as logged by default.
        rotors: add the rotors' inertia.

    Returns:
        By residual: joint torques of `motion` `(t, n)` [Nm], and the wrench of the `base` `(t, 6)`
        [N, Nm].
    """
    subject, base = signals.subject, signals.base
    motion = (
        position,
        signals.velocity if velocity is None else velocity,
        signals.acceleration if acceleration is None else acceleration,
    )
    torques = {"motion": rigid.inverse_dynamics(subject, *motion, base, rotors=rotors)}
    if "base" in signals.residual and base is not None:
        torques["base"] = rigid.base_wrench(subject, *motion, base)
    if signals.pushing is not None:
        rotation = None if base is None else base.rotation
        torque, wrench = pads.contact_torque(subject, position, rotation, signals.pushing)
        torques["motion"] = torques["motion"] - torque
        if "base" in torques:
            torques["base"] = torques["base"] - wrench
    return torques


@memoized
def as_logged(signals: Signals) -> dict[str, np.ndarray]:
    """Compute what the logged motion needs, without rotors; all places of an effect share it.

    Args:
        signals: a conditioned log, `t` ticks.

    Returns:
        As of `needed`.
    """
    return needed(signals, signals.position, rotors=False)
