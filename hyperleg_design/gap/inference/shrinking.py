"""The term of the likelihood for belts and gears, whose traces contain noise of the residual
(errors in variables).

Noise of accelerations, and of forces under the feet, is in the residual and also in the load that
stretches a belt. With encoders at the joints the trace of a belt contains the share
x = J compliance omega^2 of it: all of it at the frequency at which the rotor would ring. A variance
of noise of which the share f is in the load shrinks to f (1 - x)^2 + 1 - f when the belt is fitted,
so that least squares would find a belt in any noise. With encoders at the rotors, a belt that
stiffens, or one with its joint's friction behind it, is stretched by the torque that its motor
gives, noise included.

x is measured: noise is added to the log, and its effect on the trace is compared with that on the
residual, band by band.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.effects.strength import motor_strength
from hyperleg_design.gap.inference import noise_model
from hyperleg_design.gap.inference.samples import Samples
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.memoized import memoized

LEAST = 0.05
"""Share of noise that no cause shrinks further, as a standard deviation [-]."""
SHAKEN = 0.005
"""Noise that is added to a torque, over the torque that its motor is made for [-] (assumed, as that
of current sensors)."""
SEED = 11
"""Seed of the noise that is added."""
SMALLEST = 0.05
"""Usual sizes at which what a trace takes along is measured, at least [-]: of nothing it is 0
(assumed)."""
ACCELERATION, LOAD, TORQUE = "acceleration", "load", "torque"
"""Kinds of noise: of accelerations, of other parts of the needed torque, and of the motor's."""


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

    def log(self, phi: np.ndarray) -> float:
        """Compute the term of the log-likelihood that offsets what shrinking noise gains.

        Args:
            phi: the parameter in usual sizes `(1,)`.

        Returns:
            The term, never positive [nat].
        """
        return 0.5 * float(self.number @ np.log(self._left(phi)))

    def slopes(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Compute derivatives of `log`.

        Args:
            phi: the parameter in usual sizes `(1,)`.

        Returns:
            The first derivative `(1,)`, and the negative second one, at least 0 `(1, 1)`.
        """
        left = self._left(phi)
        part = np.where(2 * self.slope * phi >= self.square * phi**2, self.part, 0.0)
        first = part * (self.square * phi - self.slope) / left
        second = 2 * first**2 - part * self.square / left
        bend = max(float(self.number @ second), 0.0)
        return np.array([self.number @ first]), np.array([[bend]])

    def _left(self, phi: np.ndarray) -> np.ndarray:
        """Variance of each sample's noise that is left; noise that grows gains nothing by it."""
        shrunk = 1 - 2 * self.slope * phi + self.square * phi**2
        return np.clip(self.part * shrunk + 1 - self.part, LEAST**2, 1.0)


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
    if not effect.stretched:
        return None
    at = moved_row(samples, location)
    if at is None:
        return None
    motor, joint, row = at
    own = np.flatnonzero(samples.row == row)
    size = max(float(values[0] / usual[0]), SMALLEST)
    values = np.array([size * usual[0], *values[1:]])
    kinds = ACCELERATION, TORQUE if effect.holds_torque(values) else LOAD
    slope, square = taken(samples, effect, location, values, (motor, joint), kinds)
    parts = _parts(samples, joint, kinds)
    part = np.maximum(parts.sum(0), 1e-300)
    group = samples.group
    slope, square = ((parts * each[:, group]).sum(0) / part for each in (slope, square))
    part, slope, square = part[own], slope[own] / size, square[own] / size**2
    return Shrinking(0, slope, square, part, samples.share[own], row)


def moved_row(samples: Samples, location: str) -> tuple[int, int, int] | None:
    """Find the row of motion that a motor moves most.

    Args:
        samples: of the logs.
        location: name of the motor.

    Returns:
        Motor, joint and row; None where no log has the row.
    """
    subject = samples.filtered_logs[0].signals.subject
    motor = subject.motors.index(location)
    joint = subject.main_joint(motor)
    row = samples.motion_row(joint)
    return None if row is None else (motor, joint, row)


def _parts(samples: Samples, joint: int, kinds: Sequence[str]) -> np.ndarray:
    """Shares of each sample's noise in a joint's row that are of each kind `(kinds, S)`; all noise
    that is not of accelerations may be of torques.
    """
    parts = np.zeros((len(kinds), len(samples.row)))
    for log, places in zip(samples.filtered_logs, samples.where, strict=True):
        for place, row in enumerate(log.rows):
            if (row.residual_name, row.column) != ("motion", joint):
                continue
            at, square = places[place], samples.floor[places[place]] ** 2
            of_accelerations = np.minimum(noise_model.of_acceleration(log, place)[0] / square, 1.0)
            loads = noise_model.of_load(log, place) / square if LOAD in kinds else np.inf
            others = np.minimum(loads, 1 - of_accelerations)
            for part, kind in zip(parts, kinds, strict=True):
                part[at] = of_accelerations if kind == ACCELERATION else others
    return parts


def taken(
    samples: Samples,
    effect: Effect,
    location: str,
    values: np.ndarray,
    at: tuple[int, int],
    kinds: Sequence[str],
) -> tuple[np.ndarray, np.ndarray]:
    """Measure how much of each kind of noise a trace takes along.

    Args:
        samples: of the logs.
        effect: of the catalogue.
        location: its place.
        values: of its parameters `(k,)`.
        at: its motor, and the joint in whose residual the noise is.
        kinds: of noise, of `ACCELERATION`, `LOAD` and `TORQUE`.

    Returns:
        The share of it, and the mean square of what the trace makes of it over the noise's, by
        group of samples `(kinds, G)` each.
    """
    motor, joint = at

    def trace(signals: Signals) -> dict[str, np.ndarray]:
        calm = effect.trace(signals, location, values[None])["motion"][0]
        both = np.zeros((2, len(kinds), *calm.shape))
        for place, kind in enumerate(kinds):
            shaken, noise = _shaken(signals, kind, motor, joint)
            moved = effect.trace(shaken, location, values[None])["motion"][0]
            both[0, place, :, joint] = (moved - calm)[:, joint]
            both[1, place, :, joint] = noise
        return {"motion": both.reshape(-1, *calm.shape)}

    columns = samples.columns(trace, 2 * len(kinds))
    if columns is None:
        return np.zeros((len(kinds), samples.groups)), np.zeros((len(kinds), samples.groups))
    moved, noise = columns[: len(kinds)], columns[len(kinds) :]
    shared, squares, whole = (
        np.array([np.bincount(samples.group, samples.share * each) for each in products])
        for products in (moved * noise, moved**2, noise**2)
    )
    whole = np.maximum(whole, 1e-300)
    return shared / whole, squares / whole


@memoized
def _shaken(signals: Signals, kind: str, motor: int, joint: int) -> tuple[Signals, np.ndarray]:
    """A log with noise of one kind, and what it leaves in a joint's residual `(t,)` [Nm]."""
    subject = signals.subject
    rng = np.random.default_rng([SEED, motor])
    white = SHAKEN * motor_strength(subject, motor) * rng.normal(size=len(signals.time))
    if kind == ACCELERATION:
        turned = noise_model.shaken_accelerations(signals, rng)
        needed = np.stack(
            [
                np.sum(noise_model.inertias_at(signals, j) * turned, -1)
                for j in range(turned.shape[1])
            ],
            -1,
        )
        acceleration = signals.acceleration + turned
        shaken = replace(signals, acceleration=acceleration, rigid=signals.rigid + needed)
        return shaken, -needed[:, joint]
    if kind == LOAD:
        needed = signals.rigid.copy()
        needed[:, joint] += white
        return replace(signals, rigid=needed), -white
    believed = signals.believed.copy()
    believed[:, motor] += white
    shaken = replace(signals, believed=believed)
    return shaken, white * subject.joint_from_motor[joint, motor]
