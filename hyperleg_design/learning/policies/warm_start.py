"""Starting a training from another task's policy: the columns that both observe keep their weights.

Where both tasks take the same kind of commands, these columns keep their weights, too. Where a walk
becomes a waypoint task, the old command becomes part of the first layer's bias, so that the new
policy begins by doing what the old one did under that command. So does a gait clock that the old
task no longer showed, where the new task does not observe it. Columns that only the new task has
begin without weight. The critic starts anew, alone for some iterations.

Layers may become wider: the policy then still begins by doing what the old one did.

A policy that is conditioned on its design starts a training of one design: that design is folded
into its layers (`fold_design`), and into those of its critic.

A finished training writes its critic beside its policy. A training whose critic observes the same,
or the robot's design besides, and has the same layers takes over that critic and the deviation of
the actions, and so goes on where the first one ended, but for the optimiser's moments and the
simulations' states. Where the policy has no critic, it takes that of a training with another seed,
which learns alone for some iterations, too.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import torch

from hyperleg_design.errors import InputError, in_short
from hyperleg_design.learning.learner.algorithm import DESIGN
from hyperleg_design.learning.learner.modulation import plain_layers
from hyperleg_design.learning.policies.export import CRITIC_FORMAT, FORMAT
from hyperleg_design.learning.policies.fold_design import fold_design
from hyperleg_design.learning.records.status import CRITIC, POLICY
from hyperleg_design.simulation.design_observation import RANGES, design_ranges

if TYPE_CHECKING:
    from rsl_rl.models import MLPModel

    from hyperleg_design.robot.parameters.described import RobotDesign

SEEN = 200_000
"""Samples that the old normaliser counts for, so that it soon follows the new task; assumed."""
COMMAND = "command"
"""Beginning of the names of the columns of the command."""
CLOCK = "clock"
"""Beginning of the names of the columns of the gait clock."""


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
    metadata, network, digest, modulation = _read_network(path, FORMAT)
    numbers: dict[str, float] = {}
    if RANGES in metadata:
        where = f"{path.parent.name}/{path.name}"
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


def check_posture(start: StartPolicy, posture: Mapping[str, float]) -> None:
    """Check that a policy can start a training under a task.

    Args:
        start: the policy.
        posture: default posture of the task by joint [deg].

    Raises:
        InputError: the policy's task has another posture, to which its actions are added.
    """
    if start.posture != dict(posture):
        raise InputError(
            "start",
            "posture_deg",
            start.posture,
            f"expects a policy whose task has the posture {dict(posture)}: actions are added to it",
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
    linear = [layer for layer in plain_layers(actor.mlp) if isinstance(layer, torch.nn.Linear)]
    shapes = [tuple(layer.weight.shape) for layer in linear]
    widths, wanted = [int(w.shape[0]) for w in start.weights], [s[0] for s in shapes]
    if len(widths) != len(wanted) or any(w > n for w, n in zip(widths, wanted, strict=True)):
        raise InputError(
            "start", "layers", widths, f"expects a policy with layers of at most {wanted}"
        )
    old = {name: i for i, name in enumerate(start.columns)}
    folded = [i for name, i in old.items() if command is not None and name.startswith(COMMAND)]
    hidden = [
        i
        for name, i in old.items()
        if start.clock_hidden and name.startswith(CLOCK) and name not in columns
    ]
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
    to, of = [n for n, _ in shared], [o for _, o in shared]
    first = np.zeros((widths[0], len(columns)))
    first[:, to], mean[to], scale[to] = start.weights[0][:, of], start.mean[of], start.deviation[of]
    unseen = [o for o in old.values() if o not in {*of, *folded, *hidden}]
    if unseen:
        raise InputError(
            "start",
            "columns",
            start.columns[unseen[0]],
            "the new task does not observe this; the policy would miss it",
        )
    bias = start.biases[0] - start.weights[0][:, hidden] @ (
        start.mean[hidden] / start.deviation[hidden]
    )
    if command is not None:
        bias = bias + start.weights[0][:, folded] @ (
            (command - start.mean[folded]) / start.deviation[folded]
        )
    layers = [(first, bias), *zip(start.weights[1:], start.biases[1:], strict=True)]
    put = [_widened(*pair) for pair in zip(linear, layers, strict=True)]
    _put(actor, put, mean, scale, start.seen)
    with torch.no_grad():
        actor.distribution.log_std_param.fill_(float(np.log(deviation)))


def _widened(
    layer: torch.nn.Linear, old: tuple[np.ndarray, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Weights and bias of a layer that is as wide as the old one or wider, and of which the old
    units do what they did: they take nothing from new units, which begin as drawn.
    """
    weight = layer.weight.detach().numpy().astype(float)
    bias = layer.bias.detach().numpy().astype(float)
    rows, columns = old[0].shape
    weight[:rows], weight[:rows, :columns], bias[:rows] = 0.0, *old
    return weight, bias


def fits_critic(critic: MLPModel, start: StartPolicy, columns: list[str]) -> bool:
    """Whether a training can take over the critic that judged a policy.

    Args:
        critic: of the new training.
        start: the policy.
        columns: names of the critic's observation's numbers.

    Returns:
        Whether there is one, of the same observation, but for the design, and layers.
    """
    old = start.critic
    if old is None or list(old.columns) != [c for c in columns if not c.startswith(DESIGN)]:
        return False
    linear = [layer for layer in plain_layers(critic.mlp) if isinstance(layer, torch.nn.Linear)]
    return [w.shape[0] for w in old.weights] == [layer.out_features for layer in linear]


def start_critic(
    critic: MLPModel,
    actor: MLPModel,
    start: StartPolicy,
    columns: list[str],
    observation: np.ndarray,
) -> None:
    """Give a critic the weights of the one that judged the policy, and the actor the deviation of
    its actions.

    Args:
        critic: which is changed; see `fits_critic`.
        actor: which is changed.
        start: the policy with its critic.
        columns: names of the new critic's observation's numbers; those of the design begin without
            weight.
        observation: first observations of the new critic `(n, size)`: scale of the design.
    """
    old = start.critic
    assert old is not None
    shared = [i for i, name in enumerate(columns) if name in old.columns]
    mean, scale = np.zeros(len(columns)), np.maximum(observation.std(0), 0.1)
    first = np.zeros((len(old.biases[0]), len(columns)))
    first[:, shared], mean[shared], scale[shared] = old.weights[0], old.mean, old.deviation
    layers = zip([first, *old.weights[1:]], old.biases, strict=True)
    _put(critic, layers, mean, scale, start.seen)
    with torch.no_grad():
        actor.distribution.log_std_param.copy_(torch.from_numpy(np.log(old.action_deviation)))


def _put(
    network: MLPModel,
    layers: Iterable[tuple[np.ndarray, np.ndarray]],
    mean: np.ndarray,
    deviation: np.ndarray,
    seen: float = SEEN,
) -> None:
    """Set weights, biases and normaliser of a network."""
    linear = [layer for layer in plain_layers(network.mlp) if isinstance(layer, torch.nn.Linear)]
    with torch.no_grad():
        for layer, (weight, offset) in zip(linear, layers, strict=True):
            layer.weight.copy_(torch.from_numpy(weight))
            layer.bias.copy_(torch.from_numpy(offset))
        if network.obs_normalization:
            normaliser = network.obs_normalizer
            spread = torch.from_numpy(deviation - float(normaliser.eps)).clamp_min(1e-6)
            normaliser._mean.copy_(torch.from_numpy(mean)[None])
            normaliser._std.copy_(spread[None])
            normaliser._var.copy_((spread**2)[None])
            normaliser.count.fill_(int(seen))
