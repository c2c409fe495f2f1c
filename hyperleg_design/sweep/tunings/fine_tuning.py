"""Fine-tuning of a policy to one design, by `hyperleg train` in a process of its own.

The training starts from the policy, with the task and the learner that trained it, under the
rewards and commands of its end, on the one design. Where the policy is conditioned on its design,
the fine-tuned one is an ordinary policy of the one design.

    FOLDER/design.yaml         the design
    FOLDER/NAME.task.yaml      the policy's task
    FOLDER/NAME.preset.yaml    one stage of the given number of steps
    FOLDER/NAME/               the training, with its checkpoints; NAME is POLICY-STEPS
    FOLDER/NAME.log            what the training printed
"""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hyperleg_design.errors import InputError, OutputError, in_short
from hyperleg_design.evaluation.policy import load_policy
from hyperleg_design.evaluation.shipped import POLICY
from hyperleg_design.processes import run_side_by_side
from hyperleg_design.simulation.design_observation import RANGES, design_ranges
from hyperleg_design.writing import write_text

if TYPE_CHECKING:
    from hyperleg_design.evaluation.policy import OnnxPolicy
    from hyperleg_design.robot.parameters.described import RobotDesign

NEEDS = ("torch", "rsl_rl")
"""Modules of the extra `learning`, without which nothing can be trained."""
CHECKPOINT_EVERY = 5
"""Iterations between checkpoints, at most: a killed training repeats at most those; assumed."""
CRITIC_SHARE = 0.2
"""Share of the iterations in which only the critic learns, at most, where it starts anew; assumed.
Before it can judge the new design, it would teach the policy noise."""
DEVIATION = 0.3
"""Largest standard deviation of the actions at the start; that of `sim/preset_designs.yaml`, which
starts from walking policies, too."""
_STATUS = "status.json"


@dataclass(frozen=True)
class FineTuning:
    """One policy that is to be fine-tuned to one design."""

    policy: Path
    """ONNX file to start from."""
    design: RobotDesign
    """The design, one robot."""
    steps: int
    """Policy steps of all simulations together."""
    folder: Path
    """Where design, preset, training and log go."""

    @property
    def name(self) -> str:
        """Name of the training: that of the policy it starts from, and its steps."""
        return f"{self.policy.parent.name}-{self.steps}"

    @property
    def result(self) -> Path:
        """The fine-tuned policy; there when the training is done."""
        return self.folder / self.name / POLICY

    @property
    def log(self) -> Path:
        """What the training's process printed."""
        return self.folder / f"{self.name}.log"

    def steps_done(self) -> float:
        """Policy steps that the training has done so far."""
        if self.result.is_file():
            return float(self.steps)
        try:
            status = json.loads((self.folder / self.name / _STATUS).read_text())
            return min(float(status["steps"]), float(self.steps))
        except (OSError, ValueError, KeyError, TypeError):
            return 0.0


def check_trainable(path: Path) -> OnnxPolicy:
    """Load a policy that a fine-tuning can start from.

    Args:
        path: its ONNX file.

    Returns:
        The policy.

    Raises:
        InputError: the extra `learning` is not installed, or the policy does not say how it was
            trained.
    """
    missing = [name for name in NEEDS if importlib.util.find_spec(name) is None]
    if missing:
        raise InputError(
            "--finetune", "", None, f"needs {', '.join(missing)}: install hyperleg-design[learning]"
        )
    policy = load_policy(path)
    preset = policy.metadata.get("preset")
    if not isinstance(preset, dict) or policy.task.name not in preset.get("tasks", {}):
        raise InputError(
            "--finetune", "", policy.name, "does not say with which preset it was trained"
        )
    return policy


def fine_tuning_preset(policy: OnnxPolicy, steps: int) -> dict[str, Any]:
    """The preset of a fine-tuning, as `hyperleg train --preset` reads it from YAML.

    It has the sizes, learner and network of the policy's own training, and one stage: the rewards,
    commands, gait clock and action deviation at which that training ended, without assist.

    Args:
        policy: that it starts from; see `check_trainable`.
        steps: policy steps of all simulations together.
    """
    own = dict(policy.metadata["preset"])
    stage: dict[str, Any] = {
        "name": "fine-tuning",
        "steps": float(steps),
        "assist": 0.0,
        **_last_values(own["tasks"][policy.task.name]),
    }
    deviations = [r["to"] for r in stage["ramps"] if r["set"] == "policy.deviation"]
    iterations = steps / (own.get("simulations", 256) * own.get("rollout", 32))
    warm = dict(own.get("warm_start", {}))
    warm["deviation"] = min([DEVIATION, *deviations])
    alone = min(float(warm.get("critic_iterations", 20)), CRITIC_SHARE * iterations)
    warm["critic_iterations"] = int(alone)
    return {
        **own,
        "name": "fine_tuning",
        "checkpoint_every": min(CHECKPOINT_EVERY, own.get("checkpoint_every", CHECKPOINT_EVERY)),
        "late": 1,
        "final_share": 0.0,
        "warm_start": warm,
        "tasks": {policy.task.name: [stage]},
    }


