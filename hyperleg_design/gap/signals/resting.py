"""Where joints rest, or may stick, and which ticks of their motion count."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.sliding import presliding, shaken, sliding

LEAST_MOVING = 0.08
"""Share of known ticks in which a joint moves from which its rest is left out."""
SELDOM, STRETCH = 0.25, 0.2
"""Share of known ticks in which a joint with dry friction moves up to which only stretches as long
as this count [s]."""
STILL, AROUND = 0.06, 0.02
"""Time over which a joint that moves less than its friction takes to turn over may stick, and time
around it that is left out [s]."""
CREEP, ASTRAY = 0.1, 0.5
"""Speed below which friction may be smaller than it is in motion [rad/s], unless the joint follows
its target to this share."""
UNDERWAY = 30.0
"""Way without rest or return from which friction is that of motion, over that on which it turns
over (assumed)."""


def moving(known: np.ndarray, resting: np.ndarray, step: float, *, rubs: bool) -> np.ndarray:
    """Choose the known ticks at which a joint does not rest.

    The rest of a joint that hardly moves counts, too, unless it has dry friction (`rubs`). Then
    only long stretches of its motion count, because what smoothing leaves of jerks is no noise any
    more where the moments between them are cut out.

    Args:
        known: ticks at which the residual is known, `(t,)`.
        resting: ticks at which the joint rests, `(t,)`.
        step: between ticks [s].
        rubs: whether the joint has dry friction.

    Returns:
        The ticks that count, `(t,)`.
    """
    moves = known & ~resting
    if moves.sum() > (SELDOM if rubs else LEAST_MOVING) * known.sum():
        return moves
    if not rubs:
        return known
    long = np.zeros_like(moves)
    for part in stretches(moves, STRETCH / step):
        long[part] = True
    return long


def stretches(mask: np.ndarray, shortest: float) -> list[slice]:
    """Find the unbroken stretches of a mask that are long enough.

    Args:
        mask: `(t,)`.
        shortest: length of a stretch at least [ticks].

    Returns:
        Slices of ticks.
    """
    ends = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    return [slice(a, b) for a, b in ends.reshape(-1, 2).tolist() if b - a >= shortest]


def rubbing(signals: Signals) -> np.ndarray:
    """Find the joints with dry friction: of the model, and any whose torque is told by targets or
    commands alone, which at rest are whatever its friction lets stand. Few files tell the friction
    of a servo.

    Args:
        signals: conditioned log.

    Returns:
        `(n,)`.
    """
    subject = signals.subject
    return np.asarray((subject.coulomb > 0) | ((signals.measured is None) & ~subject.passive))


def moving_ticks(signals: Signals, known: np.ndarray, resting: np.ndarray) -> np.ndarray:
    """Choose the ticks that count for all joints, as `moving` does for one.

    Args:
        signals: conditioned log.
        known: `(t, n)`.
        resting: `(t, n)`.

    Returns:
        `(t, n)`.
    """
    joints = zip(known.T, resting.T, rubbing(signals).tolist(), strict=True)
    return np.stack([moving(k, r, signals.step, rubs=dry) for k, r, dry in joints], -1)


def travelled(position: np.ndarray, still: np.ndarray) -> np.ndarray:
    """Compute the way of joints since they last stood still or turned back.

    Args:
        position: [rad], `(t, n)`.
        still: ticks at which each joint stands still, `(t, n)`.

    Returns:
        The way [rad], `(t, n)`.
    """
    step = np.diff(position, axis=0, prepend=position[:1])
    turned = np.zeros_like(still)
    turned[1:] = step[1:] * step[:-1] < 0
    ticks = np.arange(len(position))[:, None]
    last = np.maximum.accumulate(np.where(still | turned, ticks, 0), 0)
    return np.asarray(position - np.take_along_axis(position, last, 0))


def sticking(signals: Signals) -> np.ndarray:
    """Find the ticks at which a joint may stick, or another one in its row, so that its friction is
    whatever the other torques ask for.

    Args:
        signals: a conditioned log.

    Returns:
        `(t, n)`.
    """
    from scipy.ndimage import maximum_filter1d, minimum_filter1d, uniform_filter1d

    span = max(round(STILL / signals.step), 2)
    moved = maximum_filter1d(signals.position, span, axis=0) - minimum_filter1d(
        signals.position, span, axis=0
    )
    still = moved < 2 * presliding(signals)
    if signals.behind_gears is not None:
        # a sensor behind the gear shows at once that friction changes its way, long before the way
        # of sliding has turned over
        still |= signals.behind_gears & (signals.velocity * sliding(signals) < 0)
    still &= ~shaken(signals)
    if signals.target is not None:
        target = uniform_filter1d(signals.target, span, axis=0, mode="nearest")
        ahead = np.gradient(target, signals.step, axis=0)
        led = np.abs(signals.velocity - ahead) <= ASTRAY * np.abs(ahead)
        # without a measured torque, whatever a servo's firmware does while it slows down would look
        # like friction
        creeps = (np.abs(signals.velocity) < CREEP) & ~led & np.isfinite(ahead) & ~shaken(signals)
        if signals.measured is not None:
            way = np.abs(travelled(signals.position, still))
            creeps &= way < UNDERWAY * presliding(signals)
        still |= creeps
    around = 2 * round(AROUND / signals.step) + 1
    resting = np.asarray(maximum_filter1d(still.astype(np.uint8), around, axis=0) > 0)
    return resting if signals.elimination is None else signals.elimination.anywhere(resting)
