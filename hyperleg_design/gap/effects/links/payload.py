"""A mass that hangs on a link."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.links.inertial import (
    REACH,
    MomentsEffect,
    carried_mass,
    least_mass,
)
from hyperleg_design.gap.effects.links.link_mass import DRAWN
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals

SHARE = 0.2
"""Usual payload over the mass that moves with the link (assumed: tools and batteries; a UR10e
carries 2.8 kg on 33 kg of arm)."""
FAR, OUT_OF_REACH = 4.0, 3.0
"""Log odds against a load that is farther from its link's origin than so many times the link's own
centre of mass (assumed)."""
NEAR = 0.4
"""Share of the robot's length up to which none is far (assumed: batteries and tools are)."""
NEGATIVE = 8.0
"""Log odds against a load that weighs less than nothing, beyond what is declared [nat]."""
INWARD, OUTERMOST = 3.0, 2.0
"""Log odds against a load far from the ends of a robot, and for one on a link that carries none, or
on a base (assumed: loads hang on hands and lie on backs) [nat]."""
MASS_SOURCE = "UR10e logs with 2.8 kg; tools and batteries, 20 % of what the link moves (assumed)"
COM_X_SOURCE = "in the link's frame: a hand's breadth, or that of the link itself (assumed)"
GYRATION_SOURCE = "of a body 10 cm across (assumed)"


class Payload(MomentsEffect):
    """A body fixed to a link, over what the model or the log's metadata already put there, equally
    hard to turn about any axis.

    A motion feels its mass and its first moment, mass times com, so com means nothing where mass is
    0; one joint alone cannot tell the two apart. Left out, the body's own inertia would bend the
    estimates of its mass: the wrist of an arm feels it.
    """

    identifier: ClassVar[str] = "payload"
    summary: ClassVar[str] = "a mass that hangs on a link and that the model does not have"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("mass", "kg", 0.0, -1e4, 1e4, 0.5, MASS_SOURCE),
        Parameter("com_x", "m", 0.0, -1.0, 1.0, 0.05, COM_X_SOURCE, shape=True),
        Parameter("com_y", "m", 0.0, -1.0, 1.0, 0.05, "as com_x (assumed)", shape=True),
        Parameter("com_z", "m", 0.0, -1.0, 1.0, 0.05, "as com_x (assumed)", shape=True),
        Parameter("gyration_squared", "m^2", 0.0, 0.0, 0.1, 0.0025, GYRATION_SOURCE, shape=True),
    )

    @override
    def added(self, own: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Those of the body, wherever the link's own mass is."""
        mass, (x, y, z, own_inertia) = values[:, 0], values[:, 1:].T
        inertia = (
            y * y + z * z + own_inertia,
            -x * y,
            x * x + z * z + own_inertia,
            -x * z,
            -y * z,
            x * x + y * y + own_inertia,
        )
        return mass[:, None] * np.stack([np.ones_like(x), x, y, z, *inertia], -1)

    @override
    def usual_errors(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """As that of a link's own mass: what is no heavier may be part of it."""
        tree, size = subject.tree, np.eye(len(self.parameters))[0]
        return {
            link: DRAWN * tree.link_inertial[tree.link(link), 0] * size
            for link in self.locations(subject)
        }

    @override
    def usual(self, location: str, subject: Subject) -> np.ndarray:
        """A share of the mass that moves with the link, anywhere along the link: its own centre of
        mass says how far it reaches from the joint, which is where loads hang least.
        """
        typical = super().usual(location, subject)
        typical[0] = max(SHARE * carried_mass(subject, location), 0.01)
        own = subject.tree.link_inertial[subject.tree.link(location)]
        if own[0] > 0:
            typical[1:4] = np.hypot(typical[1:4], own[1:4] / own[0])
        return typical

    @override
    def example(self, location: str, subject: Subject, size: float = 1.0) -> np.ndarray:
        """With its centre of mass 1.5 times as far from the link's origin as the link's own; a load
        at a joint's axis is hardly felt.
        """
        values = super().example(location, subject, size)
        link_inertial = subject.tree.link_inertial[subject.tree.link(location)]
        if link_inertial[0] > 0:
            values[1:4] = np.clip(1.5 * link_inertial[1:4] / link_inertial[0], -1.0, 1.0)
            values[4] = 0.0
        return values

    @override
    def bounds(self, location: str, subject: Subject) -> np.ndarray:
        """Usual bounds, but no less mass than leaves some of the link."""
        bounds = super().bounds(location, subject)
        bounds[0, 0] = max(bounds[0, 0], least_mass(subject, location))
        return bounds

    @override
    def odds(self, location: str, subject: Subject, values: np.ndarray) -> float:
        """Against a load out of the link's reach: what bends a motion like a pole with a weight is
        rather no load.
        """
        own = subject.tree.link_inertial[subject.tree.link(location)]
        near = NEAR * subject.tree.length
        if own[0] > 0:
            near = max(near, OUT_OF_REACH * float(np.linalg.norm(own[1:4])) / float(own[0]))
        away = float(np.sqrt(values[1:4] @ values[1:4] + values[4]))
        return -FAR if near > 0 and away > near else 0.0

    @override
    def size_odds(
        self, values: np.ndarray, usual: np.ndarray, declared: float, beyond: int
    ) -> float:
        """Against a load that weighs less than nothing, and one far from the ends of the robot."""
        return -(
            NEGATIVE * (values[0] < -declared) + INWARD * (beyond > 1) - OUTERMOST * (beyond == 0)
        )

    @override
    def adding(self, location: str, subject: Subject, moments: np.ndarray) -> np.ndarray:
        """A load of that mass and first moment; and one of that moment which is as far away as
        `example` has it, where motions hardly tell the mass.
        """
        mass, moment = float(moments[0]), moments[1:]
        away = float(np.linalg.norm(self.example(location, subject)[1:4]))
        masses = mass, float(np.copysign(np.linalg.norm(moment) / max(away, REACH), mass))
        return np.array([[m, *(moment / m), 0.0] for m in masses if m]).reshape(-1, 5)

    @override
    def starts(self, signals: Signals, location: str) -> np.ndarray:
        """The usual mass where `example` has it, and as much less."""
        low, high = self.bounds(location, signals.subject)
        shown = self.example(location, signals.subject)
        values = np.clip([shown, shown * np.array([-1.0, 1.0, 1.0, 1.0, 1.0])], low, high)
        return np.asarray(values[values[:, 0] != 0])
