"""Evaluated T-tests beside Table IV of the paper, with their ways and where their time goes, as a
part of a page.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hyperleg_design.evaluation.versus_paper import VARIANTS
from hyperleg_design.report.drawer import Drawer, Part
from hyperleg_design.report.pictures import gif, motion
from hyperleg_design.report.style import later
from hyperleg_design.report.walks.beside_paper import differences
from hyperleg_design.report.walks.evaluated import T_TEST, Evaluated
from hyperleg_design.report.walks.paper_tables import paper_tables
from hyperleg_design.report.walks.t_test_figures import t_test_figure
from hyperleg_design.report.walks.time_table import time_table

if TYPE_CHECKING:
    from hyperleg_design.evaluation.protocol import TTestProtocol
    from hyperleg_design.evaluation.rollout import Trial

USUAL_STEP = 0.02
"""Time between positions of a trial where none was kept whole [s]."""


def table_four(evaluated: Evaluated, draw: Drawer) -> Part:
    """Compare T-tests with Table IV of the paper, and draw the ways of all arms.

    Args:
        evaluated: the policies with their trials.
        draw: draws figures into the page's folder.

    Returns:
        The part.
    """
    content: list[Any] = [
        "The Robot T-test, A B C D B A with the human test's lengths and free torso yaw. Deviation "
        "is from the nearest point of the course; from the leg being run it stands in the table of "
        "all arms."
    ]
    content += paper_tables(evaluated, draw, "Table IV")
    for group in evaluated.groups(T_TEST):
        runs = {d: evaluated.of(group, d) for d in evaluated.designs(group)}
        shown = {d: t for d in runs if (t := evaluated.shown(group, d)) is not None}
        step = next((t.time_step * t.substeps for t in shown.values()), USUAL_STEP)
        content.append(
            draw(
                f"ways_{group}",
                "Fig. 7: the course and the ways of all trials, coloured by speed; below, speed "
                "along the way.",
                later(t_test_figure, runs, step),
            )
        )
        animations = [
            (
                f"{group}_{design}",
                f"A T-test, {design.replace('_', ' ')}; longer runs faster than true.",
                partial(_draw_animation, trial, runs[design][0].protocol),
                ".gif",
                False,
            )
            for design, trial in shown.items()
            if design in VARIANTS
        ]
        content.append(draw.together(animations))
        content.append(time_table(runs, group, step))
        if set(VARIANTS) <= set(runs):
            content.append(differences(evaluated, group, T_TEST))
    return Part("Table IV: the T-test, beside the paper", content)


def _draw_animation(trial: Trial, protocol: TTestProtocol, path: Path) -> object:
    return gif.render_gif(motion.t_test_motion(trial, protocol), path)
