"""Changes that the toe makes, ours with their intervals beside the paper's; and what part of them
is toe, torque or mass.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.report.style import figure_style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from hyperleg_design.evaluation.attribution import Share
    from hyperleg_design.evaluation.versus_paper import PaperRow

_OURS, _PAPER, _GREY = "#2f6db3", "#c8602a", "#6b7280"
WIDEST = 120.0
"""Largest change on an axis [%]; wider intervals are cut."""
CAUSE_COLOURS = ("#c8602a", "#8172b3", "#6b7280", "#1d2129")
"""Colours of the steps of the ladder, and of all steps together."""


def change_figure(groups: Mapping[str, Sequence[PaperRow]]) -> Figure:
    """Draw the relative change that the toe makes, with a panel for each group: ours with its
    interval, and the paper's beside it.

    Args:
        groups: rows by the name of the group.

    Returns:
        The figure.
    """
    import matplotlib.pyplot as plt

    with figure_style():
        height = 0.42 * max(len(rows) for rows in groups.values()) + 1.2
        figure, panels = plt.subplots(
            1,
            len(groups),
            figsize=(max(9.0, 6.0 * len(groups)), height),
            squeeze=False,
            layout="constrained",
        )
        for axes, (name, rows) in zip(panels[0], groups.items(), strict=True):
            for i, row in enumerate(rows):
                change = row.difference
                axes.plot(
                    100 * row.printed.change,
                    i - 0.14,
                    "D",
                    color=_PAPER,
                    ms=6,
                    label="paper" if i == 0 else None,
                )
                if np.isfinite(change.relative):
                    axes.plot(
                        100 * change.relative,
                        i + 0.14,
                        "o",
                        color=_OURS,
                        ms=6,
                        label="ours, 95 % interval" if i == 0 else None,
                    )
                    if np.isfinite(change.relative_low):
                        axes.hlines(
                            i + 0.14,
                            100 * change.relative_low,
                            100 * change.relative_high,
                            color=_OURS,
                            lw=1.8,
                        )
            axes.axvline(0, color=_GREY, lw=0.9)
            axes.set_yticks(range(len(rows)), [row.printed.quantity for row in rows])
            axes.invert_yaxis()
            low, high = axes.get_xlim()
            axes.set(
                xlabel="change with the toe [%]",
                title=name,
                xlim=(max(low, -WIDEST), min(high, WIDEST)),
            )
        figure.legend(
            *panels[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=2
        )
    return figure


def attribution_figure(shares: Mapping[str, Sequence[Share]]) -> Figure:
    """Draw what each step of the ladder adds when it takes away toe joint, torque or mass, relative
    to the robot that still has it.

    Args:
        shares: by the name of the measure, as `attribution.attribute` gives them.

    Returns:
        The figure.
    """
    import matplotlib.pyplot as plt

    causes = list(dict.fromkeys(share.cause for some in shares.values() for share in some))
    with figure_style():
        figure, axes = plt.subplots(figsize=(9.0, 0.62 * len(shares) + 1.4), layout="constrained")
        for i, some in enumerate(shares.values()):
            for share in some:
                change, place = (
                    share.change,
                    i + 0.18 * (causes.index(share.cause) - (len(causes) - 1) / 2),
                )
                colour = CAUSE_COLOURS[causes.index(share.cause) % len(CAUSE_COLOURS)]
                axes.plot(100 * change.relative, place, "o", color=colour, ms=5)
                if np.isfinite(change.relative_low):
                    axes.hlines(
                        place,
                        100 * change.relative_low,
                        100 * change.relative_high,
                        color=colour,
                        lw=1.6,
                    )
        axes.axvline(0, color=_GREY, lw=0.9)
        axes.set_yticks(range(len(shares)), list(shares))
        axes.invert_yaxis()
        low, high = axes.get_xlim()
        axes.set(
            xlabel="change when it is taken away [%]", xlim=(max(low, -WIDEST), min(high, WIDEST))
        )
        handles = [
            plt.Line2D([], [], marker="o", color=CAUSE_COLOURS[k % len(CAUSE_COLOURS)], label=cause)
            for k, cause in enumerate(causes)
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=2, fontsize=9)
    return figure
