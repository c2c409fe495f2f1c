"""What evaluated walks say, as parts of a page: whether they are believable, Table III, Fig. 6,
impacts.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from hyperleg_design.evaluation import statistics
from hyperleg_design.evaluation.believable import walk_findings
from hyperleg_design.evaluation.foot_pad import heel_mass, pad_of_contact
from hyperleg_design.evaluation.motion.steps import measured_steps
from hyperleg_design.evaluation.robustness import curves
from hyperleg_design.evaluation.versus_paper import VARIANTS
from hyperleg_design.report.drawer import Drawer, Part
from hyperleg_design.report.page import Cell, Table
from hyperleg_design.report.pictures import gif, motion, picture, strip
from hyperleg_design.report.style import later, save
from hyperleg_design.report.walks.beside_paper import (
    differences,
    interval,
    verdict,
)
from hyperleg_design.report.walks.evaluated import WALK, Evaluated
from hyperleg_design.report.walks.paper_tables import paper_tables
from hyperleg_design.report.walks.robustness_figure import robustness_figure
from hyperleg_design.report.walks.walk_figures import cycle_power_figure, impact_band_figure


def walks(evaluated: Evaluated, draw: Drawer) -> Part:
    """Show pictures of walks, and the demands on believable ones.

    Args:
        evaluated: the policies with their trials.
        draw: draws figures into the page's folder.

    Returns:
        The part.
    """
    content: list[Any] = []
    groups = evaluated.groups(WALK)
    columns = [(group, design) for group in groups for design in evaluated.designs(group)]
    findings = [walk_findings(evaluated.of(*column)) for column in columns]
    rows = []
    for lines in zip(*findings, strict=True):
        demand = lines[0].demand
        cells = [Cell(line.found, "good" if line.met else "bad") for line in lines]
        rows.append([demand.why, f"{demand.low:.3g} … {demand.high:.3g}", *cells])
    for group in groups[:1]:
        trials = {
            d: t for d in evaluated.designs(group) if (t := evaluated.shown(group, d)) is not None
        }
        pair = {
            d: (t, evaluated.of(group, d)[0].protocol.events)
            for d, t in trials.items()
            if d in VARIANTS or d == next(iter(trials))
        }
        jobs: list[Any] = []
        if pair:
            named = {name.replace("_", " "): value for name, value in pair.items()}
            caption = "Fig. 5: one gait cycle at 1.33 m/s from the right side, touchdown to touchdown of the right foot; arrows: the floor's force, in proportion."
            jobs.append(
                (
                    f"gait_{group}",
                    caption,
                    lambda p, named=named: picture.render(strip.strip_scene(named), p),
                    ".png",
                    True,
                )
            )
        for d, t in trials.items():
            if d in VARIANTS:
                caption = f"A walk, {d.replace('_', ' ')}, at true speed."
                jobs.append(
                    (
                        f"{group}_{d}",
                        caption,
                        lambda p, t=t: gif.render_gif(motion.walk_motion(t), p),
                        ".gif",
                        False,
                    )
                )
        pictures = draw.together(jobs)
        wide = int(bool(pair))
        content += [*pictures[:wide], pictures[wide:]]
    content += [
        "Whether these are walks that a person would believe; means over all walks of all trainings, red where the demand is not met.",
        Table(["demand", "range", *(f"{group}: {design}" for group, design in columns)], rows),
    ]
    return Part("Walks that a person would believe", content)


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
                lambda p, w=walks: save(cycle_power_figure(w), p),  # type: ignore[misc]
            )
        )
    return Part("Power over the gait cycle", content)


def impacts(evaluated: Evaluated, draw: Drawer) -> Part:
    """Show impacts over the stiffness of the sole, and the pad that it stands for.

    Args:
        evaluated: the policies with their trials.
        draw: draws figures into the page's folder.

    Returns:
        The part.
    """
    evaluation, trial = next(
        (e, e.trials[0])
        for e in evaluated.evaluations
        if e.trials and not hasattr(e.protocol, "course")
    )
    steps = measured_steps(trial, evaluation.protocol.events)
    mass = (
        float(np.median(heel_mass(trial, steps.touchdown, steps.foot)))
        if len(steps)
        else float("nan")
    )
    if not mass > 0:
        return Part(
            "Impacts over the stiffness of the sole",
            ["Cannot be told: the walk that would say what mass stands behind a heel has no step."],
        )
    constants = sorted(next(iter(evaluated.band.values())))
    pads = {c: pad_of_contact(trial.design, mass, c) for c in constants}
    own = float(trial.design.contact_section.time_constant)
    rows: list[list[Any]] = []
    for c in constants:
        pad = pads[c]
        cells = []
        for walks in evaluated.band.values():
            value = statistics.estimate(
                [e.values("grf_peak_body_weights") for e in walks[c]], resamples=1000
            )
            fell = int(sum(e.values("fell").sum() for e in walks[c]))
            cells.append(
                f"{interval(value.mean, value.low if value.speaks_of_seeds else math.nan, value.high, '')}{f', {fell} fell' if fell else ''}"
            )
        pair = [
            [e.values("grf_peak_body_weights") for e in walks[c]]
            for walks in evaluated.band.values()
        ]
        told = statistics.difference(*pair, resamples=1000).verdict if len(pair) == 2 else ""
        rows.append(
            [
                f"{1e3 * c:.3g} ms{' (all else here)' if math.isclose(c, own) else ''}",
                pad.stiffness / 1e3,
                pad.damping(mass),
                pad.modulus / 1e6,
                *cells,
                verdict(told),
            ]
        )
    first = pads[constants[0]]
    content: list[Any] = [
        f"Much of an impact is the stiffness of the sole. The stated pad: {1e3 * first.thickness:.0f} mm of a soft sole on {1e4 * first.area:.1f} cm² under each heel; behind it stands an effective mass of {mass:.2f} kg "
        "at touchdown (median over the steps of one walk, rotors included), which turns the contact's time constant into stiffness and damping. All time constants on this page but in this table are the design's; "
        "the softest and the stiffest differ sixteenfold, and steps of 5 ms allow none stiffer. Solid rubber, at 1 to 10 MPa, would be stiffer than any of them, so printed newtons are not to be expected; designs are compared at equal settings.",
        Table(
            [
                "time constant",
                "stiffness [kN/m]",
                "damping [Ns/m]",
                "modulus [MPa]",
                *(d.replace("_", " ") for d in evaluated.band),
                "difference",
            ],
            rows,
            "Peak of the filtered vertical force within 50 ms of touchdown, in body weights. The policies were trained at the design's contact only.",
        ),
        draw(
            "impact_band",
            "Impact over the stiffness of the pad under a heel.",
            lambda p: save(
                impact_band_figure(evaluated.band, {c: pads[c].stiffness for c in constants}), p
            ),
        ),
    ]
    return Part("Impacts over the stiffness of the sole", content)
