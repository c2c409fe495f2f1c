"""What a training shows of itself: reward terms, speed, falls, power and cost of transport,
averaged over an iteration.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.simulation.waypoint_commands import WaypointCommands

if TYPE_CHECKING:
    from hyperleg_design.simulation.environment import Environment
    from hyperleg_design.simulation.stepping.step import Step

MEMORY = 0.9
"""Weight of the past in the running means that steer the assist; assumed."""


class Meter:
    """Sums over the steps of an iteration, and running means over iterations."""

    def __init__(self, environment: Environment) -> None:
        self.environment = environment
        self.goal = isinstance(environment.task.commands, WaypointCommands)
        self.steps = self.ends = self.share = 0.0
        self.clear()

    def clear(self) -> None:
        """Set the sums of one iteration back to zero."""
        self._terms = np.zeros(len(self.environment.reward_names))
        self._falls = self._ends = self._count = self._looks = 0
        self._speed = 0.0

    def note(self, step: Step) -> None:
        """Take in one policy step of all simulations.

        Args:
            step: its rewards and endings.
        """
        self._terms += step.reward_terms.sum(0)
        self._count += len(step.reward)
        self._ends += len(step.ended)
        self._falls += int(step.terminated.sum())
        self._speed += mean_speed(self.environment, self.goal)
        self._looks += 1

    def read(self) -> dict[str, Any]:
        """Means over the iteration, which ends it.

        Returns:
            `reward` and `terms` (each a second, weighted), `speed` [m/s], `falls` (a robot's
            minute), `power` [W], `cost_of_transport`, `episode` (mean length of late [policy
            steps]) and `share` (see `Schedule.advance`).
        """
        environment, duration = self.environment, self.environment.task.physics.policy_step
        terms = dict(
            zip(environment.reward_names, self._terms / (self._count * duration), strict=True)
        )
        rewards = environment.chunks[0].rewards
        speed = self._speed / self._looks
        weight = rewards["power"].weight if "power" in rewards else 0.0
        power = terms["power"] / weight if weight else float("nan")
        name = "position_progress" if self.goal else "linear_velocity"
        share = (
            terms[name] / rewards[name].weight if name in rewards and rewards[name].weight else 0.0
        )
        if self.goal:
            share /= speed_cap(environment) * duration  # progress is a distance
        self.steps = MEMORY * self.steps + self._count
        self.ends = MEMORY * self.ends + self._ends
        self.share = share if not self.share else MEMORY * self.share + (1 - MEMORY) * share
        measures = {
            "reward": float(sum(terms.values())),
            "terms": {k: float(v) for k, v in terms.items()},
            "speed": float(speed),
            "falls": 60.0 * self._falls / (self._count * duration),
            "power": float(power),
            "cost_of_transport": float(power / (np.mean(environment.layout.weight) * speed))
            if speed > 0.05
            else float("nan"),
            "episode": float(self.steps / max(self.ends, 1.0)),
            "share": float(self.share),
        }
        self.clear()
        return measures

    def state(self) -> dict[str, float]:
        """Collect the running means that a checkpoint keeps.

        Returns:
            Means by name, as `put` takes them.
        """
        return {"steps": self.steps, "ends": self.ends, "share": self.share}

    def put(self, state: dict[str, float]) -> None:
        """Restore the running means of a checkpoint.

        Args:
            state: means by name.
        """
        self.steps, self.ends, self.share = state["steps"], state["ends"], state["share"]


def speed_cap(environment: Environment) -> float:
    """Look up the speed that waypoint commands ask for at present.

    Args:
        environment: of the training.

    Returns:
        The speed [m/s].
    """
    commands: Any = environment.chunks[0].commander.settings
    return float(commands.speed_cap)


def mean_speed(environment: Environment, goal: bool) -> float:
    """Compute the mean speed of all robots at this moment.

    Args:
        environment: of the training.
        goal: whether the task has waypoints: then speeds in any direction count, else those
            straight ahead.

    Returns:
        The speed [m/s].
    """
    speeds = []
    for chunk in environment.chunks:
        velocity = chunk.motion.walking_velocity
        speeds.append(np.hypot(velocity[:, 0], velocity[:, 1]) if goal else velocity[:, 0])
    return float(np.concatenate(speeds).mean())
