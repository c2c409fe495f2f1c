"""A link heavier or lighter than modelled."""

from __future__ import annotations

from collections.abc import Mapping, Set
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.links.inertial import OwnInertiaEffect, least_mass
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.model.subject import Subject

SHARE = 0.1
"""Usual error over the link's own mass (assumed: cables, screws and glue that a drawing leaves
out)."""
LARGEST_ERROR, HEAVIER = 0.8, 5.0
"""Error over a link's own mass from which it is rather something that hangs there; log odds against
it for as much again [nat]."""
DRAWN = 0.03
"""Usual error of a link that is drawn as it is built, over its mass."""
SOURCE = "10 % of the link's own mass: cables, screws and glue that drawings leave out (assumed)"


class LinkMass(OwnInertiaEffect):
    """An error of a link's own mass, spread as the link's mass is: centre of mass stays, inertia
    grows alike.
    """

    identifier: ClassVar[str] = "link_mass"
    summary: ClassVar[str] = "a link's own mass is off, its centre of mass is not"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("mass", "kg", 0.0, -1e4, 1e4, 0.2, SOURCE),
    )
    linear: ClassVar[bool] = True
    told_apart: ClassVar[Mapping[str, Set[str]]] = {"several postures": {"payload"}}

    @override
    def nuisance_spreads(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """A share of the link's mass."""
        tree = subject.tree
        return {
            link: np.array([DRAWN * tree.link_inertial[tree.link(link), 0]])
            for link in self.locations(subject)
        }

    @override
    def added(self, own: np.ndarray, values: np.ndarray) -> np.ndarray:
        """A share of all of the link's parameters."""
        return values[:, :1] / own[0] * own if own[0] > 0 else np.zeros((len(values), 10))

    @override
    def usual(self, location: str, subject: Subject) -> np.ndarray:
        """A share of the link's own mass."""
        tree = subject.tree
        return np.array([max(SHARE * tree.link_inertial[tree.link(location), 0], 1e-3)])

    @override
    def bounds(self, location: str, subject: Subject) -> np.ndarray:
        """Usual bounds, but no less mass than leaves some of the link."""
        bounds = super().bounds(location, subject)
        bounds[0, 0] = max(bounds[0, 0], least_mass(subject, location))
        return bounds

    @override
    def size_odds(
        self, values: np.ndarray, usual: np.ndarray, declared: float, beyond: int
    ) -> float:
        """Against most of the link's own mass: rather something hangs there."""
        return -HEAVIER * max(abs(float(values[0])) * SHARE / float(usual[0]) - LARGEST_ERROR, 0.0)
