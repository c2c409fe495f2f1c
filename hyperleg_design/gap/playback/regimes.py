"""Regimes of a motion: what each joint, motor or foot does at each tick."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.signals.signals import Signals

STILL = 0.05
"""Speed below which a joint stands still [rad/s]; assumed, some times what a position sensor
resolves."""
REVERSAL = 0.1
"""Time around a change of direction in which presliding and play show [s] (assumed)."""


def regimes_of(
    signals: Signals, kind: str, names: tuple[str, ...], load: np.ndarray | None
) -> dict[str, np.ndarray]:
    """Find what each joint, motor or foot does at each tick.

    Args:
        signals: the conditioned log.
        kind: of place, `joint`, `motor` or another.
        names: of the places `(k,)`.
        load: torque that is believed to act `(t, k)` [Nm], if it counts.

    Returns:
        Whether each tick is in a regime `(t, k)`, by the regime's name.
    """
    shape = (len(signals.time), len(names))
    regimes: dict[str, np.ndarray] = {}
    position, velocity = signals.position, signals.velocity
    if kind == "motor":
        matrix = signals.subject.joint_from_motor
        position, velocity = position @ matrix, velocity @ matrix
    moves = kind in ("joint", "motor")
    if moves:
        speed = np.abs(velocity)
        regimes["still"] = speed < STILL
        regimes["forward"], regimes["backward"] = velocity >= STILL, velocity <= -STILL
        moving = np.where(regimes["still"], np.nan, speed)
        regimes["slow"], regimes["fast"] = _halves(moving)
        regimes["reversal"] = _near_reversal(velocity, max(round(REVERSAL / signals.step / 2), 1))
    if load is not None:
        regimes["light load"], regimes["heavy load"] = _halves(np.abs(load))
    if moves:
        regimes["low posture"], regimes["high posture"] = _halves(position)
    if signals.voltage is not None and np.ptp(signals.voltage[np.isfinite(signals.voltage)]) > 0:
        low, high = _halves(signals.voltage[:, None])
        regimes["low voltage"] = np.broadcast_to(low, shape)
        regimes["high voltage"] = np.broadcast_to(high, shape)
    if signals.touching is not None and kind == "joint":
        stance, known = _stance(signals, names)
        regimes["stance"], regimes["swing"] = stance & known, ~stance & known
    return regimes


def _halves(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Ticks below and above the median of each column."""
    middle = np.full(values.shape[1], np.nan)
    some = np.isfinite(values).any(0)
    middle[some] = np.nanmedian(values[:, some], 0)
    return values < middle, values >= middle


def _near_reversal(velocity: np.ndarray, reach: int) -> np.ndarray:
    """Ticks near a change of sign."""
    changes = np.zeros(velocity.shape)
    changes[1:] = np.sign(velocity[1:]) != np.sign(velocity[:-1])
    total = np.concatenate([np.zeros((1, velocity.shape[1])), np.cumsum(changes, 0)])
    index = np.arange(len(velocity))
    low, high = np.maximum(index - reach, 0), np.minimum(index + reach + 1, len(velocity))
    return np.asarray(total[high] - total[low] > 0)


def _stance(signals: Signals, names: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Whether a foot that each joint carries touches `(t, n)`, and whether the joint carries a foot
    `(n,)`.
    """
    subject, touching = signals.subject, signals.touching
    assert touching is not None
    stance, known = np.zeros((len(signals.time), len(names)), bool), np.zeros(len(names), bool)
    for pad in subject.pads:
        chain = subject.tree.chain_to(pad.link)
        stance[:, chain] |= touching[:, pad.foot, None]
        known[chain] = True
    return stance, known
