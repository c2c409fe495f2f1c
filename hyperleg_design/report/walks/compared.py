"""Which trainings of a folder the paper's experiment compares, and which of them it lacks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.shipped import (
    Shipped,
    shipped_policies,
    trainings_text,
)
from hyperleg_design.learning.campaigns.campaign import (
    compared_groups,
    load_campaign,
    shipped_campaigns,
    shipped_starts,
)
from hyperleg_design.resources import shipped_folder

CAMPAIGNS = ("campaign", "campaign_t_test")
"""Campaigns whose arms the analysis plan compares; the others ask other questions."""
REWARDS = "campaign_rewards"
"""Campaign that switches one term of the reward on at a time."""


def missing_trainings(policies: Sequence[Shipped]) -> list[str]:
    """List the trainings of the study's campaigns that none of the policies comes from.

    Args:
        policies: that are there.

    Returns:
        Names of the trainings, campaign by campaign, by group and design.
    """
    there = {p.training for p in policies}
    runs = [run for campaign in CAMPAIGNS for run in load_campaign(campaign).runs if run.compared]
    return [run.name for run in runs if run.name not in there]


def coverage(folder: str | Path | None = None) -> dict[str, list[str]]:
    """Trainings of a folder that will be evaluated, and those of the study that it lacks.

    Args:
        folder: of trainings; the shipped policies by default.

    Returns:
        Names of trainings under `evaluated` and `missing`.

    Raises:
        InputError: as `check_policies`.
    """
    check_policies(folder)
    policies = compared_policies(folder, late=False)
    return {
        "evaluated": [policy.training for policy in policies],
        "missing": missing_trainings(policies),
    }


def check_policies(folder: str | Path | None = None) -> None:
    """Check that a folder of trainings holds policies that the paper's experiment compares.

    Args:
        folder: of trainings; the shipped policies by default.

    Raises:
        InputError: no such folder, or none of these policies.
    """
    if not (compared_policies(folder, late=False) or rewarded_policies(folder)):
        remedy = (
            "holds no finished training of the study; expects folders such as walk_upright-toe-1, "
            "which `hyperleg campaign run campaign` makes, or no --policies for the shipped ones"
        )
        raise InputError("policies", "", str(folder or shipped_folder()), remedy)


def coverage_text(trainings: Mapping[str, Sequence[str]]) -> str:
    """Write `coverage` as one sentence.

    Args:
        trainings: names of those evaluated and of those missing.

    Returns:
        The sentence; empty where nothing is missing.
    """
    evaluated, missing = trainings["evaluated"], trainings["missing"]
    if not missing:
        return ""
    return (
        f"{len(evaluated)} trainings are evaluated; of those that the study plans, {len(missing)} "
        f"are missing: {trainings_text(missing)}"
    )


def compared_policies(folder: str | Path | None, *, late: bool = True) -> list[Shipped]:
    """List policies of the HyperLeg that are more than starts of others, and that no campaign made
    for another question than the plan's.

    Args:
        folder: of trainings; the shipped policies by default.
        late: whether late policies count beside the last ones.

    Returns:
        The policies.

    Raises:
        InputError: no such folder.
    """
    others = shipped_starts() | other_groups()
    policies = shipped_policies(folder, late=late)
    return [p for p in policies if p.family == "hyperleg" and p.group not in others]


def rewarded_policies(folder: str | Path | None) -> list[Shipped]:
    """List the last policies of the trainings under several rewards.

    Args:
        folder: of trainings; the shipped policies by default.

    Returns:
        The policies.

    Raises:
        InputError: no such folder.
    """
    groups = compared_groups(REWARDS)
    return [p for p in shipped_policies(folder, late=False) if p.group in groups]


def other_groups() -> frozenset[str]:
    """List the groups that only campaigns other than `CAMPAIGNS` compare.

    Returns:
        Their names.
    """
    groups: dict[bool, set[str]] = {True: set(), False: set()}
    for name in shipped_campaigns():
        groups[name in CAMPAIGNS] |= set(compared_groups(name))
    return frozenset(groups[False] - groups[True])
