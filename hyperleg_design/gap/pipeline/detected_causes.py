"""Add causes that no residual shows to a diagnosis: feet that slide or sink."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.detectors.sinking import SINKS
from hyperleg_design.gap.inference.detectors.slipping import EFFECT as SLIPPERY
from hyperleg_design.gap.inference.detectors.slipping import SLIPS
from hyperleg_design.gap.inference.detectors.underfoot import Underfoot
from hyperleg_design.gap.logs.columns import force_names
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.results.diagnosis import (
    MOST_RIVALS,
    Diagnosis,
    Named,
    Place,
    Shrinkage,
    residual_shape,
)
from hyperleg_design.gap.signals.contact import foot_chain

APART = (SLIPS, SINKS)
"""Names of these findings in `Diagnosis.residual_shape`."""
OF_FEET = 0.5
"""Share of an unknown gap that lies in the residuals of sliding or sinking feet, from which their
ground explains it [-]."""


def of_feet(
    diagnosis: Diagnosis, feet: Sequence[Underfoot], certain: float, least: float
) -> Diagnosis:
    """Add slippery or soft ground, which feet show, to the causes of a diagnosis.

    Where no cause is named, the ground is the answer if at least `OF_FEET` of the gap lies under
    these feet, and the first rival otherwise.

    Args:
        diagnosis: the diagnosis so far.
        feet: effects of the ground under some feet.
        certain: probability of what is certain, `PosteriorRules.highest`.
        least: share of a gap from which a remainder is reported, `PosteriorRules.remainder`.

    Returns:
        The diagnosis with them.
    """
    diagnosis = _without_creep(diagnosis, feet)
    feet = [
        foot for foot in feet if foot.name not in {(c.effect, c.location) for c in diagnosis.causes}
    ]
    if not feet:
        return diagnosis
    noted = (residual_shape(foot.shape, foot.foot, foot.sentence, foot.closed) for foot in feet)
    effects = {foot.effect for foot in feet}
    rivals = tuple(r for r in diagnosis.rivals if r.effect not in effects)
    diagnosis = replace(
        diagnosis, residual_shape=(*noted, *diagnosis.residual_shape), rivals=rivals
    )
    causes = tuple(Named(*foot.name, certain, foot.closed, foot.parameters) for foot in feet)
    if diagnosis.causes:
        return replace(diagnosis, causes=(*diagnosis.causes, *causes))
    names = {foot.foot for foot in feet}
    under = (w for w in diagnosis.where if w.regime == "all" and w.kind == "foot")
    theirs = sum(w.share for w in under if w.location in names)
    if diagnosis.verdict == "unknown" and theirs < OF_FEET:
        return _with_part(diagnosis, causes[0])
    weight = sum(foot.weight for foot in feet)
    before = sum(foot.weight * foot.size**2 for foot in feet) / weight
    after = sum(foot.weight * foot.left**2 for foot in feet) / weight
    closed = 1 - (after / before) ** 0.5
    gap = Shrinkage(before**0.5, after**0.5, 0.0, closed, (closed, closed), feet[0].unit)
    shares = (foot.weight * foot.size**2 / (before * weight) for foot in feet)
    where = (Place(o.foot, "foot", "all", share) for o, share in zip(feet, shares, strict=True))
    diagnosis = _explained(diagnosis, names, theirs, least)
    return _instead(diagnosis, causes, gap, tuple(where))


def misplaced_feet(diagnosis: Diagnosis, subject: Subject) -> set[str]:
    """Find the feet that are elsewhere than their logs say, as a cause is the zero of an encoder of
    their leg.

    Args:
        diagnosis: the diagnosis so far.
        subject: the robot.

    Returns:
        Names of feet.
    """
    joints = {
        subject.joints.index(cause.location)
        for cause in diagnosis.causes
        if EFFECTS[cause.effect].of_zeros
    }
    return {
        name
        for foot, name in enumerate(subject.feet)
        if joints.intersection(foot_chain(subject, foot))
    }


def _explained(
    diagnosis: Diagnosis, feet: Collection[str], share: float, least: float
) -> Diagnosis:
    """A diagnosis without what it says of the forces of some feet, which make a share of what it
    leaves over; less than `least` is no remainder.
    """
    theirs = set(force_names(feet))
    shapes = tuple(shape for shape in diagnosis.residual_shape if shape["location"] not in theirs)
    left = (diagnosis.remainder or 0.0) * (1 - share)
    return replace(diagnosis, residual_shape=shapes, remainder=left if left >= least else None)


def _with_part(diagnosis: Diagnosis, cause: Named) -> Diagnosis:
    """An unknown gap, of which a cause may be a part."""
    beside = sum(r.probability for r in diagnosis.rivals)
    part = replace(cause, probability=max(1 - beside, 0.0) / 2)
    return replace(diagnosis, rivals=(part, *diagnosis.rivals)[:MOST_RIVALS])


def _instead(
    diagnosis: Diagnosis, causes: tuple[Named, ...], gap: Shrinkage, where: tuple[Place, ...]
) -> Diagnosis:
    """Causes alone, with a gap of their own; what was a rival shares what is left of the first
    one's probability.
    """
    beside, otherwise = sum(r.probability for r in diagnosis.rivals), 1 - causes[0].probability
    rivals = tuple(
        replace(r, probability=r.probability * otherwise / max(beside, 1.0), closed=0.0)
        for r in diagnosis.rivals
    )
    return replace(
        diagnosis, verdict="explained", gap=gap, where=where, causes=causes, rivals=rivals
    )


def _without_creep(diagnosis: Diagnosis, feet: Sequence[Underfoot]) -> Diagnosis:
    """Without slippery ground under feet that sink and are not known to slide: what is soft
    creeps.
    """
    slid = {shape["location"] for shape in diagnosis.residual_shape if shape["shape"] == SLIPS}
    soft = {(SLIPPERY, foot.foot) for foot in feet if foot.shape == SINKS and foot.foot not in slid}
    others = tuple(c for c in diagnosis.causes if (c.effect, c.location) not in soft)
    if len(others) == len(diagnosis.causes):
        return diagnosis
    sets = tuple(group for group in diagnosis.equivalent if not soft.intersection(group))
    verdict = "explained" if diagnosis.verdict == "ambiguous" and not sets else diagnosis.verdict
    experiment = diagnosis.separating_experiment if sets else None
    diagnosis = replace(diagnosis, verdict=verdict, causes=others, equivalent=sets)
    return replace(diagnosis, separating_experiment=experiment)
