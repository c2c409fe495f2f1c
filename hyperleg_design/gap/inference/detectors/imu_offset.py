"""Constant errors of an IMU: its reading minus what the logged motion of the base predicts for it.

The gyro minus the rate of a logged orientation, and the accelerometer minus the acceleration of a
logged velocity with gravity, are noise about the errors of the sensors. Over seconds their mean is
known a hundred times better than sensors are usually calibrated. No mass, friction or ground
enters.

An error of the accelerometer across the vertical has two look-alikes: a vertical that leans, and a
sensor that is mounted at an angle. The first is constant in the world, the second turns with the
force on the sensor, and an error of the sensor is constant in its own frame. On a base that hardly
turns they cannot be told apart, and the finding is that the vertical leans.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from hyperleg_design.gap.effects.sensors.imu_bias import IMU, USUAL, ImuBias
from hyperleg_design.gap.inference.intervals import NORMAL
from hyperleg_design.gap.inference.rules import CauseRules
from hyperleg_design.gap.model.mechanism import quaternion_rotation
from hyperleg_design.gap.results.diagnosis import Value
from hyperleg_design.gap.signals.base_motion import known, on_ticks, orientation, spin
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.smoothing import smooth

PLACE = ImuBias.identifier, IMU
OFFSET = "offset"
CERTAIN = 5.0
"""Least size of an error over its standard error [-]."""
PIECE, SHORTEST = 1.0, 0.25
"""Length of the pieces of a log over which means are taken, whose scatter gives the standard error,
and their least length in short logs [s]."""
LEAST_PIECES = 4
UPRIGHT = 0.15
"""Vertical part of an accelerometer's error over its horizontal one, below which it may be a
vertical that leans [-]."""
LEANING = 0.01
"""Least angle of a vertical that is reported to lean [rad] (assumed: robots stand no more upright
than that)."""


@dataclass(frozen=True, eq=False)
class Offset:
    """Constant errors of an IMU, in the sensor's axes."""

    parameters: dict[str, Value]
    """Of `ImuBias`."""
    kind: str
    """`gyro` or `accelerometer`, whichever is further off what is usual."""
    size: float
    """Of that one's error [rad/s, m/s^2]."""
    left: float
    """Of it, what an error taken from other data leaves: other logs, or the other half of one."""
    leans: float = 0.0
    """Angle by which the vertical would lean that makes it as well [rad]; 0 where none would."""

    @property
    def unit(self) -> str:
        """Unit of the offset's size and of what is left of it."""
        return "rad/s" if self.kind == "gyro" else "m/s^2"

    @property
    def closed(self) -> float:
        """Share of it that is foretold."""
        return 1 - self.left / self.size

    @property
    def sentence(self) -> str:
        """What was found, as a sentence of a report."""
        if self.leans:
            return (
                f"feels a vertical that leans by {self.leans:.2g} rad against base_orientation: "
                f"gravity, orientation or the accelerometer is off"
            )
        source = (
            "the rate of base_orientation"
            if self.kind == "gyro"
            else "the acceleration of the base's velocity and orientation, and gravity"
        )
        values = ", ".join(f"{self.parameters[f'{self.kind}_{axis}'].value:.3g}" for axis in "xyz")
        return f"differs from {source} by a constant: {values} {self.unit} in its own axes"


def imu_offset(
    signals: Sequence[Signals], references: Sequence[Signals] = (), beyond: float = CauseRules.usual
) -> Offset | None:
    """Constant errors beyond what is usual; None where there are none, or the base's motion is not
    known from elsewhere.

    Args:
        signals: logs to be diagnosed.
        references: logs of the healthy robot; an error that they have, too, is none of these.
        beyond: usual deviations from which an error is a finding, `CauseRules.usual`.
    """
    logs = [_compared(log) for log in signals]
    means = np.array([log.mean for log in logs])
    mean, error = _together(logs)
    if references:
        healthy, unsure = _together([_compared(log) for log in references])
        known = np.isfinite(healthy)
        mean = np.where(known, mean - healthy, mean)
        error = np.where(known, np.hypot(error, unsure), error)
    over = np.abs(mean) / USUAL
    clear = np.isfinite(mean) & (over > beyond) & (np.abs(mean) > CERTAIN * error)
    if not clear.any():
        return None
    leans = 0.0
    if not clear[:3].any() and not _stays_in_sensor(logs):
        leans = _leans(signals[0], mean[3:])
    if 0 < leans < LEANING:
        return None
    by_gyro = np.nanmax(over[:3], initial=0) >= np.nanmax(over[3:], initial=0)
    part = slice(0, 3) if by_gyro else slice(3, 6)
    apart = means[:, part] if len(means) > 1 else logs[0].halves[:, part]
    others = (np.nansum(apart, 0) - apart) / max(len(apart) - 1, 1)
    left = float(np.sqrt(np.nanmean(np.sum((apart - others) ** 2, -1))))
    size = float(np.linalg.norm(mean[part]))
    ends = np.array([mean, mean - NORMAL * error, mean + NORMAL * error])
    named = zip(ImuBias.parameters, np.where(np.isfinite(mean), ends, 0.0).T.tolist(), strict=True)
    values = {p.name: Value(middle, low, high, p.unit) for p, (middle, low, high) in named}
    return Offset(values, "gyro" if by_gyro else "accelerometer", size, min(left, size), leans)


