"""Causes that no balance shows, put into a diagnosis: belts that are heard, sensors that differ from others, feet that slide or sink."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from hyperleg_design.gap import experiment
from hyperleg_design.gap.diagnosis import LEAST_SHARE, MOST_RIVALS, Diagnosis, Named, Place, Shrinkage
from hyperleg_design.gap.imu_offset import OFFSET, PLACE
from hyperleg_design.gap.loose import KNOCKING, RINGING
from hyperleg_design.gap.sinking import SINKS
from hyperleg_design.gap.slipping import EFFECT as SLIPPERY
from hyperleg_design.gap.slipping import SLIPS

if TYPE_CHECKING:
    from hyperleg_design.gap.imu_offset import Offset
    from hyperleg_design.gap.loose import Loose
    from hyperleg_design.gap.underfoot import Underfoot

APART = (RINGING, KNOCKING, OFFSET, SLIPS, SINKS)
"""Shapes by which such causes are known."""
OTHER_SENSOR = 0.05
"""Probability that what differs from an IMU is wrong instead of it (assumed)."""
OTHER_GROUND = 0.05
"""Probability that forces or heights of feet are wrong instead of their ground (assumed)."""
OF_FEET = 0.5
"""Share of an unknown gap in the ground under feet that tell of it, from which it is theirs."""
OTHERWISE = 0.15
"""Probability at most that something else makes a belt's noises (assumed): it would have explained them."""


def of_belt(told: Diagnosis, belt: Loose) -> Diagnosis:
    """A diagnosis with the belt that rings or lets its joints knock: beside what is named already, or instead of nothing.

    Where nothing is named, the gap is that of the belt: what rings is in no balance.
    """
    names = tuple((c.effect, c.location) for c in belt.causes)
    rivals = [r for r in told.rivals if (r.effect, r.location) not in names]
    beside = sum(r.probability for r in rivals)
    likely = 1 - (OTHERWISE if told.causes else min(beside, OTHERWISE))
    first, second = (replace(c, probability=likely * c.probability) for c in belt.causes)
    noise = {"shape": belt.shape, "location": belt.motor, "says": belt.says, "closed_beyond": belt.closed, "gain": 0.0}
    shapes = (noise, *(s for s in told.residual_shape if s["shape"] != "chatter"))
    if told.causes:
        return replace(
            told, verdict="ambiguous", causes=(*told.causes, first), rivals=(*rivals, second)[:MOST_RIVALS], equivalent=(*told.equivalent, names),
            residual_shape=shapes,
        )  # fmt: skip
    rivals = [replace(r, probability=r.probability * (1 - likely) / max(beside, 1e-12), closed=0.0) for r in rivals]  # of what is heard
    trial = experiment.separating(names)
    ordered = sorted(belt.shares.items(), key=lambda item: (-item[1], item[0]))
    return replace(
        told, verdict="ambiguous", gap=Shrinkage(belt.missed, (1 - belt.closed) * belt.missed, 0.0, belt.closed, belt.closed_interval, "Nm"),
        where=tuple(Place(motor, "motor", "all", share) for motor, share in ordered if share >= LEAST_SHARE),
        causes=(first,), rivals=(second, *rivals)[:MOST_RIVALS], equivalent=(names,),
        separating_experiment=None if trial is None else experiment.as_mapping(trial, names),
        residual_shape=shapes,
    )  # fmt: skip


