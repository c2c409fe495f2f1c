"""A ground softer or harder than modelled."""

from __future__ import annotations

from collections.abc import Mapping, Set
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import Excitation, Motion
from hyperleg_design.gap.effects.families import FRICTION, INERTIAL
from hyperleg_design.gap.effects.ground.ground_friction import ChangedGround, ground_trace
from hyperleg_design.gap.effects.kinds import FootEffect
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals import nominal_ground
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration

USUAL = 0.5
"""Usual error of how the ground gives and damps, over it; no simulator has it from a
measurement."""
SCALE_SOURCE = "soles and mats: 1-5 mm under body weight against a fraction of that (estimate)"
DAMPING_SCALE_SOURCE = (
    "of the damping ratio: rubber 0.05-0.3 against a critically damped model (estimate)"
)


class GroundCompliance(FootEffect):
    """Compliance of sole and ground under one foot [m/N], and how well it is damped, over the
    model's; shows in vertical forces.

    Only where contact forces and the base's height are logged.
    """

    identifier: ClassVar[str] = "ground_compliance"
    nuisance_rank: ClassVar[int] = 1
    summary: ClassVar[str] = "the ground or the sole is softer or harder under a foot"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("scale", "", 1.0, 0.1, 20.0, 1.0, SCALE_SOURCE, spread=USUAL),
        Parameter("damping_scale", "", 1.0, 0.1, 5.0, 0.5, DAMPING_SCALE_SOURCE, spread=USUAL),
    )
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "push on the ground": FRICTION | INERTIAL | {"ground_friction"}
    }

    @override
    def excited(self, log: Log, motion: Motion) -> Excitation:
        feet = tuple(f for f in log.feet if log.has("contact_force", f"{f}_z"))
        why = "vertical contact forces" if feet else "no contact forces"
        return Excitation(self.identifier, bool(feet), feet, why)

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        scale, damping = np.atleast_2d(np.asarray(values, float)).T
        return ground_trace(signals, location, np.ones_like(scale), scale, damping)

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        values = np.asarray(values, float)
        bodies = nominal_ground.foot_bodies(subject, subject.feet.index(location))
        return ChangedGround(bodies, compliance=values[..., 0], damping=values[..., 1])
