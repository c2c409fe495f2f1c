"""From what truly happened to a log: a clock that jitters, rows that get lost, quantised and noisy
signals, some of them absent.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.validation.blind.robots.chain import Chain

TORQUES = ("motor_current", "motor_torque", "motor_torque_command", "none")
"""What a rig may know of its torques."""


@dataclass(frozen=True)
class Recorder:
    """How a rig logs; levels are standard deviations."""

    rate: float = 200.0
    """[Hz]"""
    jitter: float = 0.2e-3
    """Of the moment at which a row is read [s]."""
    clock: float = 20e-6
    """Of the time written beside it [s]."""
    dropped: float = 0.002
    """Share of rows lost."""
    torque: str = "motor_current"
    """One of `TORQUES`."""
    velocity: bool = True
    """Whether speeds are logged."""
    drives: bool = True
    """Whether motor temperature and battery voltage are logged."""
    rotors: bool = False
    """Whether speeds of the rotors are logged."""
    position_noise: float = 5e-5
    """[rad]"""
    velocity_noise: float = 0.006
    """[rad/s]"""
    torque_noise: float = 0.003
    """Over the motor's peak torque [-]."""
    rotor_noise: float = 0.02
    """Of the rotors' speeds [rad/s]."""

    def rows(self, count: int, time: np.ndarray, rng: np.random.Generator) -> Rows:
        """Draw when the rows of a log are read, and which of them are lost.

        Args:
            count: rows, were none lost.
            time: evenly spaced times of a run `(k,)` [s].
            rng: source of randomness.

        Returns:
            The rows.
        """
        ticks = np.arange(count) / self.rate
        read = np.clip(ticks + np.abs(rng.normal(0, self.jitter, count)), 0, time[-1])
        keep = rng.random(count) >= self.dropped
        keep[[0, -1]] = True
        written = read + rng.normal(0, self.clock, count)
        keep[1:] &= np.diff(np.maximum.accumulate(written)) > 1e-5
        place = read / (time[1] - time[0])
        below = np.minimum(place.astype(int), time.size - 2)
        return Rows(keep, written, below, (place - below)[:, None])


@dataclass(frozen=True, eq=False)
class Rows:
    """When the rows of a log are read, `t` of them."""

    keep: np.ndarray
    """Which are not lost `(t,)` of bool."""
    written: np.ndarray
    """Time that is written beside each `(t,)` [s]."""
    below: np.ndarray
    """Tick of the run before each `(t,)`."""
    share: np.ndarray
    """How far each is from that tick to the next one `(t, 1)` [-]."""

    def at(self, values: np.ndarray) -> np.ndarray:
        """Interpolate what happened to the moments at which rows are read.

        Args:
            values: at the ticks of the run `(k, columns)`.

        Returns:
            The values at the rows `(t, columns)`.
        """
        return values[self.below] * (1 - self.share) + values[self.below + 1] * self.share


def gains_of(chain: Chain) -> dict[str, tuple[float, float]]:
    """Gains of the joint controllers, as a log's metadata hold them.

    Args:
        chain: the robot.

    Returns:
        Stiffness [Nm/rad] and damping [Nms/rad] by joint.
    """
    return {
        joint: (float(k), float(d))
        for joint, k, d in zip(chain.joints, chain.stiffness, chain.damping, strict=True)
    }


def record(
    trace: Any,
    targets: np.ndarray,
    chain: Chain,
    recorder: Recorder,
    rng: np.random.Generator,
    *,
    name: str,
    **metadata: Any,
) -> Log:
    """A log of one run.

    Args:
        trace: `Trace` of a plant.
        targets: that were sent `(ticks, n)` [rad].
        chain: nominal robot; its gains and torque constants are declared.
        recorder: how the rig logs.
        rng: for jitter, noise and lost rows.
        name: of the log.
        metadata: of the log, in place of what the robot gives.
    """
    rows = recorder.rows(len(targets), trace.time, rng)
    keep, at = rows.keep, rows.at

    def noisy(values: np.ndarray, level: Any) -> np.ndarray:
        return values + rng.standard_normal(values.shape) * level

    signals: dict[str, np.ndarray] = {}

    def put(kind: str, names: tuple[str, ...], values: np.ndarray) -> None:
        signals.update(
            {f"{kind}/{name}": values[keep, column] for column, name in enumerate(names)}
        )

    put("position_target", chain.joints, targets)
    put("position", chain.joints, noisy(at(trace.encoder), recorder.position_noise))
    speed = noisy(at(trace.speed), recorder.velocity_noise)
    drive = noisy(at(trace.drive_torque), recorder.torque_noise * chain.peak_torque)
    if recorder.velocity:
        put("velocity", chain.joints, speed)
    if recorder.torque == "motor_current":
        put("motor_current", chain.motors, drive / chain.torque_constant)
    elif recorder.torque == "motor_torque":
        put("motor_torque", chain.motors, drive)
    if recorder.torque in ("motor_torque", "motor_torque_command"):
        put("motor_torque_command", chain.motors, trace.command[rows.below])
    if recorder.drives:
        put("motor_temperature", chain.motors, np.round(at(trace.temperature)))
        signals["battery_voltage"] = np.round(
            noisy(at(trace.voltage[:, None])[:, 0], 0.02)[keep], 2
        )
    if recorder.rotors:
        put("motor_velocity", chain.motors, noisy(at(trace.motor_velocity), recorder.rotor_noise))
    known: dict[str, Any] = {"base": "fixed", "gains": gains_of(chain)}
    if recorder.torque == "motor_current":
        known["torque_constant"] = dict(
            zip(chain.motors, chain.torque_constant.tolist(), strict=True)
        )
    return Log(name, rows.written[keep], signals, Metadata(**{**known, **metadata}))
