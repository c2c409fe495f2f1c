"""Belts, cables and gears that stretch or have play: the residual that they leave. Motor and joint are
two masses, the motion of one of which is logged.

The rotor turns by M^T q + s [rad]; s is the stretch, or the place in the dead zone.

- Encoders at the joints (`side` 0): the logged motion is that of the joints. The rotor, of inertia
  J, needs J s'' beyond the torque of a rigid belt. A logged speed of the rotor exceeds that of the
  joints by s'.
- Encoders at the rotors (`side` 1): the logs take the motion of the rotors for that of the joints.
  The joints stand s / M behind, and need the torque of their own motion.
- Values of `side` between mix both.

**Stretch.** The torque through the belt is u = [M^-1 (needed torque less the rotors')], and
s = compliance u, filtered by the belt's damping. With encoders at the rotors u is that of the motion
of the rotors, and the joints, of inertia I at the motor, swing on the belt:
s + compliance I s'' = compliance u. A belt that stiffens follows k (1 + (stiffening s)^2) s = u, with
`stiffening` at the joint that it moves most.

**Friction.** Friction of gears acts on the rotor, before the belt, and stretches no belt. That of
joints may act behind it (`behind` 1), which matters with encoders at the rotors: the joint stands
still while the rotor reverses, and reverses later. So the belt is stretched by what the motor gives
it, and friction follows the motion of the joint.

**Play.** In a dead zone of width w nothing is transmitted, and s moves by itself,

    side 0: J s'' = tau - J M^T q_ddot      the rotor alone under its torque, and the friction that acts before the belt
    side 1: I s'' = u                       the joint alone, of inertia I at the motor, under the torque that it would need,
                                            and its own friction where that acts behind the belt

until it meets +-w/2. There a rotor bounces a little (`slack.RESTITUTION`), and stays while it is
pushed. A rotor with friction, or one whose torque is not known well, does not coast like that: it
lies at the end to which the load pushes it, and crosses over when the load reverses,
s = w / 2 tanh(u / (c rms u)). `coasting` mixes the two. Both are limited to the band that a log
resolves.
"""  # noqa: E501

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.effects.placing import at_motor, motor_velocity
from hyperleg_design.gap.effects.series import (
    band_limited,
    first_derivative,
    lagged,
    second_derivative,
    swung,
)
from hyperleg_design.gap.model import friction, rigid
from hyperleg_design.gap.model.machine import rotor
from hyperleg_design.gap.signals.channels import applied
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.transmission import against_joints, turned
from hyperleg_design.memoized import memoized

BAND = 0.2
"""Highest frequency of the transmitted torque that stretches a belt, over the rate of the log [-]:
40 Hz at 200 Hz."""

CHOSEN = 0.5
"""From which a choice between 0 and 1 is 1."""
BEHIND_BAND = 15.0
"""The same of a belt with friction at its joint [Hz]; above it, noise of the torque would make a
joint at rest turn round (assumed)."""
LEAST_SHARE = 1e-3
"""Least inertia of a joint where its posture is unknown, over the largest one in the log [-]."""
BRISTLES = 3e-3
"""Way over which a joint behind its belt turns its friction over [rad]; assumed: as well as its
place is known."""


@memoized
def load(signals: Signals, motor: int) -> np.ndarray:
    """Torque that the joints need through one motor's belt, on its side of M `(t,)` [Nm].

    Args:
        signals: a conditioned log, `t` ticks.
        motor: index of the motor.

    Returns:
        The torque `(t,)` [Nm].
    """
    subject = signals.subject
    needed = signals.rigid - signals.acceleration @ subject.armature.T
    through = applied(subject.motor_from_joint[motor : motor + 1], needed)[:, 0]
    return band_limited(through, signals.step, BAND / signals.step)


def frictionless(signals: Signals, motor: int) -> np.ndarray:
    """As `load`, without the nominal friction of the joints `(t,)` [Nm].

    Args:
        signals: a conditioned log, `t` ticks.
        motor: index of the motor.

    Returns:
        The torque `(t,)` [Nm].
    """
    return load(signals, motor) - rubbing(signals, motor)


def rubbing(signals: Signals, motor: int) -> np.ndarray:
    """Nominal friction of the joints at a motor, within the band of `load` `(t,)` [Nm].

    Args:
        signals: a conditioned log, `t` ticks.
        motor: index of the motor.

    Returns:
        The torque `(t,)` [Nm].
    """
    return band_limited(_friction(signals, motor), signals.step, BAND / signals.step)


