"""What the reward does to the study's answer, as a part of a page: walks with and without the toe
under several rewards.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

from hyperleg_design.evaluation.measures import measure_of
from hyperleg_design.evaluation.plans.analysis_plan import Outcome, load_plan
from hyperleg_design.evaluation.plans.planned_analysis import PlannedRow, planned_analysis
from hyperleg_design.learning.campaigns.campaign import compared_groups
from hyperleg_design.report.drawer import Part
from hyperleg_design.report.page import Table
from hyperleg_design.report.walks.beside_paper import percent
from hyperleg_design.report.walks.compared import REWARDS
from hyperleg_design.simulation.tasks import load_task

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd

MEASURES = (
    "steady_cost_of_transport",
    "steady_joule_power",
    "grf_peak_body_weights",
    "cadence",
    "knee_touchdown",
    "arrived",
)
"""Measures of a walk that are compared under each reward."""


def reward_rows(trials: pd.DataFrame) -> dict[str, list[PlannedRow]]:
    """Compare the two arms of the analysis plan under each reward, as the plan compares them.

    Args:
        trials: walks, one row each, with `group`, `variant` and `seed` of the training.

    Returns:
        One row for each of `MEASURES`, by group; corrected within a group.
    """
    outcomes = tuple(Outcome(protocol="walk", measure=name, trials="all") for name in MEASURES)
    plan = dataclasses.replace(load_plan(), primary=(), secondary=outcomes)
    return {
        group: planned_analysis(plan, {"walk": trials[trials["group"] == group]})
        for group in compared_groups(REWARDS)
        if (trials["group"] == group).any()
    }


def reward_names(deviations: Mapping[str, Mapping[str, str]]) -> dict[str, str]:
    """Name rewards by the terms that set them apart.

    Args:
        deviations: by reward, each term that is not the paper's, with a description, as
            `Task.deviations` gives them.

    Returns:
        A name of each; `the paper's` for one that has only terms which all of them have.
    """
    common = set.intersection(*(set(terms) for terms in deviations.values()))
    names = {}
    for key, terms in deviations.items():
        apart = [
            f"another weight of {term}" if text.startswith("weight ") else term.replace("_", " ")
            for term, text in terms.items()
            if term not in common
        ]
        names[key] = f"with {' and '.join(apart)}" if apart else "the paper's"
    return names


def rewards(trials: pd.DataFrame) -> Part:
    """Tabulate both arms under each reward.

    Args:
        trials: as `reward_rows` takes them.

    Returns:
        The part.
    """
    plan = load_plan()
    deviations = {g: load_task(task).deviations for g, task in compared_groups(REWARDS).items()}
    names = reward_names(deviations)
    rows = [
        [
            names[group],
            row.outcome.measure.replace("_", " "),
            measure_of(row.outcome.measure).unit,
            row.active,
            row.compared,
            percent(row.change, row.low, row.high),
            row.p_value,
            f"{row.trainings[0]}, {row.trainings[1]}",
        ]
        for group, some in reward_rows(trials).items()
        for row in some
    ]
    differing = [
        [names[group], term.replace("_", " "), text]
        for group, terms in deviations.items()
        for term, text in terms.items()
    ]
    arms = (plan.active.replace("_", " "), plan.compared.replace("_", " "))
    head = ["reward", "measure", "unit", *arms, "change", "p", "trainings"]
    return Part(
        "What the reward does to the answer",
        [
            "Walks trained from the same guided policies under the paper's reward, and with one "
            "term switched on: shorter trainings than those above, so arms are to be compared "
            "under one reward, and changes between rewards. One training is one observation; p is "
            "Welch's, not corrected for the number of rows.",
            Table(head, rows),
            Table(["reward", "term", "what is not the paper's"], differing),
        ],
    )
