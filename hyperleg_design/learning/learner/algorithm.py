"""PPO of `rsl-rl-lib`, with the learning rate adapted once an iteration where asked for."""

from __future__ import annotations

import contextlib
import io
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from rsl_rl.algorithms import PPO
from rsl_rl.models import MLPModel
from rsl_rl.storage import RolloutStorage
from tensordict import TensorDict
from torch import Tensor

from hyperleg_design.learning.learner.device import HOST, learning_on
from hyperleg_design.learning.learner.modulation import ModulatedLayers
from hyperleg_design.learning.learner.rounding import multiplies_bfloat16, round_layers
from hyperleg_design.learning.learner.symmetry import HalfMirrored, Mirrors

if TYPE_CHECKING:
    from hyperleg_design.learning.preset import Network, Preset
    from hyperleg_design.simulation.environment import Environment

FACTOR = 1.5
"""Factor by which the learning rate is raised or lowered (as in rsl-rl)."""
QUIET = 0.01
"""Factor on the usual size of the actor's last layer at the start. It lets all robots begin near
their default posture, and makes the first policy its own mirror image. Otherwise the probability
ratios of mirrored samples are mostly clipped, and nothing is learnt from them."""
LEAST = 0.01
"""Deviation of a design's advantages below which they are not magnified, over that of all [-]."""
DESIGN = "design."
"""Beginning of the names of columns that tell the design."""
GROUPS = {"actor": ["policy"], "critic": ["critic"]}
"""Observation groups of each network."""


class DesignPPO(PPO):  # type: ignore[misc]
    """PPO that weighs many designs alike: the advantages of each have mean 0 and deviation 1.

    Standardised all together, the advantages of designs with large rewards or losses, such as those
    that fall, outweigh the others, on whose walks less is learned (as returns of many tasks are
    rescaled task by task; Hessel et al., AAAI 2019).
    """

    designs: np.ndarray | None = None
    """Number of the design of each simulation `(n,)`; None where all have the same."""

    def compute_returns(self, obs: TensorDict) -> None:
        """Compute returns and advantages of the rollout.

        Args:
            obs: observations after it.
        """
        super().compute_returns(obs)
        if self.designs is not None:
            self.storage.advantages = standardised(self.storage.advantages, self.designs)


class IterationPPO(DesignPPO):
    """PPO whose learning rate is adapted once an iteration, on the divergence in the last epoch, of
    unmirrored samples.

    Adapting on every minibatch, or on mirrored samples, crushed the rate to its floor on this
    biped.
    """

    bounds = (5e-5, 2e-3)
    """Least and largest learning rate."""
    divergence = 0.0
    """KL divergence in the last epoch of the latest update [nat]."""
    update_device = HOST
    """Where the networks learn; simulations and actions stay on the processor."""

    def update(self) -> dict[str, float]:
        """Run the epochs of one iteration, then set the learning rate for the next one.

        Returns:
            The losses by name.
        """
        with learning_on(self, self.update_device):
            losses = super().update()
        meter = self.symmetry
        assert isinstance(meter, HalfMirrored)
        last = meter.divergences[-self.num_mini_batches :]
        meter.divergences = []
        self.divergence = sum(last) / len(last)
        if self.divergence > 2.0 * self.desired_kl:
            self.set_rate(max(self.bounds[0], self.learning_rate / FACTOR))
        elif self.divergence < 0.5 * self.desired_kl:
            self.set_rate(min(self.bounds[1], self.learning_rate * FACTOR))
        return losses

    def set_rate(self, rate: float) -> None:
        """Set the learning rate of all parameters.

        Args:
            rate: the learning rate.
        """
        self.learning_rate = rate
        for group in self.optimizer.param_groups:
            group["lr"] = rate


