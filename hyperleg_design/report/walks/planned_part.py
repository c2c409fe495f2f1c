"""What the analysis plan says of the evaluated policies, as a part of a page."""

from __future__ import annotations

import math
from typing import Any

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.measures import measure_of
from hyperleg_design.evaluation.plans.analysis_plan import AnalysisPlan, load_plan
from hyperleg_design.evaluation.plans.planned_analysis import (
    DIFFERENT,
    EQUIVALENT,
    PlannedRow,
    planned_analysis,
)
from hyperleg_design.evaluation.plans.planned_tests import plateau
from hyperleg_design.evaluation.shipped import learning_curve
from hyperleg_design.report.drawer import Part
from hyperleg_design.report.page import Cell, Heading, Table
from hyperleg_design.report.walks.beside_paper import percent
from hyperleg_design.report.walks.evaluated import T_TEST, WALK, Evaluated

HEAD = [
    "outcome",
    "unit",
    "trials",
    "toe",
    "compared",
    "change",
    "verdict",
    "p",
    "p, corrected",
    "smallest detectable change",
    "trainings",
    "trials without a value",
]
_MARK = {DIFFERENT: "good", EQUIVALENT: "good"}


def studies(evaluated: Evaluated, plan: AnalysisPlan) -> list[dict[str, str]]:
    """Find the groups of trainings that are analysed together, by protocol.

    A group of walks that has both arms goes with the first group of T-tests that was trained as it
    was, with a gait clock or without; other groups of T-tests stand alone.

    Args:
        evaluated: the policies with their trials.
        plan: names the arms.

    Returns:
        Names of the groups by protocol, for each study.
    """
    both = {plan.active, plan.compared}
    runs = [g for g in evaluated.groups(T_TEST) if both <= set(evaluated.designs(g))]
    chosen = []
    for group in (g for g in evaluated.groups(WALK) if both <= set(evaluated.designs(g))):
        alike = [g for g in runs if _clocked(evaluated, g) == _clocked(evaluated, group)]
        chosen.append({WALK: group} | ({T_TEST: alike[0]} if alike else {}))
    paired = {study.get(T_TEST) for study in chosen}
    return chosen + [{T_TEST: group} for group in runs if group not in paired]


def planned_rows(
    evaluated: Evaluated, plan: AnalysisPlan | None = None
) -> dict[str, list[PlannedRow]]:
    """Compute the rows of the plan for each of the `studies`.

    Args:
        evaluated: the policies with their trials.
        plan: the shipped one by default.

    Returns:
        Rows by the names of the study's groups.
    """
    plan = plan or load_plan()
    tables = {}
    for study in studies(evaluated, plan):
        trials = {kind: evaluated.table(group) for kind, group in study.items()}
        tables[" and ".join(study.values())] = planned_analysis(plan, trials)
    return tables


def planned(evaluated: Evaluated, plan: AnalysisPlan | None = None) -> Part:
    """Tabulate the planned outcomes, with a primary and a secondary table for each study.

    Args:
        evaluated: the policies with their trials.
        plan: the shipped one by default.

    Returns:
        A part of a page.
    """
    plan = plan or load_plan()
    primary = ", ".join(outcome.name.replace("_", " ") for outcome in plan.primary)
    content: list[Any] = [
        "Outcomes, margins and corrections were written down before the trainings were run "
        f"(analysis_plan.yaml). Arms: {plan.active} against {plan.compared}. One training is one "
        "observation, and rows are Welch's t tests on the trainings' means. Primary outcomes "
        f"({primary}) are each tested at the level {plan.level:g} and for equivalence within the "
        "plan's margin; the others are corrected together by Holm's method. Every row states the "
        "smallest change that the trainings there are would have shown with a probability of "
        f"{plan.power:g}: an undecided row says no more than that larger changes are unlikely. "
        "Trials that did not arrive, timeouts among them, are left out of measures of arrivals and "
        "counted in the last column."
    ]
    for name, rows in planned_rows(evaluated, plan).items():
        content.append(Heading(f"Planned comparison: {name.replace('_', ' ')}"))
        content.append(_seeds(rows, plan))
        for some, caption in (
            ([r for r in rows if r.primary], "Primary outcomes."),
            ([r for r in rows if not r.primary], "Secondary outcomes, corrected together."),
        ):
            content.append(Table(HEAD, [_cells(row) for row in some], caption))
    content.append(_plateaus(evaluated, plan))
    return Part("What the analysis plan says", content)


