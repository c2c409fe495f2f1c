"""How light the distal leg is, beside other robots.

The paper prints HyperLeg's segment masses; where in a segment they lie is assumed, so its share
below the knee is the paper's and its swing inertia rests on assumptions. Rotor inertia through the
gears is in none of the bars.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from hyperleg_design.errors import InputError
from hyperleg_design.report.style import VARIANT_COLOUR, figure_style
from hyperleg_design.sizing.inertia import LegInertia, leg_inertia
from hyperleg_design.sizing.other_robots import OtherRobot, compare

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from hyperleg_design.robot.design import Design

KIND_COLOUR = {"biped": "#9aa3af", "human": "#3f8f5f", "quadruped": "#d3d8df"}
"""Colour of each kind of other robot."""

KIND_LABEL = {"biped": "other bipeds", "human": "human", "quadruped": "quadrupeds"}

ROD = 1 / 3
"""Inertia over mass and squared length of a uniform rod about its end [-]."""


@dataclass(frozen=True, eq=False)
class Row:
    """One robot of the comparison."""

    label: str
    leg: LegInertia
    colour: str
    own: bool
    """Whether it is one of the designs rather than another robot."""


def comparison_rows(
    designs: Iterable[Design], others: Iterable[OtherRobot] | None = None
) -> tuple[Row, ...]:
    """Measure designs and other robots; designs with equal legs share one row.

    Args:
        designs: robots, such as the variants of one.
        others: robots to compare with; all of `other_robots.SOURCES` by default.

    Returns:
        The rows, the lightest swing first.

    Raises:
        InputError: a batch of designs, no design, or `example-robot-data` is not there.
    """
    rows: list[Row] = []
    for design in designs:
        if design.batch_shape:
            raise InputError(design.name, "", None, "holds a batch of designs; take one of them")
        leg, same = leg_inertia(design), -1
        for place, row in enumerate(rows):
            if all(abs(getattr(row.leg, f) - v) < 1e-9 for f, v in vars(leg).items()):
                same = place
        label = (
            f"{design.name}: {design.variant}"
            if not design.name.endswith(design.variant)
            else design.name
        )
        if same >= 0:
            rows[same] = Row(f"{rows[same].label}, {design.variant}", leg, rows[same].colour, True)
        else:
            rows.append(Row(label, leg, VARIANT_COLOUR.get(design.variant, "#c8602a"), True))
    if not rows:
        raise InputError("comparison", "designs", None, "expects at least one design")
    for other in compare() if others is None else others:
        rows.append(Row(other.source.name, other.leg, KIND_COLOUR[other.source.kind], False))
    return tuple(sorted(rows, key=lambda row: float(row.leg.inertia_over_leg)))


def leg_comparison_figure(
    designs: Iterable[Design], others: Iterable[OtherRobot] | None = None
) -> Figure:
    """Draw the share of the leg's mass below the knee, and the swing inertia of the leg over leg
    mass and over total mass, as bars.

    Args:
        designs: robots, such as the variants of one.
        others: robots to compare with; all of `other_robots.SOURCES` by default.

    Returns:
        The figure.

    Raises:
        InputError: as `comparison_rows`.
    """
    import matplotlib.pyplot as plt
    from matplotlib.patches import Patch

    rows = comparison_rows(designs, others)
    panels = (
        (
            "leg mass below the knee",
            "share of leg mass [%]",
            [100 * float(r.leg.distal_share) for r in rows],
            "{:.0f}",
        ),
        (
            "swing inertia, per leg",
            "I / (leg mass × length²) [-]",
            [float(r.leg.inertia_over_leg) for r in rows],
            "{:.2f}",
        ),
        (
            "swing inertia, per robot",
            "I / (total mass × length²) [10⁻³]",
            [1e3 * float(r.leg.inertia_over_total) for r in rows],
            "{:.0f}",
        ),
    )
    with figure_style():
        figure, axes = plt.subplots(
            1, 3, figsize=(11.5, 1.6 + 0.34 * len(rows)), sharey=True, layout="constrained"
        )
        for axis, (title, label, values, form) in zip(axes, panels, strict=True):
            _bars(axis, rows, values, form)
            axis.set_title(title)
            axis.set_xlabel(label)
        axes[1].axvline(ROD, color="#4b5563", linewidth=0.9, linestyle=":")
        axes[1].text(ROD, -0.75, " uniform rod", fontsize=8, color="#4b5563", va="center")
        axes[0].set_yticks(range(len(rows)), [textwrap.fill(row.label, 28) for row in rows])
        for tick, row in zip(axes[0].get_yticklabels(), rows, strict=True):
            tick.set_fontweight("bold" if row.own else "normal")
        axes[0].set_ylim(len(rows) - 0.4, -1.1)
        kinds = dict.fromkeys(
            KIND_LABEL[k] for k, c in KIND_COLOUR.items() if any(r.colour == c for r in rows)
        )
        colours = {KIND_LABEL[k]: c for k, c in KIND_COLOUR.items()}
        if kinds:
            figure.legend(
                handles=[Patch(color=colours[k], label=k) for k in kinds],
                loc="outside lower right",
                ncols=len(kinds),
                fontsize=9,
            )
    return figure


def _bars(axis: Axes, rows: tuple[Row, ...], values: list[float], form: str) -> None:
    """One horizontal bar a robot with its value at the end; robots whose value is unknown say
    so.
    """
    known = [v for v in values if v == v]
    axis.barh(
        range(len(rows)),
        [v if v == v else 0.0 for v in values],
        color=[r.colour for r in rows],
        height=0.72,
    )
    for place, (row, value) in enumerate(zip(rows, values, strict=True)):
        text, end = (form.format(value), value) if value == value else ("total mass unknown", 0.0)
        weight = "bold" if row.own else "normal"
        axis.text(
            end, place, f" {text}", va="center", fontsize=8.5, fontweight=weight, color="#374151"
        )
    axis.set_xlim(0, 1.16 * max(known, default=1.0))
    axis.grid(axis="y", visible=False)
    axis.tick_params(axis="y", length=0)
    axis.spines["left"].set_visible(False)
