"""Logs of simulations: evaluation trials and plain rollouts, with every signal that the simulator
knows.

Each row is the state at the start of a simulation step and what acted during it. Position targets
are those of the joint controllers; the motor torque command is what they ask of the motors before
any limit, `M^-1 (stiffness (target - position) - damping velocity)`; the joint torque is `M` times
the motor torque, before friction. The accelerometer sits at the pelvis's origin and gives the mean
over the step, the change of velocity that the simulation made of it; the last row has none.
Velocities of the base are those at the time of its places, as sensors would give them; those of the
joints are what the controller knows. With an overlay, joint states, motor torques and IMU are what
encoders, drives and sensors tell of them, the motor torque command is that of the controller, and
the joint torque is the model's `M` times what drives take themselves to give.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.result import Evaluation
from hyperleg_design.evaluation.rollout import Trial
from hyperleg_design.gap.logs.columns import columns_of
from hyperleg_design.gap.logs.log import Log, write_log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.robot.models import GRAVITY, quaternion_matrix
from hyperleg_design.robot.motors import find_motor
from hyperleg_design.robot.parameters.described import RobotDesign
from hyperleg_design.simulation.drives.actuation import ActuationModel, actuation_model
from hyperleg_design.simulation.drives.told import TOLD
from hyperleg_design.simulation.layout import Layout
from hyperleg_design.writing import output_folder, write_text

JOINT_SIGNALS = {
    "position_target": "joint_target",
    "position": "joint_position",
    "velocity": "joint_velocity",
    "joint_torque": "driven_joint_torque",
}
"""Signal of a simulation by that of a log."""
BASE = ("base_position", "base_orientation", "base_velocity", "base_angular_velocity")
TRIAL_SIGNALS = (*BASE, *JOINT_SIGNALS.values(), "motor_torque", "motor_velocity", "pad_force")
"""Signals of a simulated trial from which a log is made; `base_angular_velocity` and `joint_target`
may be missing."""


def log_of_trial(
    trial: Trial, *, name: str = "trial", metadata: Mapping[str, Any] | None = None
) -> Log:
    """Make the log of one evaluation trial, with a row for each simulation step.

    Args:
        trial: a walk, a T-test, or any other, with two samples at least.
        name: of the log.
        metadata: fields of `Metadata` to replace, such as `robot` or `session`.

    Returns:
        The log.

    Raises:
        InputError: a trial that ended at once.
    """
    samples = {n: getattr(trial, n) for n in TRIAL_SIGNALS} | dict(trial.told)
    extra = {"outcome": trial.outcome, "end_time": trial.end_time}
    return log_of_signals(
        trial.design,
        trial.layout,
        trial.time_step,
        {n: v for n, v in samples.items() if v is not None},
        name,
        {"extra": extra, **(metadata or {})},
    )


def write_logs(folder: str | os.PathLike[str], evaluations: Sequence[Evaluation]) -> list[Path]:
    """Write every kept trial of some evaluations as `POLICY_PROTOCOL_TRIAL.parquet`, with the
    robots' designs beside them.

    Trials with fewer than two samples are left out.

    Args:
        folder: to be written.
        evaluations: whose kept trials are written.

    Returns:
        The files, in the order of the trials.

    Raises:
        OutputError: the folder is somebody else's, or cannot be written; nothing half-written is
        left.
    """
    names: list[str] = []
    robots: dict[str, str] = {}
    with output_folder(folder) as place:
        for number, evaluation in enumerate(evaluations):
            stem = f"{_file_name(evaluation.policy)}_{_file_name(evaluation.protocol.name)}"
            if any(name.startswith(f"{stem}_") for name in names):
                stem = f"{stem}_{number}"
            for index, trial in enumerate(evaluation.trials):
                if trial.samples < 2:
                    continue
                name = f"{stem}_{index:03d}"
                protocol, policy = evaluation.protocol.name, evaluation.policy
                metadata = {
                    "robot": _robot_file(trial.design, robots),
                    "session": stem,
                    "notes": f"trial {index} of {protocol} with {policy}, simulated",
                }
                log = log_of_trial(trial, name=name, metadata=metadata)
                write_log(place / f"{name}.parquet", log)
                names.append(f"{name}.parquet")
        for robot, text in robots.items():
            write_text(place / robot, text)
    return [Path(folder) / name for name in names]


def _robot_file(design: RobotDesign, robots: dict[str, str]) -> str:
    """Name of the file of a design; a new one where its content differs from those there."""
    import yaml

    text = yaml.safe_dump(design.to_mapping(), sort_keys=False)
    for name, known in robots.items():
        if known == text:
            return name
    stem = _file_name(design.name)
    name = f"{stem}.yaml" if f"{stem}.yaml" not in robots else f"{stem}_{len(robots)}.yaml"
    robots[name] = text
    return name


def _file_name(name: str) -> str:
    return "".join(
        c if c.isalnum() or c in "-." else "_" for c in Path(name).name.removesuffix(".onnx")
    )


def log_of_signals(
    design: RobotDesign,
    layout: Layout,
    time_step: float,
    samples: Mapping[str, np.ndarray],
    name: str,
    metadata: Mapping[str, Any],
) -> Log:
    """Make the log of the signals of one simulation.

    Args:
        design: the robot.
        layout: of its simulation.
        time_step: of the simulation [s].
        samples: `TRIAL_SIGNALS`, and what drives and sensors tell, `(t, ...)` each.
        name: of the log.
        metadata: fields of `Metadata` to replace.

    Returns:
        The log.

    Raises:
        InputError: fewer than two samples.
    """
    rows = len(samples["joint_position"])
    if rows < 2:
        raise InputError(name, "samples", rows, "ended at once: a log needs two samples at least")
    model, limbs = actuation_model(design), len(layout.limbs)
    samples = _as_reported(model, limbs, samples)
    known = {kind: samples[n] for kind, n in JOINT_SIGNALS.items() if n in samples}
    signals = columns_of(known, layout.joints) | _motor_signals(design, layout, samples)
    signals |= _base_signals(samples, time_step) | _contact_signals(layout, samples["pad_force"])
    pairs = np.tile(np.column_stack([model.stiffness, model.damping]), (limbs, 1)).tolist()
    gains = {joint: (k, d) for joint, (k, d) in zip(layout.joints, pairs, strict=True)}
    constants = dict(zip(layout.motors, _torque_constants(design, layout).tolist(), strict=True))
    defaults: dict[str, Any] = {
        "robot": design.name,
        "base": "floating",
        "gains": gains,
        "torque_constant": constants,
        "gravity": (0, 0, -GRAVITY),
    }
    return Log(name, np.arange(rows) * time_step, signals, Metadata(**(defaults | dict(metadata))))


def _as_reported(
    model: ActuationModel, limbs: int, samples: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Signals as drives and sensors of a simulation with alterations report them, in place of the
    true ones.
    """
    reported = {
        name.removeprefix(TOLD): values for name, values in samples.items() if name.startswith(TOLD)
    }
    samples = dict(samples)
    if not reported:
        return samples
    samples["base_angular_velocity"] = reported.pop("angular_velocity")
    samples |= reported
    legs = (len(reported["motor_torque"]), limbs, -1)
    samples["driven_joint_torque"] = (
        reported["motor_torque"].reshape(legs) @ model.joint_from_motor.T
    ).reshape(legs[0], -1)
    return samples


