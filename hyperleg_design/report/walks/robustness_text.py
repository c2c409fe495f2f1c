"""Curves of robustness as a table for a terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from hyperleg_design.evaluation.measures import measure_of
from hyperleg_design.evaluation.robustness import CONDITIONS
from hyperleg_design.report.text import table


def robustness_text(points: Sequence[Mapping[str, Any]]) -> str:
    """Write the points of curves as a table, a row a level and variant.

    Args:
        points: as `run_robustness` returns them.

    Returns:
        The text: means with their 95 % intervals over trainings, each measure with its unit.
    """
    measures = list(dict.fromkeys(point["measure"] for point in points))
    cells: dict[tuple[str, float, str], dict[str, str]] = {}
    for point in points:
        row = cells.setdefault((point["condition"], point["level"], point["variant"]), {})
        row[point["measure"]] = _interval(point)
    heads = [f"{name} [{measure_of(name).unit or '-'}]" for name in measures]
    rows = [
        [CONDITIONS[condition].label, level, variant, *(row.get(name, "") for name in measures)]
        for (condition, level, variant), row in cells.items()
    ]
    return table(["condition", "level", "variant", *heads], rows)


def _interval(point: Mapping[str, Any]) -> str:
    if point["mean"] is None:
        return ""
    text = f"{point['mean']:.3g}"
    if point["low"] is None or point["high"] is None:
        return text
    return f"{text} ({point['low']:.3g} .. {point['high']:.3g})"
