"""Reading a policy that a training starts from, and the critic that goes with it.

A policy that is conditioned on its design is read as one of a single design, which is folded into
its layers (`fold_design`), and into those of its critic.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError, in_short
from hyperleg_design.learning.policies.fold_design import fold_design
from hyperleg_design.learning.records.status import CRITIC, POLICY
from hyperleg_design.reading import given_path
from hyperleg_design.simulation.design_observation import RANGES, design_ranges
from hyperleg_design.simulation.policy_file import CRITIC_FORMAT, POLICY_FORMAT

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign

SEEN = 200_000
"""Samples that the old normaliser counts for, so that it soon follows the new task; assumed."""


@dataclass(frozen=True, eq=False)
class StartPolicy:
    """A policy to start from."""

    columns: tuple[str, ...]
    """Names of its observation's numbers."""
    joints: tuple[str, ...]
    mean: np.ndarray
    """Means of its normaliser, `(size,)`."""
    deviation: np.ndarray
    """Standard deviations of its normaliser, `(size,)`."""
    weights: tuple[np.ndarray, ...]
    """Weights of each layer, `(outputs, inputs)`."""
    biases: tuple[np.ndarray, ...]
    """Biases of each layer, `(outputs,)`."""
    commands: str
    """Kind of the commands that it follows, `velocity` or `waypoints`."""
    posture: dict[str, float]
    """Default posture that its task states [deg]."""
    clock_hidden: bool
    """Whether its task shows no gait clock, so that the clock's columns were zero at the end."""
    source: dict[str, Any]
    """What `run.json` says of it: task, variant, seed, steps, commit and SHA-256 of the file, and
    of its critic's."""
    critic: StartCritic | None = None
    """Critic of the same training, else of one with another seed; None where neither is there."""
    seen: float = SEEN
    """Samples that its normaliser counts for at the start."""
    own_critic: bool = True
    """Whether the critic is of the same training, not of one with another seed."""

    def toward(self, task: str) -> StartPolicy:
        """This policy for a training of some task: in its own task it has seen what comes, and a
        normaliser that follows the first episodes would take its skill away.

        Args:
            task: name of the task.
        """
        if self.source["task"] != task:
            return self
        return replace(self, seen=max(float(self.source["steps"]), self.seen))


@dataclass(frozen=True, eq=False)
class StartCritic:
    """The critic that judged a policy at the end of its training."""

    columns: tuple[str, ...]
    """Names of its observation's numbers."""
    mean: np.ndarray
    """Means of its normaliser, `(size,)`."""
    deviation: np.ndarray
    """Standard deviations of its normaliser, `(size,)`."""
    weights: tuple[np.ndarray, ...]
    """Weights of each layer, `(outputs, inputs)`."""
    biases: tuple[np.ndarray, ...]
    """Biases of each layer, `(outputs,)`."""
    action_deviation: np.ndarray
    """Standard deviation of the policy's actions, `(J,)`."""


