"""All arms of the study side by side, as a part of a page."""

from __future__ import annotations

from typing import Any

import numpy as np

from hyperleg_design.evaluation import statistics
from hyperleg_design.evaluation.measure_interval import measure_interval
from hyperleg_design.evaluation.measures import measure_of
from hyperleg_design.evaluation.plans.analysis_plan import counted
from hyperleg_design.evaluation.result import by_checkpoint
from hyperleg_design.report.drawer import Part
from hyperleg_design.report.page import Table
from hyperleg_design.report.walks.beside_paper import SUMMARY, interval, short
from hyperleg_design.report.walks.evaluated import Evaluated


def arms(evaluated: Evaluated) -> Part:
    """Tabulate the main measures of every arm that was trained, walks first, then T-tests.

    Args:
        evaluated: the policies with their trials.

    Returns:
        The part.
    """
    content: list[Any] = [
        "Every arm that was trained: means over its trainings, with an interval over trainings "
        "where there are at least two. One training does not tell how much trainings of one arm "
        "differ, so its mean stands alone."
    ]
    for kind, measures in SUMMARY.items():
        for group in evaluated.groups(kind):
            content.append(_table(evaluated, group, measures))
    return Part("All arms side by side", content)


def _table(evaluated: Evaluated, group: str, measures: tuple[str, ...]) -> Table:
    table, designs = evaluated.table(group), evaluated.designs(group)
    arrivals: list[Any] = ["arrived", "%"]
    for design in designs:
        seeds = by_checkpoint(table[table["variant"] == design], "arrived")
        share = statistics.share(list(seeds.values()))
        low, high = (share.low, share.high) if share.speaks_of_seeds else (np.nan, np.nan)
        arrivals.append(interval(100 * share.mean, 100 * low, 100 * high, ""))
    rows = [arrivals]
    for name in measures:
        if name not in table:
            continue
        values = counted(table, name)
        row: list[Any] = [name.replace("_", " "), measure_of(name).unit]
        for design in designs:
            seeds = by_checkpoint(values[values["variant"] == design], name)
            row.append(short(measure_interval(name, list(seeds.values()))))
        rows.append(row)
    counts = (
        f"{d}: seeds {', '.join(map(str, evaluated.seeds(group, d)))}, "
        f"{int((table['variant'] == d).sum())} trials"
        for d in designs
    )
    head = ["measure", "unit", *(design.replace("_", " ") for design in designs)]
    return Table(head, rows, f"{group.replace('_', ' ')}; {'; '.join(counts)}.")
