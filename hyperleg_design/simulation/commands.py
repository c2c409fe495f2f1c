"""Commands: a velocity to keep, or waypoints to reach one after the other."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.parameters.fields import number
from hyperleg_design.robot.parameters.values import Checked
from hyperleg_design.simulation.state import Goal, Motion
from hyperleg_design.simulation.stepping.streams import Random, of_rows
from hyperleg_design.simulation.waypoint_commands import WaypointCommander, WaypointCommands


@dataclass(frozen=True, eq=False, kw_only=True)
class VelocityCommands(Checked):
    """Velocities drawn anew now and then; uniform within their ranges."""

    forward_low: Any = number("m/s", -5, 5, default=0.6)
    """Smallest commanded forward speed [m/s]."""
    forward_high: Any = number("m/s", -5, 5, default=1.4)
    """Largest commanded forward speed [m/s]."""
    sideways: Any = number("m/s", 0, 3, default=0.0)
    """Either way [m/s]."""
    turning: Any = number("rad/s", 0, 5, default=0.0)
    """Either way [rad/s]."""
    test_share: Any = number("", 0, 1, default=0.4)
    """Fraction of commands that are the test's: straight on at `test_speed` [-]."""
    test_speed: Any = number("m/s", -5, 5, default=1.33)
    """Forward speed of the test's commands [m/s]; 1.33 is the paper's walk (Table III)."""
    standing_share: Any = number("", 0, 1, default=0.0)
    """Fraction of commands that are zero [-]."""
    interval: Any = number("s", 0.1, 10000, default=10.0)
    """Time between two commands [s]."""


class VelocityCommander:
    """Velocity commands in the yaw frame."""

    turns = False

    def __init__(self, settings: VelocityCommands, count: int) -> None:
        self.settings = settings
        self.values = np.zeros((count, 3))
        self.left = np.zeros(count)

    def reset(self, ids: np.ndarray, motion: Motion, rng: Random) -> None:
        """Draw new commands for some simulations.

        Args:
            ids: indices of the simulations.
            motion: of these simulations.
            rng: random numbers.
        """
        s, count = self.settings, len(ids)
        drawn = np.empty((count, 3))
        drawn[:, 0] = rng.uniform(s.forward_low, s.forward_high, count)
        drawn[:, 1] = rng.uniform(-s.sideways, s.sideways, count)
        drawn[:, 2] = rng.uniform(-s.turning, s.turning, count)
        which = rng.uniform(size=count)
        drawn[which < s.test_share] = (s.test_speed, 0.0, 0.0)
        drawn[which >= 1.0 - s.standing_share] = 0.0
        self.values[ids] = drawn
        self.left[ids] = s.interval

    def judge(self, motion: Motion) -> None:
        """Do nothing: velocity commands have no waypoints that could be reached.

        Args:
            motion: of all simulations.
        """

    def advance(self, motion: Motion, goal: Goal | None, duration: float, rng: Random) -> None:
        """Draw new commands where the time of the old ones is over.

        Args:
            motion: of all simulations.
            goal: None.
            duration: of the policy step [s].
            rng: random numbers.
        """
        self.left -= duration
        over = np.flatnonzero(self.left < 0.5 * duration)
        if len(over):
            self.reset(over, motion, of_rows(rng, over))

    def vector(self, goal: Goal | None, ids: np.ndarray | None = None) -> np.ndarray:
        """Collect the commanded velocities.

        Args:
            goal: None.
            ids: indices of the simulations; all by default.

        Returns:
            Forward and sideways velocity [m/s] and turning rate [rad/s], `(n, 3)`.
        """
        return self.values.copy() if ids is None else self.values[ids]

    def wanted(self, goal: Goal | None) -> np.ndarray:
        """Go straight on at the forward speed.

        Args:
            goal: None.

        Returns:
            Speed [m/s], `(n,)`.
        """
        return self.values[:, 0]


def commander(
    settings: VelocityCommands | WaypointCommands, count: int
) -> VelocityCommander | WaypointCommander:
    """Make the runtime of a kind of command.

    Args:
        settings: of the commands.
        count: number of simulations.

    Returns:
        The commander.
    """
    return (
        VelocityCommander(settings, count)
        if isinstance(settings, VelocityCommands)
        else WaypointCommander(settings, count)
    )


def changed_commands(
    settings: VelocityCommands | WaypointCommands, values: Mapping[str, Any], where: str
) -> VelocityCommands | WaypointCommands:
    """Change settings of commands.

    Args:
        settings: as they are.
        values: new settings by name.
        where: task, for error messages.

    Returns:
        The validated copy.

    Raises:
        InputError: no such setting, or a value that makes no sense.
    """
    known = [f.name for f in dataclasses.fields(settings)]
    for name, value in values.items():
        if name not in known:
            raise InputError(
                where, f"commands.{name}", value, f"no such setting; there are {', '.join(known)}"
            )
    return dataclasses.replace(settings, **values)
