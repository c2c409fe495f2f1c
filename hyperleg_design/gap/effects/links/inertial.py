"""What effects that change a link's mass properties have in common: ten parameters added in the
link's frame.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from itertools import compress
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.errors import InputError
from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.effects.excitation import SWINGING, Need
from hyperleg_design.gap.effects.links import regressor
from hyperleg_design.gap.effects.spanned import SpannedEffect
from hyperleg_design.gap.model.body_inertia import add_inertia
from hyperleg_design.gap.model.mechanism import BASE
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration

if TYPE_CHECKING:
    import mujoco


LARGEST_LOSS = 0.99
"""Share of a link's own mass that may be missing at most."""
OF_CARRIED, REACH = 0.2, 0.05
"""Share of what moves with a link that is added to it in a linear fit, and how far from the link's
origin, at least [m] (assumed)."""


class InertialEffect(Effect):
    """Adds inertial parameters to a link, by its own name or that of the joint that carries it.

    Its trace is the inertial regressor times what it adds, in the rows of the joints before the
    link and, where contact forces are logged, in those of the base.
    """

    kind: ClassVar[str] = "link"
    needs: ClassVar[Need] = SWINGING
    inertial: ClassVar[bool] = True

    @override
    def locations(self, subject: Subject) -> tuple[str, ...]:
        """Moving links, one of those that move as one body."""
        tree = subject.tree
        carriers = tree.link_joint.tolist()
        return tuple(name for i, name in enumerate(tree.links) if carriers[i] not in carriers[:i])

    @override
    def place(self, location: str, subject: Subject) -> str:
        """The link that is meant; any moving link will do, or a joint, for the link that it
        carries.
        """
        tree = subject.tree
        return (
            tree.links[tree.link(location)]
            if location in (*tree.links, *tree.joints)
            else super().place(location, subject)
        )

    @abstractmethod
    def added(self, own: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Inertial parameters `(k, 10)` that it adds to those of the link itself `(10,)`, both in
        the link's frame.
        """

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        added = self._added(location, signals.subject, values)
        return self._traces(signals, location, added)

    def _added(self, location: str, subject: Subject, values: np.ndarray) -> np.ndarray:
        own = subject.tree.link_inertial[subject.tree.link(location)]
        return self.added(own, np.atleast_2d(np.asarray(values, float)))

    def _traces(self, signals: Signals, location: str, added: np.ndarray) -> dict[str, np.ndarray]:
        """Traces by residual of inertial parameters `(k, 10)` that are added to a link."""
        tree = signals.subject.tree
        link = tree.link(location)
        traces = {}
        if tree.link_joint[link] != BASE:
            traces["motion"] = np.einsum(
                "tnp,kp->ktn", regressor.link_regressor(signals, tree.links[link]), added
            )
        if "base" in signals.residual:
            # what the ground must give more, it shows
            traces["base"] = np.einsum(
                "trp,kp->ktr", regressor.base_regressor(signals, tree.links[link]), added
            )
        return traces

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        tree = subject.tree
        link = tree.link(location)
        values = np.asarray(values, float)
        added = self.added(tree.link_inertial[link], np.atleast_2d(values))
        if np.any(tree.link_inertial[link, 0] + added[:, 0] < 0):
            remedy = (
                f"takes more than the {tree.link_inertial[link, 0]:.3g} kg that "
                f"{tree.links[link]} has"
            )
            raise InputError(self.identifier, "mass", float(added[:, 0].min()), remedy)
        return AddedInertia(tree.links[link], added if values.ndim > 1 else added[0])


class OwnInertiaEffect(InertialEffect):
    """An error of what a link has itself."""

    @override
    def locations(self, subject: Subject) -> tuple[str, ...]:
        """Moving links that have a mass."""
        return tuple(compress(subject.tree.links, subject.tree.link_inertial[:, 0] > 0))


class MomentsEffect(InertialEffect, SpannedEffect):
    """One that is not linear in its own parameters; its traces are sums of those of the ten."""

    @override
    def span(self, signals: Signals, location: str) -> dict[str, np.ndarray]:
        """Traces of the ten parameters."""
        return self._traces(signals, location, np.diag(_scale(signals.subject, location)))

    @override
    def in_span(self, location: str, subject: Subject, values: np.ndarray) -> np.ndarray:
        """What it adds, over the usual sizes of the ten parameters."""
        return self._added(location, subject, values) / _scale(subject, location)

    @override
    def nearest(self, location: str, subject: Subject, sizes: np.ndarray) -> np.ndarray:
        """Values that add such a mass and first moment."""
        low, high = self.bounds(location, subject)
        whole = np.asarray(sizes, float) * _scale(subject, location)
        values = np.clip(self.adding(location, subject, whole[:4]), low, high)
        return np.asarray(values[self._added(location, subject, values).any(1)])

    @abstractmethod
    def adding(self, location: str, subject: Subject, moments: np.ndarray) -> np.ndarray:
        """Values that add a mass and first moment to a link, or some of these.

        Args:
            location: one of `locations`.
            subject: the robot.
            moments: mass and first moment `(4,)`.

        Returns:
            `(s, parameters)`, each worth a try.
        """


@dataclass(frozen=True, eq=False)
class AddedInertia(Alteration):
    """Inertial parameters added to a body of the model."""

    body: str
    added: Any
    """In the body's frame, `(10,)` or `(n, 10)`."""

    def edit(self, model: mujoco.MjModel, simulation: int = 0) -> None:
        """Change the body's mass, centre of mass and inertia.

        Args:
            model: the compiled model, which is changed.
            simulation: index of the simulation, of values that have one row each.
        """
        added = self.added if self.added.ndim == 1 else self.added[simulation]
        if added.any():
            add_inertia(model, self.body, added)


def _scale(subject: Subject, link: str) -> np.ndarray:
    """Usual size of each of the ten parameters `(10,)`."""
    own = subject.tree.link_inertial[subject.tree.link(link)]
    mass = OF_CARRIED * max(carried_mass(subject, link), 1e-3)
    reach = max(REACH, float(np.linalg.norm(own[1:4])) / float(own[0]) if own[0] > 0 else 0.0)
    return mass * np.array([1.0, *[reach] * 3, *[reach**2] * 6])


def least_mass(subject: Subject, link: str) -> float:
    """Lowest that a link's mass may be changed by [kg]: what is left must be something.

    Args:
        subject: the robot.
        link: name of the link.

    Returns:
        The change [kg], not above zero.
    """
    tree = subject.tree
    return -LARGEST_LOSS * float(tree.link_inertial[tree.link(link), 0])


def carried_mass(subject: Subject, link: str) -> float:
    """Mass of a link and of all that it carries [kg].

    Args:
        subject: the robot.
        link: name of the link.

    Returns:
        The mass [kg].
    """
    tree = subject.tree
    joint = int(tree.link_joint[tree.link(link)])
    return float(
        sum(
            own[0]
            for own, carrier in zip(tree.link_inertial, tree.link_joint, strict=True)
            if joint == BASE or joint in tree.chain(int(carrier))
        )
    )
