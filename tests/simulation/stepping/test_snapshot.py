from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.ablation import ablate
from hyperleg_design.robot.design import Design
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.stepping.snapshot import put_snapshot, take_snapshot
from hyperleg_design.simulation.tasks import load_task
from hyperleg_design.simulation.terms.assist import Assist


@pytest.mark.parametrize("task", ["walk", pytest.param("goal", marks=pytest.mark.slow)])
def test_an_environment_put_back_goes_on_bit_for_bit(hyperleg: Design, task: str) -> None:
    def made() -> Environment:
        return Environment(
            hyperleg, load_task(task), simulations=20, seed=4, threads=1, assist=Assist(0.5)
        )

    actions = np.random.default_rng(0).normal(
        size=(150, 20, 14)
    )  # long enough for falls and new starts
    first = made()
    first.reset()
    for action in actions[:70]:
        first.step(action)
    snapshot = take_snapshot(first)
    expected = [first.step(action) for action in actions[70:]]
    again = made()
    put_snapshot(again, snapshot)
    assert any(step.ended.size for step in expected)
    for action, step in zip(actions[70:], expected, strict=True):
        found = again.step(action)
        np.testing.assert_array_equal(found.reward_terms, step.reward_terms)
        np.testing.assert_array_equal(found.ending, step.ending)
        for group, values in step.observations.items():
            np.testing.assert_array_equal(found.observations[group], values)


def test_a_snapshot_does_not_follow_the_environment(hyperleg: Design) -> None:
    environment = Environment(hyperleg, load_task("walk"), simulations=3, threads=1)
    environment.reset()
    snapshot = take_snapshot(environment)
    before = snapshot["chunks"][0]["physics"].copy()
    for _ in range(3):
        environment.step(np.ones((3, 14)))
    np.testing.assert_array_equal(snapshot["chunks"][0]["physics"], before)


def test_of_another_environment(hyperleg: Design) -> None:
    environment = Environment(hyperleg, load_task("walk"), simulations=3, threads=1)
    environment.reset()
    snapshot = take_snapshot(environment)
    with pytest.raises(InputError, match="must be 4"):
        put_snapshot(Environment(hyperleg, load_task("walk"), simulations=4, threads=1), snapshot)
    with pytest.raises(InputError, match="another robot"):
        put_snapshot(
            Environment(
                ablate(hyperleg, "toe_removed"), load_task("walk"), simulations=3, threads=1
            ),
            snapshot,
        )
