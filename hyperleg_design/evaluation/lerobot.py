"""Evaluations as LeRobot datasets (codebase v3.0): one episode a trial, one frame a policy step.

`observation.state`, `observation.velocity` and `observation.effort` are positions [rad], velocities
[rad/s] and torques [Nm] of the joints before friction; `action` is what the joint controllers were
asked for [rad]. `observation.base_position` [m], `observation.base_orientation` (w, x, y, z) and
`observation.base_velocity` [m/s] are those of the root link in the world. The task of an episode is
the name of its protocol.

Beside what LeRobot reads, the folder holds `hyperleg.json`, the metadata that a diagnosis reads
(unit of the positions, gains of the joint controllers, base, gravity), and the design of the robot.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.build import design_yaml
from hyperleg_design.robot.models import GRAVITY
from hyperleg_design.simulation.drives.actuation import actuation_model
from hyperleg_design.writing import output_folder, write_json, write_text

if TYPE_CHECKING:
    from hyperleg_design.evaluation.result import Evaluation
    from hyperleg_design.evaluation.rollout import Trial
    from hyperleg_design.robot.parameters.described import RobotDesign

VERSION = "v3.0"
"""Version of LeRobot's dataset format."""
TABLE = "chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
SIGNALS = {
    "observation.state": "joint_position",
    "observation.velocity": "joint_velocity",
    "observation.effort": "driven_joint_torque",
    "action": "joint_target",
}
"""Signal of a trial by feature."""
BASE = {
    "observation.base_position": ("base_position", ("x", "y", "z")),
    "observation.base_orientation": ("base_orientation", ("w", "x", "y", "z")),
    "observation.base_velocity": ("base_velocity", ("x", "y", "z")),
}
"""Signal of a trial and names of its columns by feature of the root link."""
METADATA = "hyperleg.json"
"""File of the metadata for a diagnosis."""
COUNTERS = ("frame_index", "episode_index", "index", "task_index")
QUANTILES = {"q01": 0.01, "q10": 0.1, "q50": 0.5, "q90": 0.9, "q99": 0.99}


def write_lerobot(folder: str | os.PathLike[str], evaluations: Sequence[Evaluation]) -> Path:
    """Write the trials of evaluations as one dataset.

    Args:
        folder: to write, whole or not at all.
        evaluations: of robots with the same joints and policy rate, with the signals of their
            trials; trials without a frame are left out.

    Returns:
        The folder.

    Raises:
        InputError: no trial with signals, or robots whose joints or rates differ.
        OutputError: the folder is not ours, or cannot be written.
    """
    import pandas as pd
    import pyarrow as pa
    import pyarrow.parquet as pq

    trials = [
        (trial, str(evaluation.protocol.name))
        for evaluation in evaluations
        for trial in evaluation.trials
        if trial.samples and trial.joint_target is not None
    ]
    if not trials:
        raise InputError("lerobot", "trials", 0, "expects trials with their signals")
    joints, rate = trials[0][0].layout.joints, _rate(trials[0][0])
    for trial, _ in trials:
        if trial.layout.joints != joints or _rate(trial) != rate:
            raise InputError(
                "lerobot",
                "joints",
                list(trial.layout.joints),
                f"differ between robots: expects {', '.join(joints)} at {rate} Hz in one dataset",
            )
    tasks = list(dict.fromkeys(task for _, task in trials))
    designs = _different({id(trial.design): trial.design for trial, _ in trials}.values())
    columns, episodes, first = [], [], 0
    for number, (trial, task) in enumerate(trials):
        frames = _frames(trial, rate)
        count = len(frames["timestamp"])
        frames |= {
            "frame_index": np.arange(count),
            "episode_index": np.full(count, number),
            "index": np.arange(first, first + count),
            "task_index": np.full(count, tasks.index(task)),
        }
        columns.append(frames)
        episodes.append(_episode(number, task, first, frames))
        first += count
    table = {name: np.concatenate([part[name] for part in columns]) for name in columns[0]}
    with output_folder(folder) as place:
        for sub in ("data", "meta/episodes"):
            (place / sub / "chunk-000").mkdir(parents=True)
        path = TABLE.format(chunk_index=0, file_index=0)
        pq.write_table(pa.table({n: _arrow(v) for n, v in table.items()}), place / "data" / path)
        pq.write_table(pa.Table.from_pylist(episodes), place / "meta/episodes" / path)
        pd.DataFrame(
            {"task_index": range(len(tasks))}, index=pd.Index(tasks, name="task")
        ).to_parquet(place / "meta" / "tasks.parquet")
        write_json(place / "meta" / "stats.json", {n: _statistics(v) for n, v in table.items()})
        robot = evaluations[0].design
        write_json(place / "meta" / "info.json", _info(robot, joints, rate, trials, tasks, first))
        write_json(place / METADATA, _metadata(designs, joints))
        if len(designs) == 1:
            write_text(place / _robot_file(designs[0]), design_yaml(designs[0]))
    return Path(folder)


