"""A link whose centre of mass is not where the model has it."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from hyperleg_design.gap.effects.effect import Parameter
from hyperleg_design.gap.effects.inertial import InertialEffect
from hyperleg_design.gap.mechanism import inertial_parameters, mass_properties

if TYPE_CHECKING:
    from hyperleg_design.gap.subject import Subject


class LinkCom(InertialEffect):
    """A link's mass moved as a whole in the link's frame; inertia about the centre of mass stays."""

    identifier: ClassVar[str] = "link_com"
    summary: ClassVar[str] = "a link's centre of mass is elsewhere than modelled"
    parameters: ClassVar[tuple[Parameter, ...]] = tuple(
        Parameter(axis, "m", 0.0, -0.3, 0.3, 0.01, "a centimetre: motors and cables placed by eye in the drawing (assumed)") for axis in "xyz"
    )

    def locations(self, subject: Subject) -> tuple[str, ...]:
        """Moving links that have a mass."""
        return tuple(name for name, own in zip(subject.tree.links, subject.tree.link_inertial, strict=True) if own[0] > 0)

    def added(self, own: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Of the moved link less the link, see `InertialEffect.added`."""
        mass, com, inertia = mass_properties(own)
        return np.stack([inertial_parameters(mass, com + shift, inertia) - inertial_parameters(mass, com, inertia) for shift in values])