def make_algorithm(preset: Preset, environment: Environment, observations: TensorDict) -> DesignPPO:
    """Make PPO for an environment; networks are drawn from torch's random numbers.

    Args:
        preset: settings of algorithm and network.
        environment: gives the sizes and the mirror maps.
        observations: of the environment, by group.

    Returns:
        The algorithm.
    """
    settings, network = preset.algorithm, preset.network
    actor = make_network(network, observations, "actor", environment.action_size)
    critic = make_network(network, observations, "critic", 1)
    if network.modulated:
        for kind, model in (("policy", actor), ("critic", critic)):
            _modulate(model, environment.observation_columns[kind])
    if settings.mixed_precision and not multiplies_bfloat16():
        round_layers(actor)
        round_layers(critic)
    storage = RolloutStorage(
        "rl", environment.simulations, int(preset.rollout), observations, [environment.action_size]
    )
    mirrors = Mirrors(environment.mirror_maps())
    once = settings.adapted == "iteration"
    symmetry: dict[str, Any] | None = None
    if settings.mirror == "append":
        symmetry = {
            "env": environment,
            "data_augmentation_func": mirrors.append_mirrored,
            "use_data_augmentation": True,
        }
    algorithm = (IterationPPO if once else DesignPPO)(
        actor,
        critic,
        storage,
        num_learning_epochs=int(settings.epochs),
        num_mini_batches=int(settings.minibatches),
        clip_param=settings.clip,
        gamma=settings.discount,
        lam=settings.trace,
        value_loss_coef=settings.value_weight,
        entropy_coef=settings.entropy,
        learning_rate=settings.learning_rate,
        max_grad_norm=settings.gradient_norm,
        use_clipped_value_loss=settings.value_clipped,
        schedule="adaptive" if settings.adapted == "minibatch" else "fixed",
        desired_kl=settings.kl_target,
        use_mixed_precision=settings.mixed_precision,
        symmetry_cfg=symmetry,
    )
    if settings.mirror == "half" or once:
        algorithm.symmetry = HalfMirrored(mirrors, 0.5 if settings.mirrored else 0.0)
    if isinstance(algorithm, IterationPPO):
        algorithm.bounds = (settings.slowest, settings.fastest)
    return algorithm


def standardised(advantages: Tensor, designs: np.ndarray) -> Tensor:
    """Bring the advantages of each design to mean 0 and deviation 1.

    Args:
        advantages: `(t, n, 1)`.
        designs: number of the design of each simulation `(n,)`.

    Returns:
        `(t, n, 1)`.
    """
    own = advantages.clone()
    for design in np.unique(designs):
        rows = torch.from_numpy(np.flatnonzero(designs == design))
        part = advantages[:, rows]
        own[:, rows] = (part - part.mean()) / (part.std() + LEAST)
    return own


def make_network(network: Network, observations: TensorDict, kind: str, outputs: int) -> MLPModel:
    """Make the network of the actor or of the critic.

    Args:
        network: settings.
        observations: of the environment, by group.
        kind: `actor` or `critic`.
        outputs: number of outputs.

    Returns:
        The network with its normaliser.
    """
    distribution = (
        {"class_name": "GaussianDistribution", "init_std": network.deviation, "std_type": "log"}
        if kind == "actor"
        else None
    )
    with contextlib.redirect_stdout(io.StringIO()):
        model = MLPModel(
            observations,
            GROUPS,
            kind,
            outputs,
            hidden_dims=list(network.hidden),
            activation=network.activation,
            obs_normalization=network.normalised,
            distribution_cfg=distribution,
        )
    if kind == "actor":
        with torch.no_grad():
            model.mlp[-1].weight.mul_(QUIET)
            model.mlp[-1].bias.zero_()
    return model


def _modulate(model: MLPModel, columns: list[str]) -> None:
    """Let the design modulate a network's hidden features, in place, where it is observed."""
    places = [i for i, name in enumerate(columns) if name.startswith(DESIGN)]
    if places:
        model.mlp = ModulatedLayers(model.mlp, places)


def as_tensors(observations: dict[str, Any]) -> TensorDict:
    """Wrap observation groups for rsl-rl.

    Args:
        observations: arrays by group, `(n, size)` each.

    Returns:
        Tensors that share memory with the arrays.
    """
    tensors = {name: torch.from_numpy(values) for name, values in observations.items()}
    return TensorDict(tensors, batch_size=[len(next(iter(observations.values())))])