def _different(designs: Iterable[RobotDesign]) -> list[RobotDesign]:
    """Designs without repeats."""
    return list({json.dumps(design.to_mapping()): design for design in designs}.values())


def _robot_file(design: RobotDesign) -> str:
    return f"{''.join(c if c.isalnum() or c in '-.' else '_' for c in design.name)}.yaml"


def _metadata(designs: Sequence[RobotDesign], joints: tuple[str, ...]) -> dict[str, Any]:
    """What a diagnosis has to know of the dataset; robot and gains where all trials share them."""
    gains = {tuple(_gains(design, len(joints))) for design in designs}
    known: dict[str, Any] = {
        "units": {"position": "rad"},
        "base": "floating",
        "gravity": [0.0, 0.0, -GRAVITY],
        "targets": "kept",
        "notes": "simulated",
    }
    if len(gains) == 1:
        known["gains"] = dict(zip(joints, map(list, gains.pop()), strict=True))
    if len(designs) == 1:
        known["robot"] = _robot_file(designs[0])
    return known


def _gains(design: RobotDesign, joints: int) -> list[tuple[float, float]]:
    """Stiffness [Nm/rad] and damping [Nms/rad] of each joint of all limbs."""
    model = actuation_model(design)
    limb = list(zip(model.stiffness.tolist(), model.damping.tolist(), strict=True))
    return limb * (joints // len(limb))


def _rate(trial: Trial) -> int:
    """Policy steps in a second."""
    return round(1 / (trial.time_step * trial.substeps))


def _frames(trial: Trial, rate: int) -> dict[str, np.ndarray]:
    """Signals at the start of each policy step, and the time since the episode's start [s]."""
    signals = SIGNALS | {feature: signal for feature, (signal, _) in BASE.items()}
    columns = {
        feature: np.asarray(getattr(trial, signal), np.float32)[:: trial.substeps]
        for feature, signal in signals.items()
    }
    count = len(columns["observation.state"])
    return {**columns, "timestamp": (np.arange(count) / rate).astype(np.float32)}


def _episode(
    number: int, task: str, first: int, frames: Mapping[str, np.ndarray]
) -> dict[str, Any]:
    count = len(frames["timestamp"])
    row: dict[str, Any] = {
        "episode_index": number,
        "tasks": [task],
        "length": count,
        "data/chunk_index": 0,
        "data/file_index": 0,
        "dataset_from_index": first,
        "dataset_to_index": first + count,
        "meta/episodes/chunk_index": 0,
        "meta/episodes/file_index": 0,
    }
    for name, values in frames.items():
        row |= {f"stats/{name}/{key}": value for key, value in _statistics(values).items()}
    return row


def _statistics(values: np.ndarray) -> dict[str, list[float] | list[int]]:
    """Statistics of a feature over its frames, one number a component."""
    rows = np.asarray(values, float).reshape(len(values), -1)
    statistics: dict[str, list[float] | list[int]] = {
        "min": rows.min(0).tolist(),
        "max": rows.max(0).tolist(),
        "mean": rows.mean(0).tolist(),
        "std": rows.std(0).tolist(),
        "count": [len(rows)],
    }
    return statistics | {
        name: np.quantile(rows, q, axis=0).tolist() for name, q in QUANTILES.items()
    }


def _arrow(values: np.ndarray) -> Any:
    import pyarrow as pa

    if values.ndim == 1:
        return pa.array(values)
    return pa.FixedSizeListArray.from_arrays(pa.array(values.ravel()), values.shape[1])


def _info(
    robot: str,
    joints: tuple[str, ...],
    rate: int,
    trials: Sequence[Any],
    tasks: Sequence[str],
    frames: int,
) -> dict[str, Any]:
    columns = dict.fromkeys(SIGNALS, joints) | {name: own for name, (_, own) in BASE.items()}
    features: dict[str, Any] = {
        feature: {"dtype": "float32", "shape": [len(names)], "names": list(names)}
        for feature, names in columns.items()
    }
    features["timestamp"] = {"dtype": "float32", "shape": [1], "names": None}
    features |= {name: {"dtype": "int64", "shape": [1], "names": None} for name in COUNTERS}
    return {
        "codebase_version": VERSION,
        "robot_type": robot,
        "total_episodes": len(trials),
        "total_frames": frames,
        "total_tasks": len(tasks),
        "chunks_size": 1000,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 200,
        "fps": rate,
        "splits": {"train": f"0:{len(trials)}"},
        "data_path": f"data/{TABLE}",
        "video_path": None,
        "features": features,
    }
