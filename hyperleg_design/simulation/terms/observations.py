"""Observations: named parts, each a list of columns, and how each looks in a mirror.

The proprioceptive part has 9 + 4 J numbers, the paper's 65 with the toe and 57 without: angular
velocity, gravity and command (3 each), then joint position less the default posture, joint
velocity, action and the action before it. Numbers are in SI units, not scaled; a learner normalises
them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.simulation.layout import Layout
from hyperleg_design.simulation.state import State
from hyperleg_design.simulation.terms.rewards import Robot
from hyperleg_design.simulation.waypoint_commands import clipped

SCAN = (17, 11)
"""Points of the height scan, along x and y (Isaac Lab: 1.6 m x 1.0 m at 0.1 m)."""
SCAN_OFFSET = 0.5
"""Subtracted from the pelvis's height above each point [m] (Isaac Lab)."""
Column = tuple[str, int, tuple[float, ...]]
"""Name, size, and the signs that its numbers take in a mirror."""


@dataclass(frozen=True)
class Part:
    """A part of an observation."""

    name: str
    function: Callable[[State, Robot], list[np.ndarray]]
    """Arrays `(n, k)` in the order of `columns`."""
    columns: Callable[[Layout], list[Column]]
    needs_goal: bool = False


def proprioception(state: State, robot: Robot) -> list[np.ndarray]:
    """Observe what the robot's own sensors measure, with the command and the last two actions.

    Args:
        state: of all simulations after a policy step.
        robot: what parts know of the robot.

    Returns:
        Columns, `(n, k)` each.
    """
    motion = state.motion if state.sensed is None else state.sensed
    joint_position = motion.joint_position - robot.layout.default
    return [
        motion.angular_velocity,
        motion.gravity,
        state.command,
        joint_position,
        motion.joint_velocity,
        state.action,
        state.previous_action,
    ]


def clock(state: State, robot: Robot) -> list[np.ndarray]:
    """Observe sine and cosine of the gait clock times its gain; a deviation from the paper.

    Args:
        state: of all simulations after a policy step.
        robot: what parts know of the robot.

    Returns:
        Columns, `(n, k)` each.
    """
    angle, gain = 2 * np.pi * state.phase, robot.clock.shown
    return [gain * np.sin(angle)[:, None], gain * np.cos(angle)[:, None]]


def waypoint(state: State, robot: Robot) -> list[np.ndarray]:
    """Observe the offset to the waypoint after the present one (clipped), the distance to the
    present one, and the speed cap.

    Args:
        state: of all simulations after a policy step.
        robot: what parts know of the robot.

    Returns:
        Columns, `(n, k)` each.
    """
    assert state.goal is not None
    return [
        clipped(state.goal.following),
        state.goal.distance[:, None],
        state.goal.speed_cap[:, None],
    ]


def path(state: State, robot: Robot) -> list[np.ndarray]:
    """Observe the vector to the nearest point of the straight line between the last waypoint and
    the present one (clipped), without which nobody can return to that line.

    Args:
        state: of all simulations after a policy step.
        robot: what parts know of the robot.

    Returns:
        Columns, `(n, k)` each.
    """
    assert state.goal is not None
    return [clipped(state.goal.to_path)]


def privileged(state: State, robot: Robot) -> list[np.ndarray]:
    """Observe what only a simulation knows: linear velocity, pelvis height, and vertical force on
    each foot over the weight.

    Args:
        state: of all simulations after a policy step.
        robot: what parts know of the robot.

    Returns:
        Columns, `(n, k)` each.
    """
    load = state.foot_load[-1] / np.reshape(robot.layout.weight, (-1, 1))
    return [state.motion.local_velocity, state.motion.position[:, 2:3], load]


def height_scan(state: State, robot: Robot) -> list[np.ndarray]:
    """Observe the pelvis height above each point of a grid minus `SCAN_OFFSET`, clipped to 1 m; on
    a flat floor all are the same.

    Args:
        state: of all simulations after a policy step.
        robot: what parts know of the robot.

    Returns:
        Columns, `(n, k)` each.
    """
    height = np.clip(state.motion.position[:, 2:3] - SCAN_OFFSET, -1.0, 1.0)
    return [np.broadcast_to(height, (len(height), SCAN[0] * SCAN[1]))]


