"""The best of several policies on a design, chosen by some trials and reported by the others.

Several trainings of one recipe walk a design unequally well: one may fall where another one walks.
How good a design is shows in the policy that walks it best, not in the mean over its policies. The
trials that decide which policy is best flatter it, since it is the best of several noisy values; so
odd-numbered trials decide, and the even-numbered ones are reported. The number of a trial fixes
its starting state, which is the same for every policy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hyperleg_design.evaluation.result import counted
from hyperleg_design.evaluation.rollout import ARRIVED

if TYPE_CHECKING:
    import pandas as pd

FEWEST_TRIALS = 2
"""Trials that each of several policies needs: one that decides and one that is reported."""
_COST = "cost_of_transport"


def best_policy(trials: pd.DataFrame) -> str:
    """Name the policy that arrives most often; of equals, that of the lowest mean cost of transport
    over the trials that did not fall.

    Arrivals count rather than falls, because a robot that only stands never falls.

    Args:
        trials: of one design under one protocol, `policy`, `outcome`, `fell` and
            `cost_of_transport` of each.

    Returns:
        The name of its training; the first one where several are equal in both.
    """
    ranked = (
        trials.assign(arrived=trials["outcome"] == ARRIVED, cost=counted(trials, _COST))
        .groupby("policy", sort=False)
        .agg(arrived=("arrived", "mean"), cost=("cost", "mean"))
        .sort_values(["arrived", "cost"], ascending=[False, True], kind="stable")
    )
    return str(ranked.index[0])


def reported_trials(trials: pd.DataFrame) -> pd.DataFrame:
    """Choose the trials that a design is judged by.

    Args:
        trials: of one design under one protocol; several policies have `FEWEST_TRIALS` each.

    Returns:
        The even-numbered trials of the policy that is best in the odd-numbered ones; all trials
        where there is one policy.
    """
    if trials["policy"].nunique() == 1:
        return trials
    decides = trials["trial"] % 2 == 1
    return trials[~decides & (trials["policy"] == best_policy(trials[decides]))]
