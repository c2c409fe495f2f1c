"""Which constraints the designs of a search violate, and by how much, for a terminal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hyperleg_design.report.text import table
from hyperleg_design.sweep.finalists import Row, value_of
from hyperleg_design.sweep.search import ROW, Search
from hyperleg_design.sweep.searching.constraint import Constraint, usual_constraints

if TYPE_CHECKING:
    import optuna

SHOWN = 5
"""Designs in the table of those that violate the constraints least."""


def violations(search: Search, study: optuna.Study) -> list[str]:
    """Describe how far the designs of a search are from holding its constraints.

    Designs are ordered by the sum of their violations, each relative to its bound.

    Args:
        search: what was searched.
        study: its trials, none of which holds all constraints.

    Returns:
        How many designs hold each constraint, the designs that violate them least, and how a bound
        is relaxed; nothing where no design was measured.
    """
    rows = [trial.user_attrs[ROW] for trial in study.trials if ROW in trial.user_attrs]
    rows = [row for row in rows if math.isfinite(_distance(search, row))]
    if not rows:
        return []
    bounds = search.constraints
    usual = " (those by default)" if bounds == usual_constraints(search.protocols) else ""
    held = [[bound.text, sum(_holds(bound, row) for row in rows), len(rows)] for bound in bounds]
    nearest = sorted(rows, key=lambda row: _distance(search, row))[:SHOWN]
    axes = [axis.name for axis in search.sweep.axes]
    cells = [
        [row["sample"], *(row[name] for name in axes), *(_value(bound, row) for bound in bounds)]
        for row in nearest
    ]
    relaxed = " ".join(
        f"--constraint '{_relaxed(bound, value_of(nearest[0], bound.name)).text}'"
        for bound in bounds
    )
    return [
        f"constraints{usual}:",
        table(["constraint", "designs that hold it", "of"], held),
        "designs that violate them least, * where a bound is violated:",
        table(["design", *axes, *(bound.name for bound in bounds)], cells),
        f"relax a bound with --constraint, which replaces all of them, and another --out; design "
        f"{nearest[0]['sample']} holds {relaxed}",
    ]


def _distance(search: Search, row: Row) -> float:
    """Sum of the violations over the bounds' sizes; infinite where a measure is unknown."""
    return sum(
        max(0.0, bound.violation(value_of(row, bound.name))) / (abs(bound.bound) or 1.0)
        for bound in search.constraints
    )


def _holds(bound: Constraint, row: Row) -> bool:
    return bound.violation(value_of(row, bound.name)) <= 0


def _value(bound: Constraint, row: Row) -> str:
    return f"{value_of(row, bound.name):.4g}" + ("" if _holds(bound, row) else " *")


def _relaxed(bound: Constraint, value: float) -> Constraint:
    """The bound, moved to three digits beyond a value that violates it."""
    if bound.violation(value) <= 0:
        return bound
    if value == 0:
        return Constraint(bound.name, 0.0, bound.at_most)
    digit = 10.0 ** (math.floor(math.log10(abs(value))) - 2)
    moved = (math.ceil if bound.at_most else math.floor)(value / digit) * digit
    return Constraint(bound.name, moved, bound.at_most)
