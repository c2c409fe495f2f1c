"""Run a policy in an environment and keep everything that happens, 200 times a second."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.simulation.environment import Environment

Policy = Callable[[np.ndarray], np.ndarray]
"""A function from observations of the group `policy`, `(n, size)`, to actions, `(n, J)`."""


@dataclass(frozen=True, eq=False)
class Recording:
    """What n simulations did, in T policy steps of S simulation steps each."""

    signals: dict[str, np.ndarray]
    """Recorded signals by name, `(n, T S, ...)` each; see `Environment.signals`."""
    time_step: float
    """Time between two entries of a signal [s]."""
    commands: np.ndarray
    """Commands that the policy saw, `(n, T, 3)`."""
    actions: np.ndarray
    """Actions of the policy, `(n, T, J)`."""
    reward_terms: np.ndarray
    """Value of each reward term, `(n, T, terms)`."""
    ending: np.ndarray
    """Index into `ENDINGS` of each step, `(n, T)`."""
    first_end: np.ndarray
    """Policy step in which each simulation's first episode ended, T where it did not, `(n,)`; later
    entries are of a new episode."""

    @property
    def substeps(self) -> int:
        """Simulation steps in one policy step."""
        return next(iter(self.signals.values())).shape[1] // max(self.ending.shape[1], 1)


def rollout(
    environment: Environment,
    policy: Policy,
    steps: int,
    *,
    keep: Sequence[str] | None = None,
    each_step: Callable[[int, np.ndarray], bool | None] | None = None,
) -> Recording:
    """Start all simulations and run a policy in them; deterministic given the environment's seed.

    Args:
        environment: without assist.
        policy: any callable.
        steps: policy steps at most.
        keep: names of the signals to keep; all by default.
        each_step: called after each step with its number and `ending`; returning True stops, for
            progress bars and goals.

    Returns:
        The signals of all steps.

    Raises:
        InputError: the environment has an assist, a signal does not exist, or the policy's actions
        are wrong or not finite.
    """
    if environment.assist is not None:
        raise InputError(
            "rollout",
            "assist",
            environment.assist.gain,
            "must be None: recordings are of the robot alone",
        )
    environment.recording = True
    observations = environment.reset()
    recorded: dict[str, list[np.ndarray]] = {}
    commands, actions, terms, endings = [], [], [], []
    command_columns = [
        i
        for i, name in enumerate(environment.observation_columns["policy"])
        if name.startswith("command.")
    ]
    for number in range(steps):
        commands.append(observations["policy"][:, command_columns])
        action = np.asarray(policy(observations["policy"]))
        step = environment.step(action)
        observations = step.observations
        signals = environment.signals()
        for name in signals if keep is None else keep:
            if name not in signals:
                raise InputError(
                    "rollout", "keep", name, f"no such signal; there are {', '.join(signals)}"
                )
            recorded.setdefault(name, []).append(signals[name].copy())
        actions.append(action)
        terms.append(step.reward_terms)
        endings.append(step.ending)
        if each_step is not None and each_step(number, step.ending):
            break
    ending = np.stack(endings, 1)
    ended = ending != 0
    return Recording(
        signals={name: np.concatenate(parts, 1) for name, parts in recorded.items()},
        time_step=float(environment.task.physics.time_step),
        commands=np.stack(commands, 1),
        actions=np.stack(actions, 1),
        reward_terms=np.stack(terms, 1),
        ending=ending,
        first_end=np.where(ended.any(1), ended.argmax(1), ending.shape[1]),
    )
