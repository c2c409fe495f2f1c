"""From what truly happened to a log: a clock that jitters, rows that get lost, quantised and noisy
signals, some of them absent.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.validation.blind.robots.chain import Chain

if TYPE_CHECKING:
    from hyperleg_design.gap.logs.log import Log

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
    from hyperleg_design.gap.logs.log import Log
    from hyperleg_design.gap.logs.metadata import Metadata

    ticks = np.arange(len(targets)) / recorder.rate
    read = np.clip(ticks + np.abs(rng.normal(0, recorder.jitter, ticks.size)), 0, trace.time[-1])
    keep = rng.random(ticks.size) >= recorder.dropped
    keep[[0, -1]] = True
    written = read + rng.normal(0, recorder.clock, ticks.size)
    keep[1:] &= np.diff(np.maximum.accumulate(written)) > 1e-5
    place = read / (trace.time[1] - trace.time[0])
    below = np.minimum(place.astype(int), trace.time.size - 2)
    share = (place - below)[:, None]

    def at(values: np.ndarray) -> np.ndarray:
        return values[below] * (1 - share) + values[below + 1] * share

    def noisy(values: np.ndarray, level: Any) -> np.ndarray:
        return values + rng.standard_normal(values.shape) * level

    signals: dict[str, np.ndarray] = {}

    def put(kind: str, names: tuple[str, ...], values: np.ndarray) -> None:
        signals.update(
            {f"{kind}/{name}": values[keep, column] for column, name in enumerate(names)}
        )

    put("position_target", chain.joints, targets)
    put("position", chain.joints, noisy(at(trace.encoder), recorder.position_noise))
    speed, drive = (
        noisy(at(trace.speed), recorder.velocity_noise),
        noisy(at(trace.drive_torque), recorder.torque_noise * chain.peak_torque),
    )
    if recorder.velocity:
        put("velocity", chain.joints, speed)
    if recorder.torque == "motor_current":
        put("motor_current", chain.motors, drive / chain.torque_constant)
    elif recorder.torque == "motor_torque":
        put("motor_torque", chain.motors, drive)
    if recorder.torque in ("motor_torque", "motor_torque_command"):
        put("motor_torque_command", chain.motors, trace.command[below])
    if recorder.drives:
        put("motor_temperature", chain.motors, np.round(at(trace.temperature)))
        signals["battery_voltage"] = np.round(
            noisy(at(trace.voltage[:, None])[:, 0], 0.02)[keep], 2
        )
    if recorder.rotors:
        put("motor_velocity", chain.motors, noisy(at(trace.motor_velocity), recorder.rotor_noise))
    known: dict[str, Any] = {
        "base": "fixed",
        "gains": {
            j: (float(k), float(d))
            for j, k, d in zip(chain.joints, chain.stiffness, chain.damping, strict=True)
        },
    }
    if recorder.torque == "motor_current":
        known["torque_constant"] = dict(
            zip(chain.motors, chain.torque_constant.tolist(), strict=True)
        )
    return Log(name, written[keep], signals, Metadata(**{**known, **metadata}))
