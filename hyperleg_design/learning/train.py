"""Trainings: PPO around the environment, killed and resumed at will.

A training lives in a folder:

| file | holds |
|---|---|
| `run.json` | task, design, preset (all resolved), seed, command, versions, commit |
| `checkpoint.pt` | all that its future depends on; written whole or not at all |
| `status.json` | how far it is, with the latest measures |
| `progress.jsonl` | measures of every iteration, and trials |
| `late_*.onnx`, `policy.onnx` | late policies, and the last one, when the training is done |
| `critic.onnx` | the last critic, for a training that starts from the policy |
| `events.*` | the measures for TensorBoard |
"""

from __future__ import annotations

import contextlib
import fcntl
import json
import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import torch

from hyperleg_design import provenance
from hyperleg_design.errors import InputError
from hyperleg_design.learning.learner.algorithm import IterationPPO
from hyperleg_design.learning.learner.device import HOST, check_device
from hyperleg_design.learning.policies.start_policy import read_start
from hyperleg_design.learning.preset import Preset
from hyperleg_design.learning.preset_file import load_preset
from hyperleg_design.learning.records.status import (
    RUN,
)
from hyperleg_design.learning.resolved import preset_mapping, task_mapping
from hyperleg_design.learning.training import Training
from hyperleg_design.robot.load import changed_robot, load_robot
from hyperleg_design.robot.parameters.described import RobotDesign
from hyperleg_design.simulation.alteration import Alterations
from hyperleg_design.simulation.design_spread import DesignSpread, load_design_spread
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.tasks import Task, load_task
from hyperleg_design.writing import MARKER, check_output_folder, write_json, write_text

PACKAGES = (*provenance.PACKAGES, "torch", "rsl-rl-lib")


def train(
    task: str | Path | Task,
    design: str | Path | RobotDesign,
    seed: int,
    preset: str | Path | Preset,
    out: str | Path,
    *,
    overrides: Sequence[str] = (),
    overlays: Sequence[str] = (),
    start: str | Path | None = None,
    designs: str | Path | DesignSpread | None = None,
    threads: int = 1,
    device: str = HOST,
    iterations: int | None = None,
    alterations: Alterations | None = None,
    overlay: Mapping[str, Any] | None = None,
    show: Callable[[str], None] | None = None,
) -> bool:
    """Train a policy, or go on with a training from its last checkpoint.

    Args:
        task: a task, its shipped name or file.
        design: a robot, its shipped name (`hyperleg`, `toe_removed`, ...) or file.
        seed: of all randomness.
        preset: a preset, its shipped name or file.
        out: folder of the training.
        overrides: texts `path=value` to change of the robot.
        overlays: YAML files of its parameters that differ, applied before `overrides`.
        start: ONNX policy to start from, of another task or design, of a robot with the same
            joints; one that is conditioned on its design starts a training of one design inside of
            its ranges. From scratch by default.
        designs: what designs to draw from, with a shipped name or a file: the policy observes its
            design and learns them all. They are `design` with other leaves, each of which must
            change its simulation. Without, the policy learns the one design.
        threads: of physics and learning. One by default: trainings side by side use processors
            best. Resuming is bit for bit with the same number only.
        device: where the networks learn, as torch writes it (`cuda`); simulations and actions stay
            on the processor. Results on another device differ in their last digits.
        iterations: stop, with a checkpoint, after so many more; all by default.
        alterations: of the simulated robot, or what makes them for a design.
        overlay: what they are, as JSON takes it: written down, and compared when the training goes
            on.
        show: takes lines of progress.

    Returns:
        Whether the training is done; False after a signal to stop, or `iterations`.

    Raises:
        InputError: bad input, or `out` holds another training or is at work already.
        OutputError: something cannot be written; the training can go on from its last checkpoint.
    """
    words = ["hyperleg", "train", "--task", _name(task), "--design", _name(design)]
    words += ["--seed", str(seed), "--preset", _name(preset)]
    words += [word for file in overlays for word in ("--set-file", str(file))]
    words += [word for override in overrides for word in ("--set", override)]
    if start is not None:
        words += ["--start", f"{Path(str(start)).parent.name}/{Path(str(start)).name}"]
    if designs is not None:
        words += ["--designs", "designs" if isinstance(designs, DesignSpread) else str(designs)]
    spread = load_design_spread(designs) if isinstance(designs, str | Path) else designs
    task = task if isinstance(task, Task) else load_task(task)
    task = task.conditioned(spread.ranges) if spread else task
    design = design if isinstance(design, RobotDesign) else load_robot(design)
    if overrides or overlays:
        design = changed_robot(design, overrides=overrides, overlays=overlays)
    started = None if start is None else read_start(start, None if spread else design)
    preset = preset if isinstance(preset, Preset) else load_preset(preset)
    preset.stages(task.name)
    task.check_robot(layout_of(task.posed(design)), design.name)
    if spread:
        spread.check_robot(task.posed(design), task.physics)
    if check_device(device) != HOST and preset.algorithm.adapted != "iteration":
        remedy = f"expects a preset with algorithm.adapted: iteration, not {preset.name}"
        raise InputError("--device", "", device, remedy)
    folder = check_output_folder(out)
    origin = {
        "start": started and started.source,
        "overlay": overlay and dict(overlay),
        "designs": spread and spread.to_mapping(),
        "command": shlex.join(words),
    }
    description = {**describe(task, design, seed, preset), **origin}
    _check_same(folder, description)
    write_text(folder / MARKER, "made by hyperleg\n")
    with _alone(folder), _limited_threads(threads):
        if not (folder / RUN).exists():
            write_json(folder / RUN, {**description, "device": device})
        training = Training(
            task, design, seed, preset, folder, threads, description, started, alterations, spread
        )
        if isinstance(training.algorithm, IterationPPO):
            training.algorithm.update_device = device
        return training.run(iterations, show or (lambda line: None))