def _motor_signals(
    design: RobotDesign, layout: Layout, samples: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    columns = {
        "motor_torque": samples["motor_torque"],
        "motor_current": samples["motor_torque"] / _torque_constants(design, layout),
        "motor_velocity": samples["motor_velocity"],
    }
    if "motor_command" in samples:
        columns = {"motor_torque_command": samples["motor_command"], **columns}
    elif "joint_target" in samples:
        model, legs = actuation_model(design), (len(samples["joint_target"]), len(layout.limbs), -1)
        error = (samples["joint_target"] - samples["joint_position"]).reshape(legs)
        torque = model.stiffness * error - model.damping * samples["joint_velocity"].reshape(legs)
        command = (torque @ model.motor_from_joint.T).reshape(len(torque), -1)
        columns = {"motor_torque_command": command, **columns}
    return columns_of(columns, layout.motors)


def _torque_constants(design: RobotDesign, layout: Layout) -> np.ndarray:
    """Of the motors of all limbs, before any gear, `(K,)` [Nm/A]."""
    actuators = design.every_actuator[: layout.leg_motors]
    constants = [find_motor(str(actuator.motor)).torque_constant for actuator in actuators]
    return np.tile(np.array(constants), len(layout.limbs))


def _base_signals(samples: Mapping[str, np.ndarray], time_step: float) -> dict[str, np.ndarray]:
    velocity, orientation = samples["base_velocity"], samples["base_orientation"]
    acceleration = np.full_like(velocity, np.nan)
    acceleration[:-1] = np.diff(velocity, axis=0) / time_step
    rotation = quaternion_matrix(np.roll(orientation, -1, axis=-1).T)  # (3, 3, t)
    specific_force = np.einsum("jit,tj->ti", rotation, acceleration + np.array([0.0, 0.0, GRAVITY]))
    specific_force += samples.get("acceleration_error", 0.0)
    parts = {
        "accelerometer": specific_force,
        "base_position": samples["base_position"],
        "base_velocity": _at_its_time(velocity),
    }
    if "base_angular_velocity" in samples:
        parts = {"gyro": _at_its_time(samples["base_angular_velocity"]), **parts}
    return columns_of(parts, "xyz") | columns_of({"base_orientation": orientation}, "wxyz")


def _at_its_time(velocity: np.ndarray) -> np.ndarray:
    """Velocities `(t, k)` at the times of the positions beside them: those of MuJoCo, which steps
    velocities first, are half a step older.
    """
    centred = velocity.copy()
    centred[:-1] = (velocity[:-1] + velocity[1:]) / 2
    centred[-1] += (velocity[-1] - velocity[-2]) / 2
    return centred


def _contact_signals(layout: Layout, pad_force: np.ndarray) -> dict[str, np.ndarray]:
    """Forces on each foot, and on each of its pads."""
    feet = {foot: pad_force[:, layout.pad_foot == i].sum(1) for i, foot in enumerate(layout.feet)}
    pads = {pad: pad_force[:, i] for i, pad in enumerate(layout.pads)}
    return {
        f"contact_force/{place}_{axis}": force[:, i]
        for place, force in (feet | pads).items()
        for i, axis in enumerate("xyz")
    }
