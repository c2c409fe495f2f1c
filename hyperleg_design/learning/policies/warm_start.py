"""Starting a training from another task's policy: the columns that both observe keep their weights.

Where both tasks take the same kind of commands, these columns keep their weights, too. Where a walk
becomes a waypoint task, the old command becomes part of the first layer's bias, so that the new
policy begins by doing what the old one did under that command. So does a gait clock that the old
task no longer showed, where the new task does not observe it. Columns that only the new task has
begin without weight. The critic starts anew, alone for some iterations.

Layers may become wider: the policy then still begins by doing what the old one did.

A policy that is conditioned on its design starts a training of one design (`start_policy`).

A finished training writes its critic beside its policy. A training whose critic observes the same,
or the robot's design besides, and has the same layers takes over that critic and the deviation of
the actions, and so goes on where the first one ended, but for the optimiser's moments and the
simulations' states. Where the policy has no critic, it takes that of a training with another seed,
which learns alone for some iterations, too.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np
import torch

from hyperleg_design.errors import InputError
from hyperleg_design.learning.learner.algorithm import DESIGN
from hyperleg_design.learning.learner.modulation import plain_layers
from hyperleg_design.learning.policies.start_policy import StartPolicy

if TYPE_CHECKING:
    from rsl_rl.models import MLPModel

COMMAND = "command"
"""Beginning of the names of the columns of the command."""
CLOCK = "clock"
"""Beginning of the names of the columns of the gait clock."""


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
    seen: float,
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
