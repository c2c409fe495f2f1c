"""A link whose centre of mass is not where the model has it."""

from __future__ import annotations

from collections.abc import Mapping, Set
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import SWINGING, Need
from hyperleg_design.gap.effects.families import INERTIAL
from hyperleg_design.gap.effects.links.inertial import MomentsEffect, OwnInertiaEffect
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.model.mechanism import inertial_parameters, mass_properties
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals

OF_ARM, SHORTEST = 0.03, 0.03
"""Usual error over the distance of a link's centre of mass from its joint, at least of so many
metres."""
SOURCE = "a centimetre: motors and cables placed by eye in the drawing (assumed)"


class LinkCom(OwnInertiaEffect, MomentsEffect):
    """A link's mass moved as a whole in the link's frame; inertia about the centre of mass
    stays.
    """

    identifier: ClassVar[str] = "link_com"
    nuisance_rank: ClassVar[int] = 1
    rare: ClassVar[float] = -1.0
    """Assumed: links are made as drawn, while zeros of encoders slip."""
    summary: ClassVar[str] = "a link's centre of mass is elsewhere than modelled"
    parameters: ClassVar[tuple[Parameter, ...]] = tuple(
        Parameter(axis, "m", 0.0, -0.3, 0.3, 0.01, SOURCE) for axis in "xyz"
    )
    needs: ClassVar[Need] = Need(
        lambda motion: motion.swinging & motion.turning,
        SWINGING.good,
        f"{SWINGING.lacking} that turns a link",
    )
    told_apart: ClassVar[Mapping[str, Set[str]]] = {"several postures": INERTIAL}

    @override
    def nuisance_spreads(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """A share of the distance of the centre of mass from the joint."""
        spreads = {}
        for link in self.locations(subject):
            own = subject.tree.link_inertial[subject.tree.link(link)]
            arm = max(float(np.linalg.norm(own[1:4] / own[0])), SHORTEST)
            spreads[link] = np.full(3, OF_ARM * arm)
        return spreads

    @override
    def added(self, own: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Of the moved link less the link."""
        mass, com, inertia = mass_properties(own)
        as_given = inertial_parameters(mass, com, inertia)
        moved = [inertial_parameters(mass, com + v, inertia) - as_given for v in values]
        return np.array(moved).reshape(-1, len(own))

    @override
    def adding(self, location: str, subject: Subject, moments: np.ndarray) -> np.ndarray:
        """The shift that adds a first moment."""
        own = subject.tree.link_inertial[subject.tree.link(location)]
        return np.asarray(moments[None, 1:4] / own[0])

    @override
    def starts(self, signals: Signals, location: str) -> np.ndarray:
        """The usual shift along each axis."""
        usual = np.diag(self.usual(location, signals.subject))
        low, high = self.bounds(location, signals.subject)
        return np.clip(np.concatenate([usual, -usual]), low, high)
