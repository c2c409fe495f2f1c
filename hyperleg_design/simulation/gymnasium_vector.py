"""The environment behind Gymnasium's interface for vector environments; needs the package
`gymnasium`.
"""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv

from hyperleg_design.simulation.environment import Environment

ACTION_BOUND = 10.0
"""Bound of the action space; actions have no unit, and the task clips them at its own limit."""


class GymnasiumVector(VectorEnv):  # type: ignore[misc]
    """Observations of one group; episodes start anew within the step that ends them, with
    `final_obs` in the info.
    """

    def __init__(self, environment: Environment, group: str = "policy") -> None:
        self.environment, self.group = environment, group
        self.num_envs = environment.simulations
        self.metadata = {"autoreset_mode": AutoresetMode.SAME_STEP}
        size = environment.observation_sizes[group]
        self.single_observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (size,), np.float32)
        self.single_action_space = gymnasium.spaces.Box(
            -ACTION_BOUND, ACTION_BOUND, (environment.action_size,), np.float32
        )
        self.observation_space = gymnasium.vector.utils.batch_space(
            self.single_observation_space, self.num_envs
        )
        self.action_space = gymnasium.vector.utils.batch_space(
            self.single_action_space, self.num_envs
        )

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Start all simulations; the seed is the environment's own, given when it was made.

        Args:
            seed: not used.
            options: not used.

        Returns:
            Observations, `(n, size)`, and an empty mapping.
        """
        return self.environment.reset()[self.group], {}

    def step(
        self, actions: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Advance all simulations by one policy step.

        Args:
            actions: `(n, J)`.

        Returns:
            Observations, rewards, whether each episode terminated, whether it was truncated, and
            the final observations of ended episodes.
        """
        step = self.environment.step(actions)
        info: dict[str, Any] = {}
        if len(step.ended):
            final = np.empty(self.num_envs, object)
            for row, simulation in enumerate(step.ended):
                final[simulation] = step.final_observations[self.group][row]
            info = {"final_obs": final, "_final_obs": np.isin(np.arange(self.num_envs), step.ended)}
        return step.observations[self.group], step.reward, step.terminated, step.truncated, info

    def close_extras(self, **kwargs: Any) -> None:
        """Stop the threads of the simulation.

        Args:
            kwargs: not used.
        """
        self.environment.close()