def of_imu(told: Diagnosis, offset: Offset) -> Diagnosis:
    """A diagnosis with an IMU's constant error: beside what is named already, or instead of nothing; of an unknown gap it is a part.

    A vertical that leans is no effect of the catalogue, but may be an accelerometer's error: alone, it is an unknown gap.
    """
    if any((c.effect, c.location) == PLACE for c in told.causes):
        return told
    shape = {"shape": OFFSET, "location": PLACE[1], "says": offset.says, "closed_beyond": offset.closed, "gain": 0.0}
    shapes = (shape, *told.residual_shape)
    rivals = [r for r in told.rivals if (r.effect, r.location) != PLACE]
    beside = sum(r.probability for r in rivals)
    cause = Named(*PLACE, 1 - OTHER_SENSOR, offset.closed, offset.parameters)
    if told.causes:
        return replace(told, causes=told.causes if offset.leans else (*told.causes, cause), rivals=tuple(rivals), residual_shape=shapes)
    if told.verdict == "unknown" or offset.leans:
        part = replace(cause, probability=max(1 - beside, 0.0) / 2)
        return replace(told, verdict="unknown", rivals=(part, *rivals)[:MOST_RIVALS], residual_shape=shapes)
    scaled = tuple(replace(r, probability=r.probability * OTHER_SENSOR / max(beside, 1.0), closed=0.0) for r in rivals)
    gap = Shrinkage(offset.size, offset.left, 0.0, offset.closed, (offset.closed, offset.closed), offset.unit)
    return replace(
        told, verdict="explained", gap=gap, where=(Place(PLACE[1], "sensor", "all", 1.0),), causes=(cause,), rivals=scaled, residual_shape=shapes
    )


def of_feet(told: Diagnosis, feet: Sequence[Underfoot]) -> Diagnosis:
    """A diagnosis with what feet tell of their ground: beside what is named already, or instead of nothing.

    An unknown gap is theirs where it lies under them, else they are a part of it.
    """
    told = _without_creep(told, feet)
    feet = [one for one in feet if one.name not in {(c.effect, c.location) for c in told.causes}]
    if not feet:
        return told
    noted = ({"shape": one.shape, "location": one.foot, "says": one.says, "closed_beyond": one.closed, "gain": 0.0} for one in feet)
    shapes = (*noted, *told.residual_shape)
    causes = tuple(Named(*one.name, 1 - OTHER_GROUND, one.closed, one.parameters) for one in feet)
    rivals = tuple(r for r in told.rivals if r.effect not in {one.effect for one in feet})
    if told.causes:
        return replace(told, causes=(*told.causes, *causes), rivals=rivals, residual_shape=shapes)
    beside = sum(r.probability for r in rivals)
    theirs = sum(w.share for w in told.where if w.regime == "all" and w.kind == "foot" and w.location in {one.foot for one in feet})
    if told.verdict == "unknown" and theirs < OF_FEET:
        part = replace(causes[0], probability=max(1 - beside, 0.0) / 2)
        return replace(told, rivals=(part, *rivals)[:MOST_RIVALS], residual_shape=shapes)
    scaled = tuple(replace(r, probability=r.probability * OTHER_GROUND / max(beside, 1.0), closed=0.0) for r in rivals)
    weight = sum(one.weight for one in feet)
    before = sum(one.weight * one.size**2 for one in feet) / weight
    after = sum(one.weight * one.left**2 for one in feet) / weight
    closed = 1 - (after / before) ** 0.5
    gap = Shrinkage(before**0.5, after**0.5, 0.0, closed, (closed, closed), feet[0].unit)
    where = tuple(Place(one.foot, "foot", "all", one.weight * one.size**2 / (before * weight)) for one in feet)
    return replace(told, verdict="explained", gap=gap, where=where, causes=causes, rivals=scaled, residual_shape=shapes)


def _without_creep(told: Diagnosis, feet: Sequence[Underfoot]) -> Diagnosis:
    """Without slippery ground under feet that sink and are not known to slide: what is soft creeps."""
    slid = {one["location"] for one in told.residual_shape if one["shape"] == SLIPS}
    soft = {(SLIPPERY, one.foot) for one in feet if one.shape == SINKS and one.foot not in slid}
    kept = tuple(c for c in told.causes if (c.effect, c.location) not in soft)
    return told if len(kept) == len(told.causes) else replace(told, causes=kept)
