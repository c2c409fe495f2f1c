from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.robot.design import Design
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.tasks import load_task

torch = pytest.importorskip("torch")
pytest.importorskip("rsl_rl")
from rsl_rl.storage import RolloutStorage  # noqa: E402

from hyperleg_design.learning.learner.algorithm import as_tensors, make_network  # noqa: E402
from hyperleg_design.learning.learner.symmetry import HalfMirrored, Mirrors  # noqa: E402
from hyperleg_design.learning.preset import Network  # noqa: E402


@pytest.fixture(params=["toe", "toe_removed"])
def environment(request: pytest.FixtureRequest, hyperleg: Design) -> Environment:
    from hyperleg_design.robot.ablation import ablate

    return Environment(
        ablate(hyperleg, request.param), load_task("walk"), simulations=16, threads=1
    )


def test_appended_mirror_images_are_the_maps_and_mirroring_twice_changes_nothing(
    environment: Environment, rng: np.random.Generator
) -> None:
    maps = environment.mirror_maps()
    mirrors = Mirrors(maps)
    arrays = {
        name: rng.normal(size=(5, size)).astype(np.float32)
        for name, size in environment.observation_sizes.items()
    }
    actions = rng.normal(size=(5, environment.action_size)).astype(np.float32)
    observations, both = mirrors.append_mirrored(
        None, as_tensors(arrays), torch.from_numpy(actions)
    )
    for name, values in arrays.items():
        np.testing.assert_array_equal(observations[name][:5].numpy(), values)
        np.testing.assert_array_equal(observations[name][5:].numpy(), maps[name](values))
        np.testing.assert_array_equal(mirrors.groups[name](observations[name][5:]).numpy(), values)
    np.testing.assert_array_equal(both[5:].numpy(), maps["action"](actions))


def test_half_of_a_batch_is_mirrored_and_the_others_measure_the_divergence(
    environment: Environment, rng: np.random.Generator
) -> None:
    torch.manual_seed(0)
    maps = environment.mirror_maps()
    symmetry = HalfMirrored(Mirrors(maps))
    arrays = {
        name: rng.normal(size=(400, size)).astype(np.float32)
        for name, size in environment.observation_sizes.items()
    }
    actions = rng.normal(size=(400, environment.action_size)).astype(np.float32)
    actor = make_network(Network(hidden=(8,)), as_tensors(arrays), "actor", environment.action_size)
    actor(as_tensors(arrays), stochastic_output=True)
    old = tuple(p.detach().clone() for p in actor.output_distribution_params)
    batch = RolloutStorage.Batch(
        observations=as_tensors({k: v.copy() for k, v in arrays.items()}),
        actions=torch.from_numpy(actions.copy()),
        old_distribution_params=old,
    )
    symmetry.augment_batch(batch, 400)
    turned = symmetry.mirrored.numpy()
    assert 150 < turned.sum() < 250
    for name, values in arrays.items():
        np.testing.assert_array_equal(
            batch.observations[name].numpy(), np.where(turned[:, None], maps[name](values), values)
        )
    np.testing.assert_array_equal(
        batch.actions.numpy(), np.where(turned[:, None], maps["action"](actions), actions)
    )
    actor(batch.observations, stochastic_output=True)
    assert symmetry.compute_loss(actor, batch, 400) == 0.0
    assert symmetry.divergences[-1] == pytest.approx(
        0.0, abs=1e-6
    )  # same policy: the mirrored samples do not count
    with torch.no_grad():
        actor.distribution.log_std_param += np.log(2.0)
        actor(batch.observations, stochastic_output=True)
    symmetry.compute_loss(actor, batch, 400)
    each = np.log(2.0) + 1 / 8 - 1 / 2  # KL of Gaussians of the same mean, deviation doubled
    assert symmetry.divergences[-1] == pytest.approx(each * environment.action_size, rel=1e-4)
