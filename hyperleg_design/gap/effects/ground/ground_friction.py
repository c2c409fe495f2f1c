"""A ground more or less slippery than modelled."""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import Excitation, Motion
from hyperleg_design.gap.effects.families import FRICTION, INERTIAL
from hyperleg_design.gap.effects.kinds import FootEffect
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals import ground, nominal_ground
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration

if TYPE_CHECKING:
    import mujoco


ICE = 2.7
"""Usual differences by which a ground is slippery enough for a standing robot's feet to slide:
friction 0.2 instead of 1 (assumed)."""
USUAL = 0.1
"""Usual error of the ground's friction over it."""
SOURCE = "rubber on dry to wet floors 0.9-0.4 (engineering tables), 30 % of a nominal 0.8"


class GroundFriction(FootEffect):
    """The coefficient of sliding friction under one foot; shows where the foot slides, or holds
    beyond the nominal cone.
    """

    identifier: ClassVar[str] = "ground_friction"
    summary: ClassVar[str] = "the ground is more or less slippery under a foot"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("scale", "", 1.0, 0.05, 5.0, 0.3, SOURCE, spread=USUAL),
    )
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "push on the ground": FRICTION | INERTIAL | {"ground_compliance"}
    }

    @override
    def excited(self, log: Log, motion: Motion) -> Excitation:
        feet = tuple(
            f for f in log.feet if any(log.has("contact_force", f"{f}_{axis}") for axis in "xy")
        )
        why = "forces along the ground" if feet else "no contact forces along the ground"
        return Excitation(self.identifier, bool(feet), feet, why)

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        scale = np.atleast_2d(np.asarray(values, float))[:, 0]
        return ground_trace(signals, location, scale, np.ones_like(scale), np.ones_like(scale))

    @override
    def example(self, location: str, subject: Subject, size: float = 1.0) -> np.ndarray:
        """As slippery as ice, because a ground that holds better than needed does nothing, and feet
        creep before they slide.
        """
        return np.maximum(
            self.nulls - ICE * size * self.usual(location, subject), self.parameters[0].low
        )

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        return ChangedGround(
            nominal_ground.foot_bodies(subject, subject.feet.index(location)),
            friction=np.asarray(values, float)[..., 0],
        )


def ground_trace(
    signals: Signals,
    location: str,
    friction: np.ndarray,
    compliance: np.ndarray,
    damping: np.ndarray,
) -> dict[str, np.ndarray]:
    """What a changed ground under one foot leaves in the ground residual; scales `(k,)` as of
    `ground.Footing.ground`.

    Args:
        signals: a conditioned log, `t` ticks.
        location: name of the foot.
        friction: scale of the friction `(k,)`.
        compliance: scale of the compliance `(k,)`.
        damping: scale of the damping `(k,)`.

    Returns:
        The trace by name of the residual `(k, t, rows)` [N].
    """
    feet = ground.footings(signals)
    if not feet:
        return {}
    place, unscaled = signals.subject.feet.index(location), np.ones(1)
    trace = np.zeros((len(friction), len(signals.time), 3 * len(feet)))
    foot = feet[place]
    trace[..., 3 * place : 3 * place + 3] = foot.ground(
        friction, compliance, damping
    ) - foot.ground(unscaled, unscaled, unscaled)
    return {"ground": trace}


@dataclass(frozen=True, eq=False)
class ChangedGround(Alteration):
    """Contact of some bodies with the floor, as it is mixed in the model, with friction, compliance
    and damping scaled.
    """

    bodies: tuple[str, ...]
    friction: Any = 1.0
    compliance: Any = 1.0
    damping: Any = 1.0

    @override
    def edit(self, model: mujoco.MjModel, simulation: int = 0) -> None:
        """Give the bodies' shapes the pair's settings, scaled, and precedence over the floor's."""
        friction, compliance, damping = (
            float(v if np.ndim(v) == 0 else v[simulation])
            for v in (np.asarray(x, float) for x in (self.friction, self.compliance, self.damping))
        )
        if friction == compliance == damping == 1.0:
            return
        floors = nominal_ground.floor_geoms(model)
        top = int(model.geom_priority[floors].max()) if floors else 0
        for geom in nominal_ground.foot_geoms(model, self.bodies):
            mixed, solref, dimensions = nominal_ground.pair_settings(model, geom)
            if solref[0] > 0:
                # k' falls by the compliance, b' by its root, so that the damping ratio stays unless
                # scaled itself
                solref = solref * np.array([np.sqrt(compliance) / damping, damping])
            else:
                solref = solref * np.array([1 / compliance, damping / np.sqrt(compliance)])
            model.geom_friction[geom] = mixed * np.array([friction, 1.0, 1.0])
            model.geom_solref[geom] = solref
            model.geom_condim[geom] = dimensions
            model.geom_priority[geom] = max(top + 1, int(model.geom_priority[geom]))
