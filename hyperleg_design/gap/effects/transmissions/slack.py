"""The play of belts: when motor and joint touch, fly apart and bounce."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.effects.series import band_limited
from hyperleg_design.gap.effects.transmissions.belt import (
    BAND,
    CHOSEN,
    carried,
    frictionless,
    load,
)
from hyperleg_design.gap.effects.transmissions.crossing import crossed
from hyperleg_design.gap.model.machine import rotor
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.sliding import dry_friction
from hyperleg_design.memoized import memoized

RESTITUTION = 0.3
"""Speed after over speed before a rotor hits the end of its dead zone; assumed: gears and cords
under load hardly bounce. Joints, which hit a rotor that is held, do not."""
CROSSING, CROSSING_BAND = 0.8, 0.15
"""c, the load below which a rotor that does not coast is on its way across; band of its crossing,
over the log's rate (assumed)."""


def slack(
    signals: Signals,
    motor: int,
    play: np.ndarray,
    side: np.ndarray,
    coasting: np.ndarray,
    behind: np.ndarray | None = None,
) -> np.ndarray:
    """Compute the position of a rotor in its dead zone, from -play / 2 to play / 2, on its side of
    M `(k, t)` [rad].

    Args:
        signals: a conditioned log.
        motor: place of the motor.
        play: whole width `(k,)` [rad].
        side: on which the positions were logged `(k,)`.
        coasting: from 0, carried over by the load, to 1, moving by itself `(k,)`; a joint, on side
            1, always does.
        behind: share of the friction that acts behind the belt `(k,)`, none by default: on a joint
            that is left behind, and not on a rotor that crosses.
    """
    position = np.zeros((len(play), len(signals.time)))
    for row, width in enumerate(play.tolist()):
        if width <= 0:
            continue
        at_rotor = bool(side[row] >= CHOSEN)
        if not at_rotor and (seen := crossed(signals, motor)) is not None:
            position[row] = width * seen
            continue
        free = 1.0 if at_rotor else float(coasting[row])
        if free > 0:
            beyond = 0.0 if behind is None else float(behind[row])
            part = float(beyond >= CHOSEN) if at_rotor else 1.0 - beyond
            position[row] = free * _bounced(signals, motor, width / 2, at_rotor, part)
        if free < 1:
            position[row] += (1 - free) * width / 2 * _pushed(signals, motor)
    return position


@memoized
def _pushed(signals: Signals, motor: int) -> np.ndarray:
    """To which end of its dead zone the load pushes a rotor, from -1 to 1 `(t,)`."""
    through = load(signals, motor)
    usual = float(np.sqrt(np.nanmean(through**2)))
    return band_limited(
        np.tanh(through / max(CROSSING * usual, 1e-12)), signals.step, CROSSING_BAND / signals.step
    )


@memoized
def _bounced(signals: Signals, motor: int, half: float, at_rotor: bool, part: float) -> np.ndarray:
    """Position of a rotor between the ends of its dead zone, `half` away from its middle, from the
    accelerations of what moves by itself and a part of the friction `(t,)` [rad].

    What moves by itself is the rotor, or, where the rotor's motion is logged, its joints. Plain
    numbers, as arrays of a few are slower.
    """
    subject = signals.subject
    kicks, turning, slowed = _driven(signals, motor, at_rotor)
    share = np.abs(subject.motor_from_joint[motor])
    drops = part * float(share @ dry_friction(signals)) * slowed
    keeps = np.exp(-part * float(share**2 @ subject.viscous) * slowed)
    restitution, sign = (0.0, -1.0) if at_rotor else (RESTITUTION, 1.0)
    place, speed, step = half if kicks[0] > 0 else -half, 0.0, signals.step
    places = []
    for kick, known, drop, keep in zip(kicks, turning, drops.tolist(), keeps.tolist(), strict=True):
        own = (known + sign * (speed + kick)) * keep  # friction at most stops it
        own = own - drop if own > drop else own + drop if own < -drop else 0.0
        speed = sign * (own - known)
        place += step * speed
        if place > half:
            place = half
            if speed > 0:
                speed *= -restitution
        elif place < -half:
            place = -half
            if speed < 0:
                speed *= -restitution
        places.append(place)
    return np.array(places)


@memoized
def _driven(
    signals: Signals, motor: int, at_rotor: bool
) -> tuple[list[float], list[float], np.ndarray]:
    """By tick: the change of a rotor's speed against its joints without friction [rad/s], the speed
    of the body whose motion is logged, on the motor's side [rad/s], and the change of the other
    body's speed by a torque `(t,)` [rad/s/Nm].
    """
    subject = signals.subject
    push = _joint_alone(signals, motor) if at_rotor else _rotor_alone(signals, motor)
    inertia = carried(signals, motor) if at_rotor else rotor(subject, motor)
    turning = np.nan_to_num(signals.velocity @ subject.joint_from_motor[:, motor])
    return (
        (np.nan_to_num(push) * signals.step).tolist(),
        turning.tolist(),
        np.broadcast_to(signals.step / inertia, signals.time.shape),
    )


def _rotor_alone(signals: Signals, motor: int) -> np.ndarray:
    """Acceleration of a free rotor against its joints `(t,)` [rad/s^2]."""
    inertia = rotor(signals.subject, motor)
    torque = band_limited(signals.believed[:, motor], signals.step, BAND / signals.step)
    return np.asarray(
        torque / inertia - signals.acceleration @ signals.subject.joint_from_motor[:, motor]
    )


def _joint_alone(signals: Signals, motor: int) -> np.ndarray:
    """Acceleration of a rotor against its free joints `(t,)` [rad/s^2]."""
    return frictionless(signals, motor) / carried(signals, motor)
