"""The log that a recorder writes of a robot on its feet."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.validation.blind.plants.walking import WalkingPlant, WalkingTrace, pad_names
from hyperleg_design.validation.blind.recorder import Recorder, gains_of
from hyperleg_design.validation.blind.robots.chain import Chain

FORCE_NOISE = 0.6
"""Of a pad's load cell [N]."""
ESTIMATE = (4e-4, 3e-4, 4e-3)
"""Noise of the base's estimated position [m], orientation [rad] and velocity [m/s]."""
INERTIAL = (2e-3, 0.04)
"""Noise of gyro [rad/s] and accelerometer [m/s^2]."""


def walking_log(
    plant: WalkingPlant,
    trace: WalkingTrace,
    robot: Chain,
    recorder: Recorder,
    rng: np.random.Generator,
    name: str,
    metadata: dict[str, Any],
) -> Log:
    """Record a run as an estimator and the drives of a real robot would tell of it.

    Args:
        plant: that ran.
        trace: of the run.
        robot: its chain.
        recorder: rate, noise and losses of the recording.
        rng: source of randomness.
        name: of the log.
        metadata: further fields of the log's metadata.

    Returns:
        The log.
    """
    rows = recorder.rows(len(trace.targets), trace.time, rng)
    keep = rows.keep
    signals: dict[str, np.ndarray] = {}

    def put(kind: str, names: Sequence[str], values: np.ndarray, noise: Any) -> None:
        at = rows.at(values)
        at = at + rng.standard_normal(at.shape) * noise
        signals.update({f"{kind}/{n}": at[keep, k] for k, n in enumerate(names)})

    put("position", robot.joints, trace.encoder, recorder.position_noise)
    put("velocity", robot.joints, trace.speed, recorder.velocity_noise)
    put("motor_torque_command", robot.motors, trace.command, 0.0)
    put("motor_torque", robot.motors, trace.drive_torque, recorder.torque_noise * robot.peak_torque)
    put("gyro", "xyz", trace.gyro, INERTIAL[0])
    put("accelerometer", "xyz", trace.accelerometer, INERTIAL[1])
    put("base_position", "xyz", trace.base[:, :3], ESTIMATE[0])
    put("base_orientation", "wxyz", trace.base[:, 3:7], ESTIMATE[1] / 2)
    put("base_velocity", "xyz", trace.base[:, 7:], ESTIMATE[2])
    for k, pad in enumerate(pad_names(plant.model)):
        put("contact_force", [f"{pad}_{a}" for a in "xyz"], trace.contact[:, k], FORCE_NOISE)
    signals.update(
        {f"position_target/{j}": trace.targets[keep, k] for k, j in enumerate(robot.joints)}
    )
    length = np.sqrt(sum(signals[f"base_orientation/{a}"] ** 2 for a in "wxyz"))
    for a in "wxyz":
        signals[f"base_orientation/{a}"] = signals[f"base_orientation/{a}"] / length
    known: dict[str, Any] = {"robot": robot.robot, "base": "floating", "gains": gains_of(robot)}
    return Log(name, rows.written[keep], signals, Metadata(**{**known, **metadata}))
