"""One robot behind Gymnasium's interface, registered as `hyperleg/Walk-v0` and `hyperleg/TTest-v0`.

    import gymnasium
    from hyperleg_design.simulation import gymnasium_single

    gymnasium.register_envs(gymnasium_single)
    env = gymnasium.make("hyperleg/Walk-v0", design="toe_locked")

The import registers the names. Many robots at once are faster: `gymnasium.make_vec`, or
`GymnasiumVector` itself.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np

from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.parameters.described import RobotDesign
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.gymnasium_vector import ACTION_BOUND, GymnasiumVector
from hyperleg_design.simulation.tasks import Task, load_task

NAMES = {"hyperleg/Walk-v0": "walk", "hyperleg/TTest-v0": "t_test_free"}
"""Task of each registered environment."""


class GymnasiumSingle(gymnasium.Env):  # type: ignore[misc]
    """One simulation of one robot; observations and rewards as `Environment` has them."""

    def __init__(
        self,
        task: str | Path | Task = "walk",
        design: str | Path | RobotDesign = "toe",
        *,
        seed: int = 0,
        group: str = "policy",
        render_mode: str | None = None,
    ) -> None:
        """Prepare a simulation.

        Args:
            task: a shipped name, a YAML file, or a task.
            design: a shipped name, a YAML file, or one robot.
            seed: of starting states, commands and disturbances until `reset` is given another.
            group: observations that are returned: `policy`, or `critic` with what sensors lack.
            render_mode: must be None; `hyperleg video` draws.

        Raises:
            InputError: a task, design or seed that cannot be used.
        """
        self.task = task if isinstance(task, Task) else load_task(task)
        self.design = design if isinstance(design, RobotDesign) else load_robot(design)
        self.group, self.render_mode = group, render_mode
        self._begin(seed)
        size = self.environment.observation_sizes[group]
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (size,), np.float32)
        self.action_space = gymnasium.spaces.Box(
            -ACTION_BOUND, ACTION_BOUND, (self.environment.action_size,), np.float32
        )

    def _begin(self, seed: int) -> None:
        self.environment = Environment(self.design, self.task, simulations=1, seed=seed, threads=1)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Start an episode; the same seed gives the same episodes from there on.

        Args:
            seed: of the random numbers; those of the running environment by default.
            options: not used.

        Returns:
            Observation and an empty mapping.
        """
        super().reset(seed=seed)
        if seed is not None:
            self.environment.close()
            self._begin(seed)
        return self.environment.reset()[self.group][0], {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Advance by one policy step; after the last of an episode, the observation is that of its
        end.

        Args:
            action: `(J,)`.

        Returns:
            Observation, reward, whether the episode terminated, whether it was truncated, and an
            empty mapping.
        """
        result = self.environment.step(np.asarray(action)[None])
        terminated, truncated = bool(result.terminated[0]), bool(result.truncated[0])
        ended = terminated or truncated
        observations = result.final_observations if ended else result.observations
        return observations[self.group][0], float(result.reward[0]), terminated, truncated, {}

    def close(self) -> None:
        """Stop the simulation and its threads."""
        self.environment.close()


def _vector(
    num_envs: int = 1,
    task: str | Path | Task = "walk",
    design: str | Path | RobotDesign = "toe",
    seed: int = 0,
    threads: int | None = None,
) -> GymnasiumVector:
    """Entry point of `gymnasium.make_vec`."""
    environment = Environment(
        design if isinstance(design, RobotDesign) else load_robot(design),
        task if isinstance(task, Task) else load_task(task),
        simulations=num_envs,
        seed=seed,
        threads=threads,
    )
    return GymnasiumVector(environment)


def register() -> None:
    """Register the names of `NAMES` with Gymnasium; twice does no harm."""
    for name, task in NAMES.items():
        if name not in gymnasium.registry:
            gymnasium.register(
                id=name,
                entry_point=f"{__name__}:GymnasiumSingle",
                vector_entry_point=f"{__name__}:_vector",
                kwargs={"task": task},
            )


register()