def design(state: State, robot: Robot) -> list[np.ndarray]:
    """Observe numbers of the robot's design, scaled by the ranges over which the task's designs are
    drawn; they are the same throughout an episode.

    Args:
        state: of all simulations after a policy step.
        robot: what parts know of the robot.

    Returns:
        Columns, `(n, k)` each.
    """
    observed = robot.layout.observed
    return [np.broadcast_to(observed, (len(state.command), observed.shape[-1]))]


def _proprioception_columns(layout: Layout) -> list[Column]:
    joints = len(layout.joints)
    return [
        ("angular_velocity", 3, (-1, 1, -1)),
        ("gravity", 3, (1, -1, 1)),
        ("command", 3, (1, -1, -1)),
        ("joint_position", joints, ()),
        ("joint_velocity", joints, ()),
        ("action", joints, ()),
        ("previous_action", joints, ()),
    ]


PARTS: dict[str, Part] = {
    "proprioception": Part("proprioception", proprioception, _proprioception_columns),
    "clock": Part(
        "clock", clock, lambda layout: [("clock_sine", 1, (-1,)), ("clock_cosine", 1, (-1,))]
    ),
    "waypoint": Part(
        "waypoint",
        waypoint,
        lambda layout: [
            ("following_waypoint", 2, (1, -1)),
            ("waypoint_distance", 1, (1,)),
            ("speed_cap", 1, (1,)),
        ],
        needs_goal=True,
    ),
    "path": Part("path", path, lambda layout: [("to_path", 2, (1, -1))], needs_goal=True),
    "privileged": Part(
        "privileged",
        privileged,
        lambda layout: [
            ("linear_velocity", 3, (1, -1, 1)),
            ("pelvis_height", 1, (1,)),
            ("foot_load", len(layout.feet), ()),
        ],
    ),
    "height_scan": Part(
        "height_scan", height_scan, lambda layout: [("height_scan", SCAN[0] * SCAN[1], ())]
    ),
    "design": Part("design", design, lambda layout: [(n, 1, (1,)) for n in layout.observed_names]),
}
"""All parts by name. Columns without signs swap sides instead: joints and feet left and right, scan
points across."""


def columns(parts: Sequence[str], layout: Layout) -> list[Column]:
    """List the columns of an observation.

    Args:
        parts: of the observation, by name.
        layout: of the robot.

    Returns:
        Name, number of numbers, and signs in a mirror, of each column.
    """
    return [column for part in parts for column in PARTS[part].columns(layout)]


def size(parts: Sequence[str], layout: Layout) -> int:
    """Count the numbers in an observation.

    Args:
        parts: of the observation, by name.
        layout: of the robot.

    Returns:
        The count.
    """
    return sum(column[1] for column in columns(parts, layout))


def column_names(parts: Sequence[str], layout: Layout) -> list[str]:
    """Name each number of an observation.

    Args:
        parts: of the observation, by name.
        layout: of the robot.

    Returns:
        Names, such as `joint_position.left_knee`.
    """
    names = []
    for name, count, _ in columns(parts, layout):
        joints = name in ("joint_position", "joint_velocity", "action", "previous_action")
        names += [
            f"{name}.{layout.joints[i]}" if joints else name if count == 1 else f"{name}.{i}"
            for i in range(count)
        ]
    return names


def observe(
    groups: Mapping[str, Sequence[str]], state: State, robot: Robot
) -> dict[str, np.ndarray]:
    """Compute the observations of all simulations.

    Args:
        groups: parts of each group.
        state: after a policy step.
        robot: what the parts know of the robot.

    Returns:
        Observations by group, `(n, size)` each, in single precision.
    """
    arrays = {
        part: PARTS[part].function(state, robot)
        for part in dict.fromkeys(p for parts in groups.values() for p in parts)
    }
    return {
        group: np.concatenate(
            [a for part in parts for a in arrays[part]], 1, dtype=np.float32, casting="same_kind"
        )
        for group, parts in groups.items()
    }