def _friction(signals: Signals, motor: int) -> np.ndarray:
    """Nominal friction of the joints at a motor `(t,)` [Nm]."""
    subject = signals.subject
    swing = None if signals.limit_cycle is None else signals.limit_cycle.speed
    return applied(
        subject.motor_from_joint[motor : motor + 1],
        friction.rubbing_torque(subject, signals.velocity, swing),
    )[:, 0]


@memoized
def transmitted(signals: Signals, motor: int) -> np.ndarray:
    """Torque that a motor gives its belt, its own torque less what its rotor takes, where its speed
    is logged; else `load` `(t,)` [Nm].

    Args:
        signals: a conditioned log, `t` ticks.
        motor: index of the motor.

    Returns:
        The torque `(t,)` [Nm].
    """
    ahead = against_joints(signals, motor)
    if ahead is None:
        return load(signals, motor)
    spin = ahead + motor_velocity(signals, motor)
    return _passed_on(signals, motor, first_derivative(spin, signals.step), BAND / signals.step)


@memoized
def given(signals: Signals, motor: int, *, rubs: bool = True) -> np.ndarray:
    """Torque that a motor gives its belt, where positions are those of the rotors.

    Args:
        signals: a conditioned log, `t` ticks.
        motor: index of the motor.
        rubs: whether joints rub behind the belt, else before it.

    Returns:
        The torque `(t,)` [Nm].
    """
    spun = signals.acceleration @ signals.subject.joint_from_motor[:, motor]
    band = min(BEHIND_BAND, BAND / signals.step)
    lost = 0.0 if rubs else band_limited(_friction(signals, motor), signals.step, band)
    return _passed_on(signals, motor, spun, band) - lost


def _passed_on(signals: Signals, motor: int, spun: np.ndarray, band: float) -> np.ndarray:
    """A motor's own torque less what its rotor takes, of the rotor's acceleration `(t,)` and within
    a band [Hz].
    """
    return band_limited(
        signals.believed[:, motor] - rotor(signals.subject, motor) * spun, signals.step, band
    )


@memoized
def carried(signals: Signals, motor: int) -> np.ndarray:
    """Inertia of the joints that a motor moves, at the motor, all others held.

    Args:
        signals: a conditioned log, `t` ticks.
        motor: index of the motor.

    Returns:
        The inertia `(t,)` [kg m^2].
    """
    share = signals.subject.motor_from_joint[motor]
    (needed,) = rigid.accelerating(signals.subject, signals.position, [share], rotors=False)
    inertia = np.asarray(np.nan_to_num(needed) @ share)
    return np.maximum(inertia, LEAST_SHARE * inertia.max())


def stretch(
    signals: Signals,
    through: np.ndarray,
    motor: int,
    compliance: np.ndarray,
    damping_ratio: np.ndarray,
    stiffening: np.ndarray | None = None,
    swings: np.ndarray | None = None,
) -> np.ndarray:
    """How far a rotor turns beyond its joints under load, on its side of M `(k, t)` [rad].

    Args:
        signals: a conditioned log.
        through: torque through the belt `(t,)` [Nm].
        motor: place of the motor.
        compliance: `(k,)` [rad/Nm].
        damping_ratio: of the rotor on its belt `(k,)`.
        stiffening: 1 over the joint's angle at which the belt is twice as stiff `(k,)` [1/rad]; by
            default 0.
        swings: where the torque is that of the rotors' motion, on which the joints swing `(k,)`; by
            default nowhere.
    """
    late = 2 * damping_ratio * np.sqrt(rotor(signals.subject, motor) * compliance)
    swings = np.zeros(len(late), bool) if swings is None else swings & (compliance > 0)
    moved = np.empty((len(late), len(through)))
    moved[~swings] = lagged(through, late[~swings], signals.step)
    if swings.any():
        square = compliance[swings] * np.mean(carried(signals, motor))
        moved[swings] = swung(through, square, late[swings], signals.step)
    moved *= compliance[:, None]
    if stiffening is not None and stiffening.any():
        bend = stiffening / signals.subject.motor_over_joint(motor)
        stiff = bend > 0
        moved[stiff] = _stiffened(moved[stiff], bend[stiff, None])
    return moved


def _stiffened(straight: np.ndarray, bend: np.ndarray) -> np.ndarray:
    """Stretch s of a belt that would stretch by `straight` were it not stiffening: s (1 + (bend
    s)^2) = straight.
    """
    size = 2 / np.sqrt(3)
    return np.asarray(size / bend * np.sinh(np.arcsinh(3 / size * bend * straight) / 3))


