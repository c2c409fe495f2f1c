"""Whether walks are ones that a person would believe: what is asked, what was found."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hyperleg_design.evaluation.result import Evaluation


@dataclass(frozen=True)
class Demand:
    """A range that a measure's mean over walks should lie in."""

    measure: str
    low: float
    high: float
    why: str


def _degrees(measure: str, low: float, high: float, why: str) -> Demand:
    return Demand(measure, math.radians(low), math.radians(high), why)


DEMANDS = (
    Demand("fell", 0.0, 0.0, "no fall"),
    Demand("arrived", 1.0, 1.0, "every walk reaches the distance"),
    Demand("cadence", 1.4, 2.4, "steps a second as people make them"),
    Demand("alternation", 0.98, 1.0, "left and right by turns, no hopping"),
    Demand("double_support", 0.02, 0.6, "walking, neither running nor shuffling"),
    Demand("flight", 0.0, 0.02, "no flight"),
    _degrees("knee_touchdown", -5, 20, "knee nearly straight at touchdown, 20 deg at most [rad]"),
    _degrees("knee_midstance", -5, 25, "knee nearly straight in mid-stance, 25 deg at most [rad]"),
    _degrees("knee_swing", 50, 70, "knee bent by 50 to 70 deg in the swing [rad]"),
    _degrees("ankle_dorsiflexion", -10, 20, "ankle bent up by 20 deg at most [rad]"),
    Demand("event_order", 0.9, 1.0, "heel strike, foot flat, heel off, toe off in this order"),
    Demand("force_humps", 2, 2, "two humps of the vertical force"),
    Demand("push_off_force", 0.9, 1.6, "push-off with 0.9 body weights or more"),
    Demand("ankle_push_off_power", 0.0, math.inf, "ankles that push off [W]"),
    Demand("heel_or_flat", 0.9, 1.0, "heel or flat touchdown"),
    Demand("foot_drift", 0.0, 0.02, "feet that do not slide away while they stand [m]"),
    _degrees("mean_tilt", 0, 6, "trunk within 6 deg of upright [rad]"),
    Demand("stop_share", 0.0, 0.3, "no joint that rests on a stop"),
    Demand("vibration", 0.0, 1.0, "nothing vibrates [rad/s]"),
)
"""Angles, order of events, shape of the force, push-off, cadence, slip, falls and speed are the
study's demands, after human walking (`landmarks`); the other bounds are assumed.

Slip is how far a foot has moved, straight, between first and last standing flat. `slip_per_step`,
which is reported beside it and not asked for, is longer: it adds the skid of the landing and every
to and fro of soft contacts, which give a little under each braking and push-off and come back.
"""
SPEED_SHARE = 0.05
"""Largest relative difference of the steady speed from the command."""


@dataclass(frozen=True)
class Finding:
    """A demand and what was found."""

    demand: Demand
    found: float
    """Mean over the walks that have the measure; NaN where none has."""

    @property
    def met(self) -> bool:
        """Whether it lies in the range."""
        return bool(self.demand.low <= self.found <= self.demand.high)


def walk_findings(evaluations: Sequence[Evaluation]) -> list[Finding]:
    """Compare the mean over all walks of some evaluations with each demand on a believable walk.

    Args:
        evaluations: of walks, all under one protocol, whose commanded speed is a demand, too.

    Returns:
        One finding for each demand.
    """
    speed = evaluations[0].protocol.speed
    near = Demand(
        "steady_speed",
        speed * (1 - SPEED_SHARE),
        speed * (1 + SPEED_SHARE),
        "speed within 5 % of the command [m/s]",
    )
    findings = []
    for demand in (*DEMANDS, near):
        values = np.concatenate([evaluation.values(demand.measure) for evaluation in evaluations])
        values = values[np.isfinite(values)]
        findings.append(Finding(demand, float(values.mean()) if len(values) else np.nan))
    return findings
