"""How episodes end: one small function each, and the codes under which ends are reported."""

from __future__ import annotations

import numpy as np

from hyperleg_design.simulation.settings import Limits
from hyperleg_design.simulation.state import Goal, Motion

ENDINGS = ("running", "low", "tilted", "time_out", "off_path", "course_finished", "diverged")
"""What `Step.ending` counts: index 0 while an episode goes on."""
RUNNING, LOW, TILTED, TIME_OUT, OFF_PATH, COURSE_FINISHED, DIVERGED = range(len(ENDINGS))


def fell(code: np.ndarray) -> np.ndarray:
    """Endings that terminate an episode, `(n,)`; the others truncate it."""
    return (code == LOW) | (code == TILTED)


def low(motion: Motion, limits: Limits) -> np.ndarray:
    """Pelvis below its least height, `(n,)`."""
    return motion.position[:, 2] < limits.height


def tilted(motion: Motion, limits: Limits) -> np.ndarray:
    """Pelvis leaning too far, `(n,)`."""
    return motion.rotation[:, 2, 2] < np.cos(limits.tilt)


def time_out(episode_step: np.ndarray, limits: Limits, policy_step: float) -> np.ndarray:
    """Episode at its full length, `(n,)`."""
    return episode_step >= round(limits.duration / policy_step)


def off_path(goal: Goal | None, limits: Limits, count: int) -> np.ndarray:
    """Too far from the path to the waypoint, `(n,)`."""
    return np.zeros(count, bool) if goal is None else goal.deviation > limits.deviation


def ending(
    motion: Motion, goal: Goal | None, episode_step: np.ndarray, limits: Limits, policy_step: float
) -> np.ndarray:
    """Code of how each episode ends in this step, `(n,)`; falls come first, then a finished
    course.
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
