"""Motors against their joints: speeds of rotors, where they are logged, minus those that the
joints' motion gives them.

With encoders on both sides this is the plainest look at what lies between: a ratio, a belt that
gives, play. Whatever else is wrong leaves it alone.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals

FARTHEST = 1.6
"""Ratio of a motor's speed to that of its joints over the model's, or its inverse, from which it is
of another gear or unit."""
LEAST = 0.02
"""Speed of a motor, root mean square, below which its ratio is not asked for [rad/s]."""
SPAN = 0.5
"""Time over which a motor turns as far as its joints, however its belt swings between [s]."""


def transmission_residual(
    subject: Subject, spin: np.ndarray, velocity: np.ndarray, step: float
) -> tuple[np.ndarray, tuple[str, ...]]:
    """Logged speeds of the motors less those of their joints' motion.

    Args:
        subject: the robot.
        spin: logged speed of the motors `(t, m)` [rad/s]; NaN where unknown.
        velocity: of the joints `(t, n)` [rad/s].
        step: of the ticks [s].

    Returns:
        `(t, m)` [rad/s], NaN where unknown; and what was wrong with motors that are left out.
    """
    expected = velocity @ subject.joint_from_motor
    residual = spin - expected
    refused = []
    starts = np.arange(0, len(spin), max(round(SPAN / step), 1))
    for motor, name in enumerate(subject.motors):
        known = np.isfinite(residual[:, motor])
        if not known.any() or np.sqrt(np.mean(expected[known, motor] ** 2)) < LEAST:
            continue
        own, turns = (
            np.add.reduceat(np.where(known, x[:, motor], 0.0), starts) for x in (expected, spin)
        )
        ratio = float(own @ turns / (own @ own))
        if not 1 / FARTHEST < ratio < FARTHEST:
            residual[:, motor] = np.nan
            reason = (
                f"{ratio:.3g} times what its joints' motion gives: of another gear, unit or "
                f"sign than the model's, not used"
            )
            refused.append(f"motor_velocity of {name} is {reason}")
    return residual, tuple(refused)


def turned(signals: Signals, motor: int, speed: np.ndarray) -> dict[str, np.ndarray]:
    """Compute the trace of a motor that turns by some speed beyond its joints.

    Args:
        signals: conditioned log.
        motor: index of the motor.
        speed: [rad/s], `(k, t)`.

    Returns:
        The trace by residual; empty where no log shows it.
    """
    if "transmission" not in signals.residual:
        return {}
    rows = np.zeros((*speed.shape, len(signals.subject.motors)))
    rows[..., motor] = speed
    return {"transmission": rows}


def against_joints(signals: Signals, motor: int) -> np.ndarray | None:
    """Look up the logged speed of a motor less that of its joints' motion.

    Args:
        signals: conditioned log.
        motor: index of the motor.

    Returns:
        `(t,)` [rad/s], NaN where unknown; None where it is not logged.
    """
    residual = signals.residual.get("transmission")
    if residual is None or not np.isfinite(residual[:, motor]).any():
        return None
    return residual[:, motor]
