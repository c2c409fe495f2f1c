"""Learning curves of trainings."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.evaluation.shipped import Shipped, learning_curve
from hyperleg_design.report.style import VARIANT_COLOUR, figure_style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SHOWN = (
    ("speed", "speed [m/s]"),
    ("falls", "falls a minute"),
    ("cost_of_transport", "CoT"),
    ("assist", "assist"),
)
"""Measures that are drawn as learning curves, with the labels of their axes; the assist where there
is any."""
_GREY = "#6b7280"
_HIGHEST = {"cost_of_transport": 1.5}
"""Where an axis ends, because what stands or falls has no cost of transport."""


def learning_figure(policies: Sequence[Shipped]) -> Figure:
    """Draw what trainings were measured on over their policy steps, with a row for each group and a
    line for each training, coloured by design.

    Args:
        policies: of which each training is drawn once.

    Returns:
        The figure.
    """
    import matplotlib.pyplot as plt

    trainings = {p.training: p for p in policies}
    curves = {name: learning_curve(p.path.parent) for name, p in trainings.items()}
    helped = any(row.get("assist") for curve in curves.values() for row in curve)
    shown = [column for column in SHOWN if helped or column[0] != "assist"]
    groups = list(dict.fromkeys(p.group for p in trainings.values()))
    designs = list(dict.fromkeys(p.design for p in trainings.values()))
    with figure_style():
        figure, grid = plt.subplots(
            len(groups),
            len(shown),
            figsize=(3.1 * len(shown), 2.3 * len(groups)),
            squeeze=False,
            layout="constrained",
        )
        for row, group in zip(grid, groups, strict=True):
            for policy in (p for p in trainings.values() if p.group == group):
                curve = curves[policy.training]
                for axes, (key, _) in zip(row, shown, strict=True):
                    x = np.array([r["steps"] for r in curve if key in r and "steps" in r]) / 1e6
                    y = np.array([r[key] for r in curve if key in r and "steps" in r])
                    axes.plot(
                        x, y, lw=1.1, alpha=0.85, color=VARIANT_COLOUR.get(policy.design, _GREY)
                    )
            for axes, (key, title) in zip(row, shown, strict=True):
                axes.set_title(title)
                axes.set_ylim(0, _HIGHEST.get(key))
                axes.set_xlim(left=0)
            row[0].set_ylabel(group.replace("_", " "))
        for axes in grid[-1]:
            axes.set_xlabel("policy steps [millions]")
        handles = [
            plt.Line2D([], [], color=VARIANT_COLOUR.get(d, _GREY), label=d.replace("_", " "))
            for d in designs
        ]
        figure.legend(handles=handles, loc="outside upper center", ncols=len(handles))
    return figure
