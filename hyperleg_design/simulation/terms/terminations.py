"""How episodes end: one small function each, and the codes under which ends are reported."""

from __future__ import annotations

import numpy as np

from hyperleg_design.simulation.settings import Limits
from hyperleg_design.simulation.state import Goal, Motion

ENDINGS = ("running", "low", "tilted", "time_out", "off_path", "course_finished", "diverged")
"""What `Step.ending` counts: index 0 while an episode goes on."""
RUNNING, LOW, TILTED, TIME_OUT, OFF_PATH, COURSE_FINISHED, DIVERGED = range(len(ENDINGS))


def fell(code: np.ndarray) -> np.ndarray:
    """Decide which endings terminate an episode; the others truncate it.

    Args:
        code: of each ending, `(n,)`.

    Returns:
        True for a fall, `(n,)`.
    """
    return (code == LOW) | (code == TILTED)


def low(motion: Motion, limits: Limits) -> np.ndarray:
    """Decide whose pelvis is below its least height.

    Args:
        motion: of all simulations.
        limits: give the height.

    Returns:
        `(n,)`.
    """
    return motion.position[:, 2] < limits.height


def tilted(motion: Motion, limits: Limits) -> np.ndarray:
    """Decide whose pelvis leans too far.

    Args:
        motion: of all simulations.
        limits: give the angle.

    Returns:
        `(n,)`.
    """
    return motion.rotation[:, 2, 2] < np.cos(limits.tilt)


def time_out(episode_step: np.ndarray, limits: Limits, policy_step: float) -> np.ndarray:
    """Decide whose episode is at its full length.

    Args:
        episode_step: number of policy steps so far, `(n,)`.
        limits: give the duration.
        policy_step: duration of a policy step [s].

    Returns:
        `(n,)`.
    """
    return episode_step >= round(limits.duration / policy_step)


def off_path(goal: Goal | None, limits: Limits, count: int) -> np.ndarray:
    """Decide who is too far from the path to the waypoint.

    Args:
        goal: of all simulations; None without waypoints.
        limits: give the distance.
        count: n, number of simulations.

    Returns:
        `(n,)`.
    """
    return np.zeros(count, bool) if goal is None else goal.deviation > limits.deviation


def ending(
    motion: Motion, goal: Goal | None, episode_step: np.ndarray, limits: Limits, policy_step: float
) -> np.ndarray:
    """Decide how episodes end in this step; falls come first, then a finished course.

    Args:
        motion: of all simulations.
        goal: of all simulations; None without waypoints.
        episode_step: number of policy steps so far, `(n,)`.
        limits: at which episodes end.
        policy_step: duration of a policy step [s].

    Returns:
        Codes, `(n,)`; zero where an episode goes on.
    """
    count = len(episode_step)
    code = np.zeros(count, np.int8)
    code[time_out(episode_step, limits, policy_step)] = TIME_OUT
    if goal is not None:
        code[off_path(goal, limits, count)] = OFF_PATH
        code[goal.finished] = COURSE_FINISHED
    code[tilted(motion, limits)] = TILTED
    code[low(motion, limits)] = LOW
    return code
