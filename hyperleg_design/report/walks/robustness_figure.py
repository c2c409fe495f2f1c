"""Robustness curves: a row a measure, a column a condition, a line a toe layout."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.evaluation.measures import measure_of
from hyperleg_design.evaluation.robustness import CONDITIONS, CurvePoint
from hyperleg_design.report.style import figure_style, variant_colour

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def robustness_figure(points: Sequence[CurvePoint]) -> Figure:
    """Draw curves with their intervals.

    Args:
        points: of `robustness.curves`, at least one.

    Returns:
        The figure.
    """
    import matplotlib.pyplot as plt

    conditions, measures, variants = (
        list(dict.fromkeys(getattr(point, name) for point in points))
        for name in ("condition", "measure", "variant")
    )
    with figure_style():
        figure, panels = plt.subplots(
            len(measures),
            len(conditions),
            figsize=(3.2 * len(conditions) + 0.6, 2.8 * len(measures)),
            squeeze=False,
            sharex="col",
            layout="constrained",
        )
        for row, measure in zip(panels, measures, strict=True):
            unit = measure_of(measure).unit
            row[0].set_ylabel(f"{measure.replace('_', ' ')} [{unit}]" if unit else _words(measure))
            for axes, condition in zip(row, conditions, strict=True):
                for variant in variants:
                    own = [
                        p
                        for p in points
                        if (p.condition, p.measure, p.variant) == (condition, measure, variant)
                    ]
                    level = np.array([p.level for p in own])
                    mean, low, high = (
                        np.array([getattr(p.estimate, key) for p in own])
                        for key in ("mean", "low", "high")
                    )
                    colour = variant_colour(variant)
                    axes.plot(level, mean, "o-", ms=4, color=colour, label=_words(variant))
                    axes.fill_between(level, low, high, color=colour, alpha=0.15, linewidth=0)
                if measure == "arrived":
                    axes.set_ylim(-0.03, 1.03)
        for axes, condition in zip(panels[-1], conditions, strict=True):
            axes.set_xlabel(CONDITIONS[condition].label)
        panels[0, 0].legend(fontsize=8)
    return figure


def _words(name: str) -> str:
    return {"arrived": "share that arrived"}.get(name, name.replace("_", " "))
