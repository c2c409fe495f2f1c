"""How much of what the toe changes is its joint, how much its motor's torque and how much its mass,
as a part of a page.
"""

from __future__ import annotations

from typing import Any

from hyperleg_design.evaluation import attribution
from hyperleg_design.evaluation.measures import measure_of
from hyperleg_design.evaluation.plans.analysis_plan import counted
from hyperleg_design.evaluation.result import by_checkpoint
from hyperleg_design.report.drawer import Drawer, Part
from hyperleg_design.report.page import Table
from hyperleg_design.report.style import later
from hyperleg_design.report.walks.beside_paper import interval, percent, verdict
from hyperleg_design.report.walks.evaluated import T_TEST, WALK, Evaluated
from hyperleg_design.report.walks.versus_figures import attribution_figure

ATTRIBUTED = {
    WALK: ("power", "joule_power", "steady_cost_of_transport", "grf_peak", "grf_loading_rate"),
    T_TEST: ("time", "peak_speed", "mean_deviation", "energy", "cost_of_transport"),
}
"""Measures whose difference is split into toe, torque and mass, by kind of protocol."""


def confound(evaluated: Evaluated, draw: Drawer) -> Part:
    """Split the difference that the toe makes into toe, torque and mass, in walks and T-tests.

    An arm of a single training is left out, because it does not tell how much trainings differ.

    Args:
        evaluated: the policies with their trials.
        draw: draws figures into the page's folder.

    Returns:
        The part.
    """
    content: list[Any] = [
        "Taking the toe's motor away also weakens knee and ankle, which it helps, and lightens the "
        "leg. The ablations change one thing at a time: toe locked with its motor kept, toe and "
        "motor gone at equal mass, gone with their mass. Each line is the one without less the one "
        "with. Arms with at least two trainings are compared."
    ]
    figures = {}
    for kind, measures in ATTRIBUTED.items():
        for group in evaluated.groups(kind):
            arms = [d for d in attribution.LADDER if len(evaluated.seeds(group, d)) > 1]
            if len(arms) < 2:
                continue
            table = evaluated.table(group)
            rows, shares = [], {}
            for name in measures:
                some = counted(table, name)
                groups = {
                    d: list(by_checkpoint(some[some["variant"] == d], name).values()) for d in arms
                }
                shares[name.replace("_", " ")] = measured = attribution.attribute(groups)
                for share in measured:
                    change = share.change
                    rows.append(
                        [
                            name.replace("_", " "),
                            share.cause,
                            interval(change.mean, change.low, change.high, measure_of(name).unit),
                            percent(change.relative, change.relative_low, change.relative_high),
                            verdict(change.verdict),
                        ]
                    )
            figures[group] = shares
            head = ["measure", "what is taken away", "change", "relative", "verdict"]
            content.append(Table(head, rows, f"Group {group}: {' → '.join(arms)}."))
            absent = [d for d in attribution.LADDER if d not in arms]
            if absent:
                content.append(
                    f"Steps that need {', '.join(absent)} cannot be told in the group {group}: "
                    "there are not two such trainings."
                )
    for group, shares in figures.items():
        content.append(
            draw(
                f"confound_{group}",
                f"What each step takes away adds to the measures, group {group}.",
                later(attribution_figure, shares),
            )
        )
    if not figures:
        content.append("Cannot be told yet: no group has two trainings of two of the ablations.")
    return Part("How much is the toe, how much the lost torque, how much the mass", content)
