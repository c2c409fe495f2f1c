"""Impacts over the stiffness of the sole, as a part of a page."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.evaluation import statistics
from hyperleg_design.evaluation.foot_pad import FootPad, heel_mass, pad_of_contact
from hyperleg_design.evaluation.motion.steps import measured_steps
from hyperleg_design.report.drawer import Drawer, Part
from hyperleg_design.report.page import Table
from hyperleg_design.report.style import later
from hyperleg_design.report.walks.beside_paper import interval, verdict
from hyperleg_design.report.walks.evaluated import Evaluated
from hyperleg_design.report.walks.walk_figures import impact_band_figure

if TYPE_CHECKING:
    from hyperleg_design.evaluation.result import Evaluation

TITLE = "Impacts over the stiffness of the sole"
PEAK = "grf_peak_body_weights"
RESAMPLES = 1000
"""Bootstrap samples of each interval in the table."""


def impacts(evaluated: Evaluated, draw: Drawer) -> Part:
    """Show impacts over the stiffness of the sole, and the pad that it stands for.

    Args:
        evaluated: the policies with their trials, among them a walk whose signals were kept.
        draw: draws figures into the page's folder.

    Returns:
        The part.
    """
    evaluation = next(
        e for e in evaluated.evaluations if e.trials and not hasattr(e.protocol, "course")
    )
    mass = _mass_behind_a_heel(evaluation)
    if not mass > 0:
        reason = (
            "Cannot be told: the walk that would say what mass stands behind a heel has no step."
        )
        return Part(TITLE, [reason])
    design = evaluation.trials[0].design
    constants = sorted(next(iter(evaluated.band.values())))
    pads = {constant: pad_of_contact(design, mass, constant) for constant in constants}
    own = float(design.contact_section.time_constant)
    bands = evaluated.band.values()
    rows = [
        _row(constant, pad, mass, own, [walks[constant] for walks in bands])
        for constant, pad in pads.items()
    ]
    return Part(
        TITLE,
        [
            _assumption(pads[constants[0]], pads[constants[-1]], mass),
            Table(
                [
                    "time constant",
                    "stiffness [kN/m]",
                    "damping [Ns/m]",
                    "modulus [MPa]",
                    *(name.replace("_", " ") for name in evaluated.band),
                    "difference",
                ],
                rows,
                "Peak of the filtered vertical force within 50 ms of touchdown, in body weights. "
                "The policies were trained at the design's contact only.",
            ),
            draw(
                "impact_band",
                "Impact over the stiffness of the pad under a heel.",
                later(
                    impact_band_figure,
                    evaluated.band,
                    {constant: pad.stiffness for constant, pad in pads.items()},
                ),
            ),
        ],
    )


def _mass_behind_a_heel(evaluation: Evaluation) -> float:
    """Effective mass at touchdown, median over the steps of the first kept walk [kg]; NaN without
    any step.
    """
    trial = evaluation.trials[0]
    steps = measured_steps(trial, evaluation.protocol.events)
    if not len(steps):
        return math.nan
    return float(np.median(heel_mass(trial, steps.touchdown, steps.foot)))


def _assumption(stiff: FootPad, soft: FootPad, mass: float) -> str:
    """The pad that the contact is taken for, and what that means for the numbers."""
    return (
        "Much of an impact is the stiffness of the sole. The stated pad: "
        f"{1e3 * stiff.thickness:.0f} mm of a soft sole on {1e4 * stiff.area:.1f} cm² under each "
        f"heel; behind it stands an effective mass of {mass:.2f} kg at touchdown (median over the "
        "steps of one walk, rotors included), which turns the contact's time constant into "
        "stiffness and damping. All time constants on this page but in this table are the "
        f"design's; the first pad is {stiff.stiffness / soft.stiffness:.0f} times as stiff as the "
        "last, and steps of 5 ms allow none stiffer. Solid rubber, at 1 to 10 MPa, would be "
        "stiffer than any of them, so printed newtons are not to be expected; designs are compared "
        "at equal settings."
    )


def _row(
    constant: float, pad: FootPad, mass: float, own: float, walks: Sequence[Sequence[Evaluation]]
) -> list[Any]:
    """Row of the table: one time constant [s], its pad, and the peaks of each design."""
    peaks = [[e.values(PEAK) for e in evaluations] for evaluations in walks]
    cells = []
    for evaluations, values in zip(walks, peaks, strict=True):
        value = statistics.estimate(values, resamples=RESAMPLES)
        low = value.low if value.speaks_of_seeds else math.nan
        fell = int(sum(e.values("fell").sum() for e in evaluations))
        cells.append(interval(value.mean, low, value.high, "") + (f", {fell} fell" if fell else ""))
    comparison = (
        statistics.difference(*peaks, resamples=RESAMPLES).verdict if len(peaks) == 2 else ""
    )
    return [
        f"{1e3 * constant:.3g} ms{' (all else here)' if math.isclose(constant, own) else ''}",
        pad.stiffness / 1e3,
        pad.damping(mass),
        pad.modulus / 1e6,
        *cells,
        verdict(comparison),
    ]