@dataclass(frozen=True, eq=False)
class _Compared:
    """Error of gyro and accelerometer in one log, in the sensor's axes; NaN where unknown."""

    mean: np.ndarray = field(default_factory=lambda: np.full(6, np.nan))
    """`(6,)`"""
    error: np.ndarray = field(default_factory=lambda: np.full(6, np.nan))
    """Standard error of the mean `(6,)`."""
    halves: np.ndarray = field(default_factory=lambda: np.full((2, 6), np.nan))
    """Means of both halves `(2, 6)`."""
    pieces: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """Means of the accelerometer's over pieces of the log `(pieces, 3)`."""
    leaning: np.ndarray = field(default_factory=lambda: np.zeros((0, 3, 5)))
    """Means of what a radian makes of it, by which the vertical leans about two directions, or the
    sensor is turned about three `(pieces, 3, 5)`."""


def _compared(signals: Signals) -> _Compared:
    """What the IMU tells less what the base's motion from elsewhere says it should."""
    log, subject, ticks = signals.log, signals.subject, signals.time
    quaternion, gyro, felt, velocity = (
        known(log, kind) for kind in ("base_orientation", "gyro", "accelerometer", "base_velocity")
    )
    if quaternion is None or not subject.floating:
        return _Compared()
    turning = orientation(log, quaternion, ticks)
    rate, turn = spin(turning)
    apart, leaning = np.full((len(ticks), 6), np.nan), np.full((len(ticks), 3, 5), np.nan)
    if gyro is not None:
        apart[:, :3] = on_ticks(log, gyro, ticks) - rate @ subject.imu_rotation
    if felt is not None and velocity is not None:
        rotation = quaternion_rotation(turning.value)
        world = np.einsum(
            "tji,tj->ti", rotation, smooth(log.time, velocity, ticks).first - subject.gravity
        )
        lever = subject.imu_position
        at_sensor = world + np.cross(turn, lever) + np.cross(rate, np.cross(rate, lever))
        apart[:, 3:] = on_ticks(log, felt, ticks) - at_sensor @ subject.imu_rotation
        tilted = np.cross(subject.gravity, np.eye(3))[np.argsort(np.abs(subject.gravity))[:2]]
        turned = np.cross(at_sensor[:, None], np.eye(3))
        leaning = np.concatenate([tilted @ rotation, turned], 1) @ subject.imu_rotation
        leaning = leaning.swapaxes(1, 2)
    apart, leaning = apart[signals.valid], leaning[signals.valid]
    longest, shortest = (max(round(x / signals.step), 1) for x in (PIECE, SHORTEST))
    number = max(len(apart) // longest, LEAST_PIECES)
    if len(apart) < number * shortest:
        return _Compared()
    pieces = np.array([piece.mean(0) for piece in np.array_split(apart, number)])
    error = pieces.std(0, ddof=1) / np.sqrt(number)
    halves = np.array([half.mean(0) for half in np.array_split(apart, 2)])
    leaning = np.array([piece.mean(0) for piece in np.array_split(leaning, number)])
    return _Compared(apart.mean(0), error, halves, pieces[:, 3:], leaning)


def _stays_in_sensor(logs: Sequence[_Compared]) -> bool:
    """Whether an accelerometer's error is constant in its own axes, and neither a vertical that
    leans nor a sensor that is turned against the base explains it nearly as well, by least squares.
    """
    value = np.concatenate([log.pieces for log in logs])
    columns = np.concatenate([log.leaning for log in logs])
    known = np.isfinite(value).all(-1)
    value, columns = value[known], columns[known].reshape(-1, 5)
    if not len(value):
        return False
    constant = float(np.sum((value - value.mean(0)) ** 2))
    left = value.ravel() - columns @ np.linalg.lstsq(columns, value.ravel())[0]
    variance = constant / max(3 * len(value) - 3, 1)
    return float(left @ left) - constant > CERTAIN**2 * variance


def _together(logs: Sequence[_Compared]) -> tuple[np.ndarray, np.ndarray]:
    """Mean of logs and its standard error `(6,)`, from their own and from how they differ."""
    means, errors = np.array([log.mean for log in logs]), np.array([log.error for log in logs])
    count = np.isfinite(means).sum(0)
    own = np.sqrt(np.nansum(errors**2, 0)) / np.maximum(count, 1)
    middle = np.where(count > 0, np.nansum(means, 0) / np.maximum(count, 1), np.nan)
    between = np.sqrt(
        np.nansum((means - middle) ** 2, 0) / np.maximum(count - 1, 1) / np.maximum(count, 1)
    )
    return middle, np.hypot(own, between)


def _leans(signals: Signals, error: np.ndarray) -> float:
    """Angle by which a vertical leans that makes an accelerometer's error [rad]; 0 where it lies
    not in the horizontal plane.
    """
    if signals.base is None or not np.isfinite(error).all():
        return 0.0
    rotation = np.nanmean(signals.base.rotation, 0) @ signals.subject.imu_rotation
    world = rotation @ error
    strength = max(float(np.linalg.norm(signals.subject.gravity)), 1e-9)
    up = signals.subject.gravity / strength
    upright = float(world @ up)
    across = float(np.linalg.norm(world - upright * up))
    return across / strength if abs(upright) < UPRIGHT * across else 0.0
