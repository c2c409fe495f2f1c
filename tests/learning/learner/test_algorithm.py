from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hyperleg_design.robot.design import Design
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.tasks import load_task

torch = pytest.importorskip("torch")
pytest.importorskip("rsl_rl")

from hyperleg_design.learning.learner.algorithm import (  # noqa: E402
    IterationPPO,
    as_tensors,
    make_algorithm,
    standardised,
)
from hyperleg_design.learning.preset import Preset  # noqa: E402


def rolled_out(preset: Preset, design: Design):
    environment = Environment(
        design, load_task("walk"), simulations=int(preset.simulations), threads=1
    )
    torch.manual_seed(0)
    observations = as_tensors(environment.reset())
    algorithm = make_algorithm(preset, environment, observations)
    algorithm.train_mode()
    with torch.inference_mode():
        for _ in range(int(preset.rollout)):
            step = environment.step(algorithm.act(observations).numpy())
            observations = as_tensors(step.observations)
            algorithm.process_env_step(
                observations,
                torch.from_numpy(step.reward.astype(np.float32)),
                torch.from_numpy(step.ending != 0),
                {},
            )
        algorithm.compute_returns(observations)
    return environment, algorithm


@pytest.mark.parametrize(("target", "factor"), [(1e-5, 1 / 1.5), (1.0, 1.5)])
def test_learning_rate_moves_once_an_iteration(
    tiny: Preset, hyperleg: Design, target: float, factor: float
) -> None:
    preset = replace(
        tiny, algorithm=replace(tiny.algorithm, kl_target=target, learning_rate=1e-3, epochs=10)
    )
    _, algorithm = rolled_out(preset, hyperleg)
    assert isinstance(algorithm, IterationPPO)
    algorithm.update()
    assert algorithm.learning_rate == pytest.approx(1e-3 * factor)
    assert {group["lr"] for group in algorithm.optimizer.param_groups} == {algorithm.learning_rate}
    assert algorithm.divergence > 0
    assert len(algorithm.symmetry.divergences) == 0


def test_learning_rate_stays_within_its_bounds(tiny: Preset, hyperleg: Design) -> None:
    preset = replace(
        tiny,
        algorithm=replace(
            tiny.algorithm, kl_target=1e-5, learning_rate=6e-5, slowest=5e-5, epochs=40
        ),
    )
    _, algorithm = rolled_out(preset, hyperleg)
    algorithm.update()
    assert algorithm.learning_rate == 5e-5


def test_the_first_policy_stands_in_the_default_posture_and_is_its_own_mirror_image(
    tiny: Preset, hyperleg: Design
) -> None:
    environment, algorithm = rolled_out(tiny, hyperleg)
    values = environment.reset()["policy"]
    maps = environment.mirror_maps()
    actor = algorithm.get_policy()
    with torch.inference_mode():
        plain, mirrored = (
            actor.mlp(torch.from_numpy(v.astype(np.float32))).numpy()
            for v in (values, maps["policy"](values))
        )
    assert np.abs(plain).max() < 0.02
    assert np.abs(mirrored - maps["action"](plain)).max() < 0.02


@pytest.mark.parametrize(
    ("mirror", "adapted"),
    [("append", "minibatch"), ("never", "iteration"), ("append", "never"), ("never", "minibatch")],
)
def test_the_other_ways_learn_too(
    tiny: Preset, hyperleg: Design, mirror: str, adapted: str
) -> None:
    preset = replace(
        tiny,
        algorithm=replace(tiny.algorithm, mirror=mirror, adapted=adapted, mixed_precision=False),
    )
    _, algorithm = rolled_out(preset, hyperleg)
    before = [p.clone() for p in algorithm.actor.parameters()]
    losses = algorithm.update()
    assert all(np.isfinite(v) for v in losses.values())
    assert any(
        not torch.equal(a, b) for a, b in zip(before, algorithm.actor.parameters(), strict=True)
    )


def test_advantages_of_each_design_have_mean_zero_and_deviation_one() -> None:
    designs = np.array([0, 0, 2, 2, 2, 5])
    sizes = torch.tensor([1.0, 1.0, 30.0, 30.0, 30.0, 0.0])
    generator = torch.Generator().manual_seed(3)
    advantages = 4.0 + sizes[:, None] * torch.randn(32, 6, 1, generator=generator)
    own = standardised(advantages, designs)
    for rows in ([0, 1], [2, 3, 4]):
        assert float(own[:, rows].mean()) == pytest.approx(0.0, abs=1e-5)
        assert float(own[:, rows].std()) == pytest.approx(1.0, abs=0.02)
    assert float(own[:, 5].abs().max()) == 0.0
    order = torch.argsort(advantages[:, 2:5].flatten())
    assert torch.equal(order, torch.argsort(own[:, 2:5].flatten()))
