"""What evaluated walks say, as parts of a page: whether they are believable, speeds, Table III,
power over the gait cycle.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hyperleg_design.evaluation.believable import walk_findings
from hyperleg_design.evaluation.robustness import curves
from hyperleg_design.evaluation.versus_paper import VARIANTS
from hyperleg_design.report.drawer import Drawer, Part
from hyperleg_design.report.page import Cell, Table
from hyperleg_design.report.pictures import gif, motion, picture, strip
from hyperleg_design.report.style import later
from hyperleg_design.report.walks.beside_paper import differences
from hyperleg_design.report.walks.evaluated import WALK, Evaluated
from hyperleg_design.report.walks.paper_tables import paper_tables
from hyperleg_design.report.walks.robustness_figure import robustness_figure
from hyperleg_design.report.walks.walk_figures import cycle_power_figure

if TYPE_CHECKING:
    from hyperleg_design.evaluation.rollout import Trial


def walks(evaluated: Evaluated, draw: Drawer) -> Part:
    """Show pictures of walks, and the demands on believable ones.

    Args:
        evaluated: the policies with their trials.
        draw: draws figures into the page's folder.

    Returns:
        The part.
    """
    groups = evaluated.groups(WALK)
    columns = [(group, design) for group in groups for design in evaluated.designs(group)]
    findings = [walk_findings(evaluated.of(*column)) for column in columns]
    rows = []
    for lines in zip(*findings, strict=True):
        demand = lines[0].demand
        cells = [Cell(line.found, "good" if line.met else "bad") for line in lines]
        rows.append([demand.why, f"{demand.low:.3g} … {demand.high:.3g}", *cells])
    content = [
        *(_pictures(evaluated, groups[0], draw) if groups else []),
        "Whether these are walks that a person would believe; means over all walks of all trainings, red where the demand is not met.",
        Table(["demand", "range", *(f"{group}: {design}" for group, design in columns)], rows),
    ]
    return Part("Walks that a person would believe", content)


def _pictures(evaluated: Evaluated, group: str, draw: Drawer) -> list[Any]:
    """One gait cycle of the paper's designs, or of the first one there is, and an animation of each
    of the paper's.
    """
    trials = {
        design: trial
        for design in evaluated.designs(group)
        if (trial := evaluated.shown(group, design)) is not None
    }
    paper = {design: trial for design, trial in trials.items() if design in VARIANTS}
    cycles = {
        design.replace("_", " "): (trial, evaluated.of(group, design)[0].protocol.events)
        for design, trial in (paper or dict(islice(trials.items(), 1))).items()
    }
    if not cycles:
        return [[]]
    caption = "Fig. 5: one gait cycle at 1.33 m/s from the right side, touchdown to touchdown of the right foot; arrows: the floor's force, in proportion."
    strips = [(f"gait_{group}", caption, partial(_draw_strip, cycles), ".png", True)]
    animations = [
        (
            f"{group}_{design}",
            f"A walk, {design.replace('_', ' ')}, at true speed.",
            partial(_draw_animation, trial),
            ".gif",
            False,
        )
        for design, trial in paper.items()
    ]
    strip_picture, *animated = draw.together([*strips, *animations])
    return [strip_picture, animated]


def _draw_strip(cycles: Mapping[str, tuple[Trial, Any]], path: Path) -> object:
    return picture.render(strip.strip_scene(cycles), path)


def _draw_animation(trial: Trial, path: Path) -> object:
    return gif.render_gif(motion.walk_motion(trial), path)


def speeds(evaluated: Evaluated, draw: Drawer) -> Part:
    """Show the cost of transport over commanded speed, with the cadence that the policies choose.

    Args:
        evaluated: the policies with their trials.
        draw: draws figures into the page's folder.

    Returns:
        The part.
    """
    content: list[Any] = [
        "Walks at commanded speeds from 0.6 to 2.0 m/s by policies that observe no gait clock, so that they choose their cadence: share of trials that arrive, and cost of transport over the steady strides of those that do."
    ]
    for group, table in evaluated.speeds.items():
        content.append(
            draw(
                f"speeds_{group}",
                f"Over commanded speed, {group.replace('_', ' ')}; bands are 95 % intervals.",
                later(robustness_figure, curves(table)),
            )
        )
    return Part("Cost of transport over speed", content)


def table_three(evaluated: Evaluated, draw: Drawer) -> Part:
    """Compare walks with Table III of the paper.

    Args:
        evaluated: the policies with their trials.
        draw: draws figures into the page's folder.

    Returns:
        The part.
    """
    content: list[Any] = [
        "The paper's numbers beside ours: twenty metres at 1.33 m/s. Ablation: toe and its motor removed at equal mass (toe_removed_matched), which fits the ratios of the table best. "
        "A printed number agrees where it lies in our interval."
    ]
    content += paper_tables(evaluated, draw, "Table III")
    content += [
        differences(evaluated, group, WALK)
        for group in evaluated.groups(WALK)
        if set(VARIANTS) <= set(evaluated.designs(group))
    ]
    return Part("Table III: walking, beside the paper", content)


def cycle(evaluated: Evaluated, draw: Drawer) -> Part:
    """Show power over the gait cycle, as Figure 6 of the paper.

    Args:
        evaluated: the policies with their trials.
        draw: draws figures into the page's folder.

    Returns:
        The part.
    """
    content: list[Any] = []
    for group in evaluated.groups(WALK):
        walks = {d: evaluated.of(group, d) for d in evaluated.designs(group) if d in VARIANTS}
        if not walks:
            continue
        content.append(
            draw(
                f"cycle_{group}",
                f"Fig. 6: power of the right leg over the gait cycle, group {group}; lines are means over policies, bands span the policies (one policy: a standard deviation over its strides).",
                later(cycle_power_figure, walks),
            )
        )
    return Part("Power over the gait cycle", content)
