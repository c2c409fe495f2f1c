from __future__ import annotations

import numpy as np

from hyperleg_design.simulation.stepping.step import Step, joined, merged


def step(first, count, ended):
    rows = np.arange(first, first + count)
    return Step(
        observations={"policy": np.stack([rows, -rows], 1)},
        reward=rows * 1.0,
        terminated=np.isin(rows, ended),
        truncated=np.zeros(count, bool),
        ending=np.isin(rows, ended).astype(int),
        reward_terms=rows[:, None] * np.ones(2),
        ended=np.array(ended, int),
        final_observations={"policy": np.stack([ended, ended], 1) * 10},
        episode_steps=np.array(ended) + 100,
        divergences=[f"of {first}"],
    )


def test_parts_merge_in_the_order_of_the_simulations() -> None:
    whole = merged([step(0, 3, [1]), step(3, 2, []), step(5, 4, [5, 8])])
    np.testing.assert_array_equal(whole.reward, np.arange(9.0))
    np.testing.assert_array_equal(whole.ended, np.flatnonzero(whole.terminated))
    np.testing.assert_array_equal(whole.observations["policy"][:, 1], -np.arange(9))
    np.testing.assert_array_equal(whole.final_observations["policy"][:, 0], 10 * whole.ended)
    np.testing.assert_array_equal(whole.episode_steps, whole.ended + 100)
    assert whole.reward_terms.shape == (9, 2)
    assert whole.divergences == ["of 0", "of 3", "of 5"]


def test_one_part_is_not_copied() -> None:
    values = np.arange(4.0)
    assert joined([{"a": values}])["a"] is values