def trace(
    signals: Signals,
    motor: int,
    moved: np.ndarray,
    side: np.ndarray,
    behind: np.ndarray | None = None,
) -> dict[str, np.ndarray]:
    """Compute what a stretch of the belt leaves in the residuals of motion and transmission, by the
    equations of this module.

    Args:
        signals: a conditioned log.
        motor: place of the motor.
        moved: stretch `(k, t)` [rad].
        side: on which the positions were logged `(k,)`.
        behind: whether joints rub behind the belt, with positions logged on side 1 `(k,)`; by
            default not.
    """
    at_joints = 1 - side[:, None]
    inertia = at_joints * rotor(signals.subject, motor)
    residual = at_motor(signals, motor, inertia * second_derivative(moved, signals.step))
    stretch_rate = first_derivative(moved, signals.step)
    residual |= turned(signals, motor, at_joints * stretch_rate)
    if side.any():
        subject = signals.subject
        share = subject.motor_from_joint[motor]
        rows = np.flatnonzero(side * np.any(moved != 0, 1))
        limbs = subject.tree.limbs(np.flatnonzero(share).tolist())
        rates = moved, first_derivative(moved, signals.step), second_derivative(moved, signals.step)
        logged = signals.position, signals.velocity, signals.acceleration
        position, velocity, acceleration = (
            x - np.multiply.outer(rate[rows], share) for x, rate in zip(logged, rates, strict=True)
        )
        beyond = rigid.inverse_dynamics(
            subject, position, velocity, acceleration, signals.base, rotors=False, joints=limbs
        )
        beyond -= _rotorless(signals)[:, limbs]
        residual["motion"][rows[:, None], :, np.array(limbs)] += (
            side[rows, None, None] * beyond
        ).swapaxes(1, 2)
        if behind is not None and (rubbing := (side >= CHOSEN) & (behind >= CHOSEN)).any():
            residual["motion"][rubbing] += _friction_change(signals, moved[rubbing], share)
    return residual


@memoized
def _rotorless(signals: Signals) -> np.ndarray:
    """Torque that the logged motion needs, without rotors `(t, n)` [Nm]."""
    motion = signals.position, signals.velocity, signals.acceleration
    return rigid.inverse_dynamics(signals.subject, *motion, signals.base, rotors=False)


def _friction_change(signals: Signals, moved: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Change of the joints' nominal friction because they reverse later than their rotors `(k, t,
    n)` [Nm].
    """
    subject = signals.subject
    torque = np.zeros((len(moved), *signals.position.shape))
    own = np.flatnonzero(share)
    angle = np.nan_to_num(signals.position[:, own])
    sign_change = _dahl_friction(angle - moved[..., None] * share[own]) - _dahl_friction(
        angle[None]
    )
    speed_change = first_derivative(moved, signals.step)[..., None] * share[own]
    torque[..., own] = subject.coulomb[own] * sign_change - subject.viscous[own] * speed_change
    return torque


def _dahl_friction(path: np.ndarray) -> np.ndarray:
    """Dahl friction over its Coulomb torque, along paths `(k, t, j)` [rad]: it reverses within a
    displacement of `BRISTLES`, and stays as it is at rest.
    """
    deflection = np.zeros_like(path)
    for row, column in np.ndindex(path.shape[0], path.shape[2]):
        deflection[row, 1:, column] = _dahl_response(np.diff(path[row, :, column]))
    return deflection


def _dahl_response(steps: np.ndarray) -> np.ndarray:
    """Dahl friction over its Coulomb torque after each step `(t,)`: z' = (side - z) / `BRISTLES`
    while the joint moves to one side, so that only reversals need a loop.
    """
    moving = np.flatnonzero(steps)
    if not moving.size:
        return np.zeros(len(steps))
    last = np.maximum.accumulate(np.where(steps != 0, np.arange(len(steps)), moving[0]))
    sides = np.sign(steps)[last]
    gone = np.concatenate([[0.0], np.cumsum(np.abs(steps)) / BRISTLES])
    turns = np.concatenate([[0], np.flatnonzero(np.diff(sides)) + 1])
    remainders = np.exp(-np.diff(np.append(gone[turns], gone[-1]))).tolist()
    begun, state = [], 0.0
    for side, remainder in zip(sides[turns].tolist(), remainders, strict=True):
        begun.append(state)
        state = side + (state - side) * remainder
    run = np.repeat(np.arange(len(turns)), np.diff(np.append(turns, len(steps))))
    return np.asarray(sides + (np.array(begun)[run] - sides) * np.exp(gone[turns][run] - gone[1:]))


RUBBING = ("joints rub before the belt", "joints rub behind the belt")
"""Choices of the parameter `behind`: where the friction of joints acts; behind, positions are those
of the rotors."""
