"""What a policy step of many simulations gives."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True, eq=False)
class Divergence:
    """A simulation that left what can be computed, with the state from which it did within one
    policy step.
    """

    simulation: int
    episode_step: int
    """Policy steps since the episode began."""
    reason: str
    position: np.ndarray
    """MuJoCo's qpos before, `(7 + J,)`."""
    velocity: np.ndarray
    """MuJoCo's qvel before, `(6 + J,)`."""
    action: np.ndarray
    """Last action of the policy, `(J,)`."""


@dataclass(eq=False)
class Step:
    """What one policy step of n simulations gives back; ended simulations have been started anew
    already.
    """

    observations: dict[str, np.ndarray]
    """Observations by group, `(n, size)`, single precision; of the new episode where one ended."""
    reward: np.ndarray
    """Rewards, `(n,)`; zero for a diverged simulation."""
    terminated: np.ndarray
    """Whether the robot fell, `(n,)`."""
    truncated: np.ndarray
    """Whether the episode ended otherwise, `(n,)`."""
    ending: np.ndarray
    """Index into `ENDINGS`, `(n,)`."""
    reward_terms: np.ndarray
    """Each term, weighted, `(n, terms)` in the order of the task's rewards; they sum to the
    reward."""
    ended: np.ndarray
    """Simulations that ended, `(m,)`."""
    final_observations: dict[str, np.ndarray]
    """Their last observations before the new start, by group, `(m, size)`."""
    episode_steps: np.ndarray
    """Length of the episodes that ended [policy steps], `(m,)`."""
    divergences: list[Divergence]


def joined(parts: Iterable[Any]) -> dict[str, np.ndarray]:
    """Join arrays of several parts of the simulations.

    Args:
        parts: arrays by name, `(n_i, ...)` each; the same names in all.

    Returns:
        By name, `(n, ...)`.
    """
    parts = list(parts)
    return {
        name: np.concatenate([p[name] for p in parts])
        if len(parts) > 1
        else np.asarray(parts[0][name])
        for name in parts[0]
    }


def merged(parts: list[Step]) -> Step:
    """Merge what a step gave in several parts of the simulations.

    Args:
        parts: in the order of the simulations.

    Returns:
        The step of all.
    """
    arrays = (
        "reward",
        "terminated",
        "truncated",
        "ending",
        "reward_terms",
        "ended",
        "episode_steps",
    )
    return Step(
        observations=joined(p.observations for p in parts),
        final_observations=joined(p.final_observations for p in parts),
        divergences=[d for p in parts for d in p.divergences],
        **{name: np.concatenate([getattr(p, name) for p in parts]) for name in arrays},
    )
