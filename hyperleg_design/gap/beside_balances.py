"""Causes that no balance shows, put into a diagnosis: belts that are heard, sensors that differ from others."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from hyperleg_design.gap import experiment
from hyperleg_design.gap.diagnosis import LEAST_SHARE, MOST_RIVALS, Diagnosis, Named, Place, Shrinkage
from hyperleg_design.gap.imu_offset import OFFSET, PLACE
from hyperleg_design.gap.loose import KNOCKING, RINGING

if TYPE_CHECKING:
    from hyperleg_design.gap.imu_offset import Offset
    from hyperleg_design.gap.loose import Loose

APART = (RINGING, KNOCKING, OFFSET)
"""Shapes by which such causes are known."""
OTHER_SENSOR = 0.05
"""Probability that what differs from an IMU is wrong instead of it (assumed)."""
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
    """A diagnosis with an IMU's constant error: beside what is named already, or instead of nothing; of an unknown gap it is a part."""
    if any((c.effect, c.location) == PLACE for c in told.causes):
        return told
    shape = {"shape": OFFSET, "location": PLACE[1], "says": offset.says, "closed_beyond": offset.closed, "gain": 0.0}
    shapes = (shape, *told.residual_shape)
    rivals = [r for r in told.rivals if (r.effect, r.location) != PLACE]
    beside = sum(r.probability for r in rivals)
    cause = Named(*PLACE, 1 - OTHER_SENSOR, offset.closed, offset.parameters)
    if told.causes:
        return replace(told, causes=(*told.causes, cause), rivals=tuple(rivals), residual_shape=shapes)
    if told.verdict == "unknown":
        part = replace(cause, probability=max(1 - beside, 0.0) / 2)
        return replace(told, rivals=(part, *rivals)[:MOST_RIVALS], residual_shape=shapes)
    scaled = tuple(replace(r, probability=r.probability * OTHER_SENSOR / max(beside, 1.0), closed=0.0) for r in rivals)
    gap = Shrinkage(offset.size, offset.left, 0.0, offset.closed, (offset.closed, offset.closed), offset.unit)
    return replace(
        told, verdict="explained", gap=gap, where=(Place(PLACE[1], "sensor", "all", 1.0),), causes=(cause,), rivals=scaled, residual_shape=shapes
    )
