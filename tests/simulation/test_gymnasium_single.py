from __future__ import annotations

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

from hyperleg_design.simulation.gymnasium_single import NAMES  # noqa: E402


@pytest.mark.parametrize("name", NAMES)
def test_gymnasiums_own_checks_pass(name):
    from gymnasium.utils.env_checker import check_env

    check_env(gymnasium.make(name).unwrapped, skip_render_check=True)


def test_the_design_is_chosen_by_name():
    toe, locked = (gymnasium.make("hyperleg/Walk-v0", design=d) for d in ("toe", "toe_locked"))
    assert toe.action_space.shape == (14,)
    assert locked.action_space.shape == (12,)


def test_the_same_seed_gives_the_same_episode():
    env = gymnasium.make("hyperleg/Walk-v0")
    actions = np.random.default_rng(0).normal(size=(5, 14)).astype(np.float32)

    def episode(seed):
        first, _ = env.reset(seed=seed)
        return [first, *(env.step(action)[0] for action in actions)]

    one, two, other = episode(3), episode(3), episode(4)
    np.testing.assert_array_equal(one, two)
    assert not np.array_equal(one, other)


def test_an_episode_ends_with_the_observation_of_its_end():
    env = gymnasium.make("hyperleg/Walk-v0")
    env.reset(seed=0)
    for _ in range(200):
        observation, _, terminated, truncated, _ = env.step(np.full(14, 2.0, np.float32))
        assert env.observation_space.contains(observation)
        if terminated or truncated:
            break
    assert terminated


def test_many_at_once():
    env = gymnasium.make_vec("hyperleg/Walk-v0", num_envs=3, design="toe_locked", threads=1)
    observations, _ = env.reset()
    assert observations.shape[0] == 3
    assert env.single_action_space.shape == (12,)
    env.close()


def test_a_quadruped_is_an_environment_too():
    env = gymnasium.make("hyperleg/Walk-v0", design="mini_cheetah", task="walk_any")
    assert env.action_space.shape == (12,)
    observation, _ = env.reset(seed=0)
    assert env.step(np.zeros(12, np.float32))[0].shape == observation.shape
