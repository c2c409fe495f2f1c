"""Starting a training from another task's policy: the columns that both observe keep their weights.

Where both tasks take the same kind of commands, these columns keep their weights, too. Where a walk
becomes a waypoint task, the old command becomes part of the first layer's bias, so that the new
policy begins by doing what the old one did under that command; columns that only the new task has
begin without weight. The critic starts anew, alone for some iterations.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import torch

from hyperleg_design.errors import InputError, in_short
from hyperleg_design.learning.export import FORMAT

if TYPE_CHECKING:
    from rsl_rl.models import MLPModel

SEEN = 200_000
"""Samples that the old normaliser counts for, so that it soon follows the new task; assumed."""
COMMAND = "command"
"""Beginning of the names of the columns that are folded in."""


@dataclass(frozen=True, eq=False)
class StartPolicy:
    """A policy to start from."""

    columns: tuple[str, ...]
    """Names of its observation's numbers."""
    joints: tuple[str, ...]
    mean: np.ndarray
    """Of its normaliser, `(size,)`."""
    deviation: np.ndarray
    """Of its normaliser, `(size,)`."""
    weights: tuple[np.ndarray, ...]
    """Of each layer, `(outputs, inputs)`."""
    biases: tuple[np.ndarray, ...]
    """Of each layer, `(outputs,)`."""
    commands: str
    """Kind of the commands that it follows, `velocity` or `waypoints`."""
    posture: dict[str, float]
    """Default posture that its task states [deg]."""
    source: dict[str, Any]
    """What `run.json` says of it: task, variant, seed, steps, commit and SHA-256 of the file."""


def read_start(path: str | Path) -> StartPolicy:
    """Read a policy that `hyperleg train` exported.

    Raises:
        InputError: missing, truncated, or no such policy.
    """
    import onnx
    from onnx import numpy_helper

    path = Path(path)
    where = f"{path.parent.name}/{path.name}"
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
    told = {entry.key: entry.value for entry in model.metadata_props}
    if told.get("format") != FORMAT:
        raise InputError(
            where,
            "format",
            told.get("format"),
            f"expects a policy made by `hyperleg train` ({FORMAT})",
        )
    arrays = {
        entry.name: numpy_helper.to_array(entry).astype(np.float64)
        for entry in model.graph.initializer
    }
    layers = sorted(
        int(name.removeprefix("weight_")) for name in arrays if name.startswith("weight_")
    )
    columns = tuple(json.loads(told["columns"]))
    source = {key: told[key] for key in ("variant", "seed", "steps", "commit") if key in told}
    task = json.loads(told["task"])
    source |= {
        "task": task["name"],
        "sha256": hashlib.sha256(content).hexdigest(),
    }
    return StartPolicy(
        columns=columns,
        joints=tuple(json.loads(told["joints"])),
        mean=arrays.get("mean", np.zeros(len(columns))).reshape(-1),
        deviation=arrays.get("deviation", np.ones(len(columns))).reshape(-1),
        weights=tuple(arrays[f"weight_{i}"] for i in layers),
        biases=tuple(arrays[f"bias_{i}"] for i in layers),
        commands=task["commands"]["kind"],
        posture={str(k): float(v) for k, v in task.get("posture_deg", {}).items()},
        source=source,
    )


def start_actor(
    actor: MLPModel,
    start: StartPolicy,
    columns: list[str],
    joints: list[str],
    command: np.ndarray | None,
    observation: np.ndarray,
    deviation: float,
) -> None:
    """Give an actor the weights of a policy.

    Args:
        actor: of the new task.
        start: the policy.
        columns: names of the new observation's numbers.
        joints: names of the new action's numbers.
        command: that the old policy is to follow, in its own columns `(3,)`; None where both tasks
            take the same kind of commands, which then stay what they were.
        observation: first observations of the new task `(n, size)`: scale of the columns that the
            policy did not have.
        deviation: of the actions to begin with.

    Raises:
        InputError: other joints, or other layers.
    """
    if start.joints != tuple(joints):
        raise InputError(
            "start", "joints", ", ".join(start.joints), f"expects a policy for {', '.join(joints)}"
        )
    linear = [layer for layer in actor.mlp if isinstance(layer, torch.nn.Linear)]
    shapes = [tuple(layer.weight.shape) for layer in linear]
    if [w.shape[0] for w in start.weights] != [s[0] for s in shapes]:
        found = [int(w.shape[0]) for w in start.weights]
        raise InputError(
            "start", "layers", found, f"expects a policy with layers of {[s[0] for s in shapes]}"
        )
    old = {name: i for i, name in enumerate(start.columns)}
    folded = [i for name, i in old.items() if command is not None and name.startswith(COMMAND)]
    shared = [
        (new, old[name])
        for new, name in enumerate(columns)
        if name in old and old[name] not in folded
    ]
    if command is not None and len(folded) != len(command):
        raise InputError(
            "start",
            "columns",
            len(folded),
            f"expects a policy with {len(command)} numbers of a command",
        )
    mean, scale = np.zeros(len(columns)), np.maximum(observation.std(0), 0.1)
    first, to, of = np.zeros(shapes[0]), [n for n, _ in shared], [o for _, o in shared]
    first[:, to], mean[to], scale[to] = start.weights[0][:, of], start.mean[of], start.deviation[of]
    unseen = [o for o in old.values() if o not in of and o not in folded]
    if unseen:
        raise InputError(
            "start",
            "columns",
            start.columns[unseen[0]],
            "the new task does not observe this; the policy would miss it",
        )
    bias = start.biases[0]
    if command is not None:
        bias = bias + start.weights[0][:, folded] @ (
            (command - start.mean[folded]) / start.deviation[folded]
        )
    values = [(first, bias), *zip(start.weights[1:], start.biases[1:], strict=True)]
    with torch.no_grad():
        for layer, (weight, offset) in zip(linear, values, strict=True):
            layer.weight.copy_(torch.from_numpy(weight))
            layer.bias.copy_(torch.from_numpy(offset))
        if actor.obs_normalization:
            normaliser = actor.obs_normalizer
            spread = torch.from_numpy(scale - float(normaliser.eps)).clamp_min(1e-6)
            normaliser._mean.copy_(torch.from_numpy(mean)[None])
            normaliser._std.copy_(spread[None])
            normaliser._var.copy_((spread**2)[None])
            normaliser.count.fill_(SEEN)
        actor.distribution.log_std_param.fill_(float(np.log(deviation)))
