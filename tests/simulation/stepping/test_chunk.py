from __future__ import annotations

import numpy as np


def test_a_diverged_simulation_is_told_with_its_state_and_started_anew(make) -> None:
    environment = make(simulations=3)
    environment.reset()
    chunk = environment.chunks[0]
    broken = chunk.batch.state[1].copy()
    chunk.batch.state[1, 8:11] = np.nan
    step = environment.step(np.zeros((3, environment.action_size)))
    (told,) = step.divergences
    assert told.simulation == 1
    assert told.position.shape == (7 + 14,)
    assert step.reward[1] == 0.0
    assert step.truncated.tolist() == [False, True, False]
    assert not step.terminated.any()
    assert np.all(np.isfinite(chunk.batch.state))
    assert broken.shape == chunk.batch.state[1].shape
    assert np.all(np.isfinite(environment.step(np.zeros((3, environment.action_size))).reward))
    environment.close()


def test_reward_terms_sum_to_the_reward(make) -> None:
    environment = make(simulations=8)
    environment.reset()
    rng = np.random.default_rng(0)
    for _ in range(20):
        step = environment.step(rng.normal(size=(8, environment.action_size)))
        np.testing.assert_allclose(step.reward_terms.sum(1), step.reward, atol=1e-12)
    environment.close()


def test_joint_order_of_the_state_is_the_layouts(make) -> None:
    environment = make(simulations=2)
    environment.reset()
    chunk = environment.chunks[0]
    names = [environment.model.joint(i).name for i in range(1, environment.model.njnt)]
    assert tuple(names) == environment.layout.joints
    np.testing.assert_array_equal(
        chunk.motion.joint_position, chunk.batch.state[:, 1 + 7 : 1 + 7 + 14]
    )
    environment.close()
