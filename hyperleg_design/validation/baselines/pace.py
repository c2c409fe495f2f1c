"""PACE (arXiv 2509.06342): CMA-ES on the whole-log position error of simulation replays, through
the package `cma`.

As in its published code: parameters scaled to [-1, 1] between bounds, start in the middle with a
step of 0.5, mean squared position error as the score, the mean of the search distribution as the
answer, and a stop where the best and the worst of a generation differ by less than `EPSILON` of the
best. It runs 4096 simulations side by side on a GPU; here the population is one for two processor
cores.
"""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.validation.baselines.drive_set import DriveSet, Fitted, check_logs
from hyperleg_design.validation.baselines.population import position_gap

SIGMA = 0.5
"""First step, of parameters scaled to [-1, 1]."""
EPSILON = 1e-2
"""Spread of a generation over its best at which the search ends."""
GENERATIONS = 500


def fit_pace(
    signals: Sequence[Signals],
    drives: DriveSet,
    *,
    seed: int = 0,
    population: int | None = None,
    generations: int = GENERATIONS,
    seconds: float = np.inf,
) -> Fitted:
    """Fit PACE's parameters to logs.

    Args:
        signals: conditioned logs with targets and gains, base fixed.
        drives: parameters of the robot.
        seed: of the search.
        population: simulations a generation; by default 16, or what `cma` takes for so many
            parameters, whichever is more.
        generations: at most.
        seconds: budget; a generation that has begun is finished.

    Raises:
        InputError: logs that cannot be replayed, or `cma` is not installed.
    """
    try:
        import cma
    except ModuleNotFoundError:
        raise InputError(
            "baselines", "pace", None, "needs the package cma: install hyperleg-design[baselines]"
        ) from None
    check_logs(signals)
    begun = time.perf_counter()
    size = population or max(16, 4 + int(3 * np.log(drives.count)))
    options = {
        "bounds": [-1.0, 1.0],
        "popsize": size,
        "seed": seed + 1,
        "verbose": -9,
        "maxiter": generations,
    }
    search = cma.CMAEvolutionStrategy(np.zeros(drives.count), SIGMA, options)

    def values_of(scaled: np.ndarray) -> np.ndarray:
        return np.asarray(
            drives.low + (np.clip(scaled, -1, 1) + 1) / 2 * (drives.high - drives.low)
        )

    history: list[tuple[float, np.ndarray]] = []
    evaluations, stopped = 0, f"{generations} generations"
    while not search.stop():
        asked = np.array(search.ask())
        scores = position_gap(signals, drives, values_of(asked)) ** 2
        scores = np.where(np.isfinite(scores), scores, 1e6)
        search.tell(list(asked), scores.tolist())
        evaluations += size
        history.append((time.perf_counter() - begun, values_of(search.mean)))
        if scores.max() - scores.min() < EPSILON * scores.min():
            stopped = "converged"
            break
        if history[-1][0] > seconds:
            stopped = f"{seconds:g} s"
            break
    else:
        stopped = ", ".join(search.stop())
    return Fitted(
        "pace",
        values_of(search.mean),
        time.perf_counter() - begun,
        evaluations,
        tuple(history),
        stopped,
    )
