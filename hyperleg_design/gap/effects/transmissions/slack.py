"""The play of belts: when motor and joint touch, fly apart and bounce."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from hyperleg_design.gap.effects.series import band_limited
from hyperleg_design.gap.effects.transmissions.belt import BAND, CHOSEN, frictionless, load
from hyperleg_design.gap.model import rigid
from hyperleg_design.gap.model.machine import rotor
from hyperleg_design.gap.model.memoized import memoized
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.sliding import dry_friction

RESTITUTION = 0.3
"""Speed after over speed before a rotor hits the end of its dead zone; assumed: gears and cords
under load hardly bounce. Joints, which hit a rotor that is held, do not."""
CROSSING, CROSSING_BAND = 0.8, 0.15
"""c, the load below which a rotor that does not coast is on its way across; band of its crossing,
over the log's rate (assumed)."""
LEAST_SHARE = 1e-3
"""Least inertia of a joint where its posture is unknown, over the largest one in the log [-]."""


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
    pushed = cache(lambda: _pushed(signals, motor))
    kicks: dict[bool, list[float]] = {}
    for row, width in enumerate(play):
        if width <= 0:
            continue
        at_rotor = bool(side[row] >= CHOSEN)
        free = 1.0 if at_rotor else float(coasting[row])
        if free > 0:
            if at_rotor not in kicks:
                push = _joint_alone(signals, motor) if at_rotor else _rotor_alone(signals, motor)
                kicks[at_rotor] = (np.nan_to_num(push) * signals.step).tolist()
            bounce = 0.0 if at_rotor else RESTITUTION
            beyond = 0.0 if behind is None else float(behind[row])
            part = float(beyond >= CHOSEN) if at_rotor else 1.0 - beyond
            rubbing = _Rubbing.of(signals, motor, at_rotor, part) if part else None
            path = _bounced(kicks[at_rotor], signals.step, float(width) / 2, bounce, rubbing)
            position[row] = free * np.array(path)
        if free < 1:
            position[row] += (1 - free) * float(width) / 2 * pushed()
    return position


def _pushed(signals: Signals, motor: int) -> np.ndarray:
    """To which end of its dead zone the load pushes a rotor, from -1 to 1 `(t,)`."""
    through = load(signals, motor)
    usual = float(np.sqrt(np.nanmean(through**2)))
    return band_limited(
        np.tanh(through / max(CROSSING * usual, 1e-12)), signals.step, CROSSING_BAND / signals.step
    )


@dataclass(frozen=True)
class _Rubbing:
    """What slows a rotor, or the joints left behind by it."""

    sign: float
    """Of the body's own speed in that of the rotor against its joints."""
    turning: list[float]
    """Speed of the body whose motion is known, on the motor's side [rad/s]."""
    drops: list[float]
    """Speed that Coulomb friction takes in a tick [rad/s]."""
    keeps: list[float]
    """Share of the speed that viscous friction leaves in a tick [-]."""

    @classmethod
    def of(cls, signals: Signals, motor: int, at_rotor: bool, part: float) -> _Rubbing:
        """Collect a part of the friction: on a rotor, or on joints where the rotor's motion is
        logged.

        Args:
            signals: of a log.
            motor: index of the motor.
            at_rotor: whether the friction acts on the rotor.
            part: share of the friction that acts there [-].
        """
        subject, coulomb = signals.subject, dry_friction(signals)
        inertia = _inertia(signals, motor) if at_rotor else rotor(subject, motor)
        slowed = np.broadcast_to(signals.step / inertia, signals.time.shape)
        share = np.abs(subject.motor_from_joint[motor])
        turning = np.nan_to_num(signals.velocity @ subject.joint_from_motor[:, motor])
        return cls(
            -1.0 if at_rotor else 1.0,
            turning.tolist(),
            (part * float(share @ coulomb) * slowed).tolist(),
            np.exp(-part * float(share**2 @ subject.viscous) * slowed).tolist(),
        )

    def slowed(self, tick: int, speed: float) -> float:
        """Speed of the rotor against its joints after a tick; friction at most stops the body.

        Args:
            tick: number of the tick.
            speed: without friction [rad/s].
        """
        turning, drop = self.turning[tick], self.drops[tick]
        own = (turning + self.sign * speed) * self.keeps[tick]
        own = max(own - drop, 0.0) if own > 0 else min(own + drop, 0.0)
        return self.sign * (own - turning)


def _bounced(
    kicks: list[float], step: float, half: float, restitution: float, rubbing: _Rubbing | None
) -> list[float]:
    """Places of a body between two walls, from its changes of speed, and from its friction if it
    rubs; plain numbers, as arrays of a few are slower.
    """
    place, speed = half if kicks[0] > 0 else -half, 0.0
    places = []
    for tick, change in enumerate(kicks):
        speed += change
        if rubbing is not None:
            speed = rubbing.slowed(tick, speed)
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
    return places


@memoized
def _inertia(signals: Signals, motor: int) -> np.ndarray:
    """Inertia of the joints that a motor moves, at the motor, all others held `(t,)` [kg m^2]."""
    share = signals.subject.motor_from_joint[motor]
    (needed,) = rigid.accelerating(signals.subject, signals.position, [share], rotors=False)
    inertia = np.asarray(np.nan_to_num(needed) @ share)
    return np.maximum(inertia, LEAST_SHARE * inertia.max())


def _rotor_alone(signals: Signals, motor: int) -> np.ndarray:
    """Acceleration of a free rotor against its joints `(t,)` [rad/s^2]."""
    inertia = rotor(signals.subject, motor)
    torque = band_limited(signals.believed[:, motor], signals.step, BAND / signals.step)
    return np.asarray(
        torque / inertia - signals.acceleration @ signals.subject.joint_from_motor[:, motor]
    )


def _joint_alone(signals: Signals, motor: int) -> np.ndarray:
    """Acceleration of a rotor against its free joints `(t,)` [rad/s^2]."""
    return frictionless(signals, motor) / _inertia(signals, motor)