def _last_values(stages: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Rewards, commands and ramps that hold the values which the stages of a training end with."""
    rewards: dict[str, dict[str, float]] = {}
    commands: dict[str, float] = {}
    held: dict[str, float] = {}
    for stage in stages:
        for term, values in stage.get("rewards", {}).items():
            own = values if isinstance(values, Mapping) else {"weight": values}
            rewards.setdefault(term, {}).update(own)
        commands.update(stage.get("commands", {}))
        for ramp in stage.get("ramps", ()):
            kind, _, rest = str(ramp["set"]).partition(".")
            term, _, setting = rest.partition(".")
            if kind == "rewards":
                rewards.setdefault(term, {})[setting or "weight"] = ramp["to"]
            elif kind == "commands":
                commands[term] = ramp["to"]
            else:
                held[str(ramp["set"])] = ramp["to"]
    ramps = [{"set": name, "from": v, "to": v, "steps": 1} for name, v in held.items()]
    return {"rewards": rewards, "commands": commands, "ramps": ramps}


def fine_tune(trainings: Sequence[FineTuning], *, workers: int, progress: bool = True) -> None:
    """Run the trainings that are not finished yet, some side by side.

    A training that was stopped goes on from its last checkpoint. When this process is interrupted,
    the trainings write checkpoints and stop.

    Args:
        trainings: what to train.
        workers: processes side by side, of one thread each.
        progress: show a bar.

    Raises:
        InputError: a training failed; the others are finished, and its log says why.
        OutputError: a folder holds the fine-tuning of another design.
    """
    from tqdm import tqdm

    for training in trainings:
        _write_inputs(training)
    waiting = [training for training in trainings if not training.result.is_file()]
    total = sum(training.steps for training in trainings)
    with tqdm(
        total=total, disable=not progress, unit="step", unit_scale=True, desc="fine-tuning"
    ) as bar:
        run_side_by_side(
            waiting,
            _started,
            workers=workers,
            watch=lambda: bar.update(sum(t.steps_done() for t in trainings) - bar.n),
        )
    failed = [training for training in waiting if not training.result.is_file()]
    if failed:
        first = failed[0]
        raise InputError(
            "--finetune",
            f"{first.folder.name}/{first.name}",
            None,
            f"the training failed: {_last_line(first.log)}; its log is {first.log}"
            + (f", and {len(failed) - 1} more failed" if len(failed) > 1 else ""),
        )


def write_design(design: RobotDesign, folder: Path) -> None:
    """Write a design as `FOLDER/design.yaml`, which `hyperleg train --design` reads.

    Args:
        design: one robot.
        folder: that is made where it is missing.

    Raises:
        OutputError: the file holds another design.
    """
    _write_once(folder / "design.yaml", design.to_mapping())


def _write_inputs(training: FineTuning) -> None:
    """Write the design, the task and the preset as files that `hyperleg train` reads."""
    policy = check_trainable(training.policy)
    if RANGES in policy.metadata:
        ranges = design_ranges(policy.metadata[RANGES], f"{policy.name}: {RANGES}")
        ranges.check_inside(training.design, policy.name)
    place, name = training.folder, training.name
    write_design(training.design, place)
    _write_once(place / f"{name}.task.yaml", _task_of_one_design(policy.metadata["task"]))
    _write_once(place / f"{name}.preset.yaml", fine_tuning_preset(policy, training.steps))


def _write_once(path: Path, content: Mapping[str, Any]) -> None:
    """Write a mapping as YAML, but never over another one."""
    import yaml

    text = yaml.safe_dump(dict(content), sort_keys=False)
    if path.is_file() and path.read_text(encoding="utf-8") != text:
        raise OutputError(
            f"{path}: is of another design or another run; choose another --out, or delete the "
            f"folder {path.parent.name}"
        )
    write_text(path, text)


def _task_of_one_design(task: Mapping[str, Any]) -> dict[str, Any]:
    """A policy's task, without the design in what it observes."""
    parts = {
        group: [part for part in observed if part != "design"]
        for group, observed in task["observations"].items()
    }
    return {key: task[key] for key in task if key != "designs"} | {"observations": parts}


def _started(training: FineTuning) -> subprocess.Popen[bytes]:
    place = training.folder
    arguments = {
        "task": place / f"{training.name}.task.yaml",
        "design": place / "design.yaml",
        "preset": place / f"{training.name}.preset.yaml",
        "seed": max(load_policy(training.policy).seed, 0),
        "start": training.policy.resolve(),
        "out": place / training.name,
    }
    command = [sys.executable, "-m", "hyperleg_design.cli", "train"]
    for name, value in arguments.items():
        command += [f"--{name}", str(value)]
    with training.log.open("ab") as stream:
        return subprocess.Popen(command, stdout=stream, stderr=stream, stdin=subprocess.DEVNULL)


def _last_line(log: Path) -> str:
    try:
        lines = log.read_text(encoding="utf-8", errors="replace").split("\n")
    except OSError:
        return "it printed nothing"
    spoken = [line for line in lines if line.strip()]
    return in_short(Exception(spoken[-1]), 200) if spoken else "it printed nothing"