def read_start(path: str | Path, design: RobotDesign | None = None) -> StartPolicy:
    """Read a policy that `hyperleg train` exported, and the critic beside it, else that of another
    seed, if any.

    Args:
        path: of the ONNX file.
        design: the one robot that is to be trained, which a conditioned policy needs; None where
            many are.

    Returns:
        Weights, normaliser and origin of the policy, and those of its critic; a conditioned policy
        as an ordinary one that does the same on the design.

    Raises:
        InputError: missing, truncated, or no such policy or critic; or a conditioned policy, for
            many designs, or for a design outside of its ranges.
    """
    path = Path(path)
    metadata, network, digest, modulation = _read_network(path, POLICY_FORMAT)
    numbers: dict[str, float] = {}
    if RANGES in metadata:
        where = given_path(path)
        if design is None:
            raise InputError(
                where,
                "design",
                None,
                "is conditioned on its design, and can start a training of one design only; start "
                "from a policy of one design",
            )
        ranges = design_ranges(json.loads(metadata[RANGES]), f"{where}: {RANGES}")
        ranges.check_inside(design, where)
        numbers = dict(zip(ranges.columns, ranges.numbers(design).tolist(), strict=True))
        network = fold_design(network, modulation, numbers)
    source: dict[str, Any] = {
        key: metadata[key] for key in ("variant", "seed", "steps", "commit") if key in metadata
    }
    task = json.loads(metadata["task"])
    source |= {"task": task["name"], "sha256": digest}
    critic = None
    if file := _critic_file(path):
        extra, judged, source["critic_sha256"], modulation = _read_network(file, CRITIC_FORMAT)
        if numbers:
            judged = fold_design(judged, modulation, numbers)
        critic = StartCritic(
            **judged, action_deviation=np.array(json.loads(extra["action_deviation"]))
        )
    return StartPolicy(
        **network,
        joints=tuple(json.loads(metadata["joints"])),
        commands=task["commands"]["kind"],
        posture={str(k): float(v) for k, v in task.get("posture_deg", {}).items()},
        clock_hidden=task.get("clock", {}).get("shown", 1.0) == 0.0,
        source=source,
        critic=critic,
        # scaled for many designs; followed soon, those of one would turn a policy that cannot yet
        seen=max(float(metadata["steps"]), SEEN) if numbers else SEEN,
        own_critic=file is None or file.parent == path.parent,
    )


def _critic_file(policy: Path) -> Path | None:
    """The critic beside the last policy of a training, else that of the same task and robot with
    another seed: the folders of trainings end with it.
    """
    if policy.name != POLICY:
        return None
    name, _, seed = policy.parent.name.rpartition("-")
    others = policy.parent.parent.glob(f"{name}-[0-9]*/{CRITIC}") if seed.isdigit() else ()
    files = (policy.parent / CRITIC, *sorted(others))
    return next((file for file in files if file.is_file()), None)


def _read_network(
    path: Path, form: str
) -> tuple[dict[str, str], dict[str, Any], str, dict[int, Any]]:
    """Metadata, columns with normaliser and layers, SHA-256, and modulation (as `fold_design` takes
    it) of an exported network.
    """
    import onnx
    from onnx import numpy_helper

    where = given_path(path)
    try:
        content = path.read_bytes()
        model = onnx.load_from_string(content)
    except OSError as error:
        raise InputError(
            where,
            "",
            None,
            f"cannot be read ({error.strerror}); train it first, or name another policy",
        ) from None
    except Exception as error:  # protobuf's own kinds
        raise InputError(
            where, "", None, f"is no ONNX file, or is truncated ({in_short(error, 80)})"
        ) from None
    metadata = {entry.key: entry.value for entry in model.metadata_props}
    if metadata.get("format") != form:
        raise InputError(
            where,
            "format",
            metadata.get("format"),
            f"expects a file made by `hyperleg train` ({form})",
        )
    arrays = {
        entry.name: numpy_helper.to_array(entry).astype(np.float64)
        for entry in model.graph.initializer
    }
    layers = sorted(
        int(name.removeprefix("weight_")) for name in arrays if name.startswith("weight_")
    )
    columns = tuple(json.loads(metadata["columns"]))
    network = {
        "columns": columns,
        "mean": arrays.get("mean", np.zeros(len(columns))).reshape(-1),
        "deviation": arrays.get("deviation", np.ones(len(columns))).reshape(-1),
        "weights": tuple(arrays[f"weight_{i}"] for i in layers),
        "biases": tuple(arrays[f"bias_{i}"] for i in layers),
    }
    parts = ("scale_weight", "scale_bias", "shift_weight", "shift_bias")
    modulation = {
        place: tuple(arrays[f"{part}_{i}"] for part in parts)
        for place, i in enumerate(layers)
        if f"scale_weight_{i}" in arrays
    }
    return metadata, network, hashlib.sha256(content).hexdigest(), modulation
