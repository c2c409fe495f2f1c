"""Noise of the logs that belts take along in their traces, and what keeps them from explaining it
away.

Noise of accelerations is in the residual, and in the load that stretches a belt, too: with encoders
at the joints a belt's trace takes the share x = J compliance omega^2 of it along, all of it where
the rotor would ring. Noise of which a share f is that of accelerations shrinks to f (1 - x)^2 + 1 -
f, and least squares would find a belt in any noise, that rings just below the smoother's crossover.

With encoders at the rotors, a belt that stiffens, or has its joint's friction behind it, is
stretched by the torque that its motor gives, noise included: least squares would find a belt in the
noise of torques, too. How much of it the trace takes along is measured: white noise is added to the
torque, and what comes of it in the trace is compared with it, band by band.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from hyperleg_design.gap.effects.placing import motor_strength
from hyperleg_design.gap.inference import noise_model

if TYPE_CHECKING:
    from hyperleg_design.gap.effects.effect import Effect
    from hyperleg_design.gap.inference.samples import Samples
    from hyperleg_design.gap.signals.signals import Signals

LEAST = 0.05
"""Share of noise that no cause shrinks further, as a standard deviation [-]."""
SHAKEN = 0.005
"""Noise that is added to a torque, over the torque that its motor is made for [-] (assumed, as that
of current sensors)."""
SEED = 11
"""Of that noise."""

_SHAKEN: WeakKeyDictionary[Signals, dict[int, tuple[Signals, np.ndarray]]] = WeakKeyDictionary()


@dataclass(frozen=True, eq=False)
class Shrinking:
    """How a cause shrinks one kind of noise: to 1 - 2 slope phi + square phi^2 of its variance, phi
    being one parameter; used as `endogenous.Factor`.
    """

    parameter: int
    slope: np.ndarray
    """Of some samples `(k,)`, over the usual size of the parameter."""
    square: np.ndarray
    """Likewise; the square of `slope` where all of a sample's noise passes alike `(k,)`."""
    part: np.ndarray
    """Share of their noise that is of this kind `(k,)`."""
    number: np.ndarray
    """Independent numbers that each stands for `(k,)`."""
    row: int

    def log(self, phi: float) -> float:
        """Log of the density by which noise that shrinks must not gain."""
        return 0.5 * float(self.number @ np.log(self._left(phi)))

    def slopes(self, phi: float) -> tuple[float, float]:
        """First derivative of `log`, and its second with the sign turned, where that is a
        maximum.
        """
        left = self._left(phi)
        first = self.part * (self.square * phi - self.slope) / left
        second = 2 * first**2 - self.part * self.square / left
        return float(self.number @ first), max(float(self.number @ second), 0.0)

    def _left(self, phi: float) -> np.ndarray:
        shrunk = 1 - 2 * self.slope * phi + self.square * phi**2
        return np.maximum(self.part * shrunk + 1 - self.part, LEAST**2)


def shrinking(
    samples: Samples, effect: Effect, location: str, usual: np.ndarray, values: np.ndarray
) -> Shrinking | None:
    """Of an effect at a motor, at some values; None where its trace takes no noise along, or its
    joint has no row.

    Args:
        samples: of the logs.
        effect: of the catalogue.
        location: its place.
        usual: sizes of its parameters `(k,)`.
        values: of them `(k,)`.
    """
    subject = samples.filtered_logs[0].signals.subject
    inertia = effect.noise_inertia(location, subject, values)
    if inertia is None and not effect.holds_torque(values):
        return None
    motor = subject.motors.index(location)
    joint = int(np.argmax(np.abs(subject.joint_from_motor[:, motor])))
    keys = [(row.residual_name, row.column) for row in samples.rows]
    if ("motion", joint) not in keys:
        return None
    row = keys.index(("motion", joint))
    own = np.flatnonzero(samples.row == row)
    part, rate = _of_acceleration(samples, motor, joint)
    if inertia is not None:
        slope = rate[own] * inertia * usual[0]
        return Shrinking(0, slope, slope**2, part[own], samples.share[own], row)
    size = float(values[0] / usual[0])
    if size <= 0:
        return None
    slope, square = _of_torque(samples, effect, location, values, joint, own)
    return Shrinking(0, slope / size, square / size**2, 1 - part[own], samples.share[own], row)


def _of_acceleration(samples: Samples, motor: int, joint: int) -> tuple[np.ndarray, np.ndarray]:
    """Share of each sample's noise that is that of accelerations, and the mean square of its
    frequency, as far as it is in the load of a motor's belt `(S,)` each.
    """
    part, rate = np.zeros(len(samples.row)), np.zeros(len(samples.row))
    for log, places in zip(samples.filtered_logs, samples.where, strict=True):
        for place, row in enumerate(log.rows):
            if (row.residual_name, row.column) == ("motion", joint):
                feigned, squared = noise_model.of_acceleration(log, place)
                part[places[place]] = feigned
                rate[places[place]] = squared * _carried(log.signals, motor, joint)
    return np.minimum(part / samples.floor**2, 1.0), rate


def _carried(signals: Signals, motor: int, joint: int) -> float:
    """Share of the noise of accelerations in a joint's residual that is in the load of its motor's
    belt, too, through which it comes back.
    """
    if signals.noise is None:
        return 0.0
    level = np.nan_to_num(signals.noise) ** 2
    whole = noise_model.inertias(signals)
    load = np.tensordot(
        signals.subject.motor_from_joint[motor], whole - signals.subject.armature[:, None], 1
    )
    both, all_of_it = (
        float(np.mean(whole[joint] * load @ level)),
        float(np.mean(whole[joint] ** 2 @ level)),
    )
    return float(signals.subject.joint_from_motor[joint, motor]) * both / max(all_of_it, 1e-300)


def _of_torque(
    samples: Samples,
    effect: Effect,
    location: str,
    values: np.ndarray,
    joint: int,
    own: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Share of a motor's noise that a trace takes along at a joint, and the mean square of what it
    makes of it, over the noise's, in the band of each of the samples `own` `(k,)` each.
    """
    motor = samples.filtered_logs[0].signals.subject.motors.index(location)

    def taken(signals: Signals) -> dict[str, np.ndarray]:
        shaken, noise = _shaken(signals, motor)
        calm, moved = (
            effect.trace(log, location, values[None])["motion"][0] for log in (signals, shaken)
        )
        both = np.zeros((2, *calm.shape))
        both[0, :, joint] = (moved - calm)[:, joint]
        both[1, :, joint] = noise * signals.subject.joint_from_motor[joint, motor]
        return {"motion": both}

    columns = samples.columns(taken, 2)
    if columns is None:
        return np.zeros(len(own)), np.zeros(len(own))
    trace, noise = columns[:, own]
    group = samples.group[own]
    shared, squares, whole = (
        np.bincount(group, samples.share[own] * product)
        for product in (trace * noise, trace**2, noise**2)
    )
    whole = np.maximum(whole, 1e-300)
    return (shared / whole)[group], (squares / whole)[group]


def _shaken(signals: Signals, motor: int) -> tuple[Signals, np.ndarray]:
    """A log with white noise in a motor's torque, and that noise `(t,)` [Nm]."""
    known = _SHAKEN.setdefault(signals, {})
    if motor not in known:
        rng = np.random.default_rng([SEED, motor])
        noise = SHAKEN * motor_strength(signals.subject, motor) * rng.normal(size=len(signals.time))
        believed = signals.believed.copy()
        believed[:, motor] += noise
        known[motor] = replace(signals, believed=believed), noise
    return known[motor]