def row_numbers(row: PlannedRow) -> dict[str, Any]:
    """Write a row as plain numbers and texts.

    Args:
        row: of the plan.

    Returns:
        Values by name, None where there is none.
    """
    keys = ("active", "compared", "change", "low", "high", "p_value", "corrected", "detectable")
    numbers = {key: getattr(row, key) for key in keys}
    return {
        "outcome": row.outcome.name,
        "trials": row.outcome.trials,
        "primary": row.primary,
        **{key: float(v) if math.isfinite(v) else None for key, v in numbers.items()},
        "verdict": row.verdict,
        "trainings": list(row.trainings),
        "missing": list(row.missing),
    }


def _cells(row: PlannedRow) -> list[Any]:
    words = row.verdict
    if row.primary and row.verdict == EQUIVALENT:
        words = f"equivalent within {100 * row.outcome.margin:g} %"
    return [
        f"{row.outcome.protocol.replace('_', '-')}: {row.outcome.measure.replace('_', ' ')}",
        measure_of(row.outcome.measure).unit,
        row.outcome.trials,
        row.active,
        row.compared,
        percent(row.change, row.low, row.high),
        Cell(words, _MARK.get(row.verdict, "note")),
        row.p_value,
        row.corrected,
        percent(row.detectable, math.nan, math.nan).lstrip("+"),
        f"{row.trainings[0]}, {row.trainings[1]}",
        f"{row.missing[0]}, {row.missing[1]}",
    ]


def _seeds(rows: list[PlannedRow], plan: AnalysisPlan) -> str:
    """How many trainings there are, and how many were planned."""
    parts = []
    for protocol, wanted in plan.seeds.items():
        there = [min(r.trainings) for r in rows if r.outcome.protocol == protocol]
        count = max(there, default=0)
        parts.append(f"{protocol.replace('_', '-')}: {count} of {wanted} trainings an arm")
    return f"There are, of those that the plan asks for, {'; '.join(parts)}."


def _plateaus(evaluated: Evaluated, plan: AnalysisPlan) -> str:
    """How many trainings ended on a plateau of their reward, by the plan's rule."""
    counts: dict[str, list[bool]] = {}
    for policy in evaluated.policies:
        curve = [r for r in learning_curve(policy.path.parent) if {"steps", "reward"} <= set(r)]
        if policy.late or not curve:
            continue
        try:
            steps, reward = ([row[key] for row in curve] for key in ("steps", "reward"))
            reached = plateau(steps, reward, plan.plateau).reached
        except InputError:  # too short a curve
            continue
        counts.setdefault(f"{policy.group} {policy.design}", []).append(reached)
    if not counts:
        return "No training brought a learning curve along that its plateau could be judged by."
    texts = [f"{name}: {sum(some)} of {len(some)}" for name, some in counts.items()]
    share = 100 * plan.plateau.share
    return (
        f"Trainings whose reward gained no more than noise over its last {share:g} % of steps, the "
        f"plan's rule: {'; '.join(texts)}."
    )


def _clocked(evaluated: Evaluated, group: str) -> bool:
    """Whether policies of a group observe a gait clock."""
    pairs = zip(evaluated.policies, evaluated.evaluations, strict=True)
    return any(p.group == group and "clock" in (e.origin.get("deviations") or ()) for p, e in pairs)