def describe(task: Task, design: RobotDesign, seed: int, preset: Preset) -> dict[str, Any]:
    """Describe a training, as JSON takes it.

    Args:
        task: what is trained for.
        design: the robot.
        seed: of all random numbers.
        preset: size, algorithm and stages.

    Returns:
        Nested mappings.
    """
    return {
        "task": task_mapping(task),
        "design": design.to_mapping(),
        "variant": design.variant,
        "seed": seed,
        "preset": preset_mapping(preset, task.name),
        "deviations": task.deviations,
        "commit": provenance.git_commit(),
        "versions": provenance.versions(PACKAGES),
    }


def _name(given: Any) -> str:
    return str(given.name if isinstance(given, Task | RobotDesign | Preset) else given)


def _check_same(folder: Path, description: dict[str, Any]) -> None:
    """Whether the folder is free for this training, or holds just this one."""
    path = folder / RUN
    if not path.exists():
        return
    try:
        content = json.loads(path.read_text())
    except (OSError, ValueError):
        raise InputError(
            f"{folder.name}/{RUN}",
            "",
            None,
            "cannot be read; choose another folder, or delete this one",
        ) from None
    for key in ("variant", "seed", "task", "design", "preset", "start", "overlay", "designs"):
        if content.get(key) != json.loads(json.dumps(description[key])):
            remedy = "the folder holds another training; choose another, or delete it"
            raise InputError(
                str(folder), key, content.get(key) if key in ("variant", "seed") else None, remedy
            )


@contextlib.contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Hold the folder; the system lets go of it however the process ends."""
    with (folder / ".lock").open("w") as stream:
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise InputError(
                str(folder),
                "",
                None,
                "a training is at work in this folder; wait for it or stop it",
            ) from None
        yield


@contextlib.contextmanager
def _limited_threads(threads: int) -> Iterator[None]:
    before = torch.get_num_threads()
    torch.set_num_threads(threads)
    try:
        yield
    finally:
        torch.set_num_threads(before)
