"""What belts that stretch or have play leave in a log: motor and joint as two masses, the joint's motion known.

What the joints need through a motor's belt is u = [M^-1 (needed torque less the rotors')]; the belt is then stretched by

    s = u compliance, filtered by the belt's damping, + play / 2 in the direction of u,

and the rotor turns by M^T q + s. Where positions are the joints' own (`side` 0) the rotor's inertia takes J s'' beyond a rigid
belt's torque. Where they are those of the rotors, taken for the joints' (`side` 1), the joints stand s / M behind, and need
another torque for that. Between, encoders on both sides are mixed. Stretch is limited to the band that a log resolves.
"""

from __future__ import annotations

from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from hyperleg_design.gap import rigid
from hyperleg_design.gap.conditioning import applied
from hyperleg_design.gap.effects.placing import at_motor
from hyperleg_design.gap.effects.series import band_limited, first_derivative, lagged, second_derivative
from hyperleg_design.simulation.two_mass import LIGHTEST

if TYPE_CHECKING:
    from hyperleg_design.gap.signals import Signals
    from hyperleg_design.gap.subject import Subject

BAND = 0.2
"""Of the transmitted torque that stretches a belt, over the log's rate: 40 Hz at 200 Hz."""
SOFT = 0.05
"""Torque over its own root mean square within which a belt with play changes sides."""

_LOADS: WeakKeyDictionary[Signals, dict[int, np.ndarray]] = WeakKeyDictionary()


def rotor(subject: Subject, motor: int) -> float:
    """Inertia of a rotor on its belt [kg m^2]."""
    own = float(subject.rotor_inertia[motor])
    return own if own > 0 else LIGHTEST


def load(signals: Signals, motor: int) -> np.ndarray:
    """Torque that the joints need through one motor's belt, on its side of M `(t,)` [Nm]."""
    kept = _LOADS.setdefault(signals, {})
    if motor not in kept:
        subject = signals.subject
        needed = signals.rigid - signals.acceleration @ subject.armature.T
        kept[motor] = band_limited(applied(subject.motor_from_joint[motor : motor + 1], needed)[:, 0], signals.step, BAND / signals.step)
    return kept[motor]


def stretch(signals: Signals, motor: int, compliance: np.ndarray, play: np.ndarray, damping_ratio: np.ndarray) -> np.ndarray:
    """How far a rotor turns beyond its joints, on its side of M `(k, t)` [rad].

    Args:
        signals: a conditioned log.
        motor: place of the motor.
        compliance: `(k,)` [rad/Nm].
        play: whole width `(k,)` [rad].
        damping_ratio: of the rotor on its belt `(k,)`.
    """
    torque = load(signals, motor)
    late = 2 * damping_ratio * np.sqrt(rotor(signals.subject, motor) * compliance)
    found = compliance[:, None] * lagged(torque, late, signals.step)
    if play.any():
        size = SOFT * np.sqrt(np.nanmean(torque**2)) + 1e-12
        found = found + play[:, None] / 2 * np.tanh(torque / size)
    return found


def trace(signals: Signals, motor: int, moved: np.ndarray, side: np.ndarray) -> dict[str, np.ndarray]:
    """What stretch leaves in the balance of motion, see above.

    Args:
        signals: a conditioned log.
        motor: place of the motor.
        moved: stretch `(k, t)` [rad].
        side: on which the positions were logged `(k,)`.
    """
    found = at_motor(signals, motor, (1 - side[:, None]) * rotor(signals.subject, motor) * second_derivative(moved, signals.step))
    if side.any():
        subject = signals.subject
        share = subject.motor_from_joint[motor]
        nominal = rigid.inverse_dynamics(subject, signals.position, signals.velocity, signals.acceleration, signals.base, rotors=False)
        for row in np.flatnonzero(side * np.any(moved != 0, 1)):
            one = moved[row]
            rates = one, first_derivative(one, signals.step), second_derivative(one, signals.step)
            logged = signals.position, signals.velocity, signals.acceleration
            q, v, a = (x - np.multiply.outer(rate, share) for x, rate in zip(logged, rates, strict=True))
            found["motion"][row] += side[row] * (rigid.inverse_dynamics(subject, q, v, a, signals.base, rotors=False) - nominal)
    return found
