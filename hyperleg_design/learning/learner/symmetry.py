"""Left-right symmetry of the robot as augmentation for `rsl-rl`, from the mirror maps of the
simulation.

Two ways: `append_mirrored` is rsl-rl's own augmentation, which doubles every minibatch;
`HalfMirrored` mirrors each sample with probability one half, which costs nothing, and measures how
far an update moved the policy on those that it left alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import torch
from rsl_rl.extensions import Symmetry

from hyperleg_design.simulation.terms.mirror import MirrorMap

if TYPE_CHECKING:
    from rsl_rl.models import MLPModel
    from rsl_rl.storage import RolloutStorage
    from tensordict import TensorDict


class TorchMirror:
    """A mirror map on tensors."""

    def __init__(self, mirror: MirrorMap) -> None:
        self.index = torch.as_tensor(mirror.index.copy(), dtype=torch.long)
        self.sign = torch.as_tensor(mirror.sign.copy(), dtype=torch.float32)

    def to(self, device: str) -> None:
        """Move to a device, in place.

        Args:
            device: as torch writes it.
        """
        self.index, self.sign = self.index.to(device), self.sign.to(device)

    def __call__(self, values: torch.Tensor) -> torch.Tensor:
        """Mirror image, `(..., k)`."""
        return values[..., self.index] * self.sign


class Mirrors:
    """Mirror images of observations and actions, and rsl-rl's augmentation function."""

    def __init__(self, maps: dict[str, MirrorMap]) -> None:
        self.action = TorchMirror(maps["action"])
        self.groups = {
            name: TorchMirror(mirror) for name, mirror in maps.items() if name != "action"
        }

    def to(self, device: str) -> None:
        """Move all maps to a device, in place.

        Args:
            device: as torch writes it.
        """
        for mirror in (self.action, *self.groups.values()):
            mirror.to(device)

    def append_mirrored(
        self, env: Any, obs: TensorDict | None, actions: torch.Tensor | None
    ) -> tuple[TensorDict | None, torch.Tensor | None]:
        """Append the mirror images of samples, as rsl-rl asks for.

        Args:
            env: not used.
            obs: observations by group, `(n, k)` each; may be None.
            actions: `(n, J)`; may be None.

        Returns:
            Both with `2 n` rows.
        """
        if obs is not None:
            image = obs.clone()
            for name, mirror in self.groups.items():
                image[name] = mirror(obs[name])
            obs = torch.cat([obs, image])
        if actions is not None:
            actions = torch.cat([actions, self.action(actions)])
        return obs, actions


class HalfMirrored(Symmetry):  # type: ignore[misc]
    """Mirrors each sample of a minibatch with probability one half, in place of appending all
    mirror images.

    Args:
        mirrors: of the robot.
        share: probability; 0 leaves all samples and only measures.
    """

    def __init__(self, mirrors: Mirrors, share: float = 0.5) -> None:
        super().__init__(
            env=None, data_augmentation_func=mirrors.append_mirrored, use_data_augmentation=True
        )
        self.mirrors, self.share = mirrors, share
        self.mirrored = torch.zeros(0, dtype=torch.bool)
        """Samples of the latest minibatch that are mirrored, `(n,)`."""
        self.divergences: list[float] = []
        """Mean KL divergence from the old policy on unmirrored samples [nat], by minibatch."""

    def augment_batch(self, batch: RolloutStorage.Batch, original_batch_size: int) -> None:
        """Mirror a share of the samples at random.

        Args:
            batch: which is changed.
            original_batch_size: number of samples.
        """
        self.mirrored = (torch.rand(original_batch_size) < self.share).to(batch.actions.device)
        if not self.share:
            return
        where = self.mirrored[:, None]
        observations: Any = batch.observations
        for name, mirror in self.mirrors.groups.items():
            observations[name] = torch.where(where, mirror(observations[name]), observations[name])
        batch.actions = torch.where(where, self.mirrors.action(batch.actions), batch.actions)

    def compute_loss(
        self, actor: MLPModel, batch: RolloutStorage.Batch, original_batch_size: int
    ) -> torch.Tensor:
        """Note the divergence of the policy on unmirrored samples from the latest forward pass;
        there is no loss.

        Args:
            actor: the network.
            batch: with the old distribution of actions.
            original_batch_size: number of samples.

        Returns:
            Zero.
        """
        alone = ~self.mirrored
        with torch.no_grad():
            new = tuple(p[alone].float() for p in actor.output_distribution_params)
            old = tuple(p[alone] for p in batch.old_distribution_params)
            self.divergences.append(float(actor.get_kl_divergence(old, new).mean()))
        return torch.zeros(())
