"""Crossings of play that logged speeds of rotors show: where a rotor runs ahead of its joints from
one end of its dead zone to the other, and later back.

When a rotor crosses follows from small differences of torques, and is hard to foretell. Where its
speed is logged it is seen.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.effects.placing import motor_velocity
from hyperleg_design.gap.effects.series import first_derivative
from hyperleg_design.gap.effects.transmissions.belt import load
from hyperleg_design.gap.logs.sampling import OF_MEDIAN
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.transmission import against_joints
from hyperleg_design.memoized import memoized

FAST = 6.0
"""Speed of a rotor against its joints, over the noise, that a crossing reaches [-] (assumed)."""
WHOLE = 0.5
"""Way over the longest one, from which a rotor crosses the whole dead zone and does not only bounce
[-] (assumed)."""
FEWEST = 2
"""Crossings of a log that tell play: one there and one back."""
LEAST = 0.5
"""Share of a rotor's speed against its joints, squared, that is in whole crossings, at least [-]
(developed: 0.74 to 0.9 where there is play, at most 0.27 where belts only give)."""
AGAIN = 0.2
"""Share of crossings that may go the way of the one before, as a slow one between them was not seen
[-] (assumed)."""
PAUSE = 0.1
"""Time for which a rotor may rest on its way [s] (assumed)."""


@memoized
def crossed(signals: Signals, motor: int) -> np.ndarray | None:
    """Follow a rotor through its dead zone by its logged speed.

    Args:
        signals: a conditioned log, `t` ticks.
        motor: index of the motor.

    Returns:
        Its place over the width of the zone, from -1/2 to 1/2 `(t,)`; None where its speed is not
        logged, or it does not go to and fro between two ends.
    """
    speed = _unusual(signals, motor)
    if speed is None:
        return None
    runs = _runs(speed, round(PAUSE / signals.step))
    ways = np.array([speed[run].sum() for run in runs])
    whole = np.flatnonzero(np.abs(ways) >= WHOLE * np.max(np.abs(ways), initial=0.0))
    signs = np.sign(ways[whole])
    other = np.append(True, signs[1:] != signs[:-1])
    within = sum(float(speed[runs[number]] @ speed[runs[number]]) for number in whole.tolist())
    if other.sum() < FEWEST or np.mean(~other) > AGAIN or within < LEAST * float(speed @ speed):
        return None
    moved = np.zeros(len(speed))
    for number, sign in zip(whole[other].tolist(), signs[other].tolist(), strict=True):
        moved[runs[number]] = sign * speed[runs[number]] / ways[number]
    return np.asarray(np.cumsum(moved) - 0.5 * signs[0])


def _unusual(signals: Signals, motor: int) -> np.ndarray | None:
    """Speed of a rotor against its joints `(t,)` [rad/s], without what goes with the speed of these
    (a ratio that is off) or with the rate of their torque (a belt that gives).
    """
    logged = against_joints(signals, motor)
    if logged is None:
        return None
    speed = np.nan_to_num(logged)
    rate = first_derivative(load(signals, motor), signals.step)
    usual = np.nan_to_num(np.stack([motor_velocity(signals, motor), rate], 1))
    share, *_ = np.linalg.lstsq(usual, speed, rcond=None)
    return np.asarray(speed - usual @ share)


def _runs(speed: np.ndarray, pause: int) -> list[slice]:
    """Stretches of one sign in which a speed is fast; such of the same sign are one unless more
    ticks than a pause lie between.
    """
    noise = OF_MEDIAN * float(np.median(np.abs(speed)))
    signs = np.where(np.abs(speed) > noise, np.sign(speed), 0.0)
    edges = np.flatnonzero(np.diff(signs, prepend=0.0, append=0.0))
    runs: list[slice] = []
    for start, stop in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        if np.max(np.abs(speed[start:stop])) <= FAST * noise:
            continue
        if runs and signs[start] == signs[runs[-1].start] and start - runs[-1].stop <= pause:
            runs[-1] = slice(runs[-1].start, stop)
        else:
            runs.append(slice(start, stop))
    return runs
