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
from hyperleg_design.gap.model.body_inertia import add_inertia
from hyperleg_design.gap.model.mechanism import BASE
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals import regressor
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration

if TYPE_CHECKING:
    import mujoco


LARGEST_LOSS = 0.95
"""Share of a link's own mass that may be missing at most."""
RIDGE = 1e-3
"""Damping of a linear fit that finds a start, over the regressor's own size."""


class InertialEffect(Effect):
    """Adds inertial parameters to a link, by its own name or that of the joint that carries it.

    Its trace is the inertial regressor times what it adds, in the rows of the joints before the
    link and, where contact forces are logged, in those of the base.
    """

    kind: ClassVar[str] = "link"
    needs: ClassVar[Need] = SWINGING
    steady: ClassVar[bool] = True

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
        tree = signals.subject.tree
        link = tree.link(location)
        added = self.added(tree.link_inertial[link], np.atleast_2d(np.asarray(values, float)))
        found = {}
        if tree.link_joint[link] != BASE:
            found["motion"] = np.einsum(
                "tnp,kp->ktn", regressor.link_regressor(signals, tree.links[link]), added
            )
        if "base" in signals.residual:
            # what the ground must give more, it shows
            found["base"] = np.einsum(
                "trp,kp->ktr", regressor.base_regressor(signals, tree.links[link]), added
            )
        return found

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


def fitted(signals: Signals, link: str, part: slice) -> np.ndarray | None:
    """Some of the first four inertial parameters that a linear fit to a log adds to a link; None
    where it shows none of them. What a floating base carries is in no joint's torque, but in what
    the ground must give more.

    Args:
        signals: a conditioned log, `t` ticks.
        link: name of the link.
        part: which of the first four are wanted.

    Returns:
        The parameters, or None.
    """
    tree = signals.subject.tree
    on_base = tree.link_joint[tree.link(link)] == BASE
    residual = signals.residual.get("base" if on_base else "motion")
    if residual is None:
        return None
    known = np.isfinite(residual) & signals.valid[:, None]
    whole = (regressor.base_regressor if on_base else regressor.link_regressor)(signals, link)
    columns, values = whole[..., :4][known][:, part], residual[known]
    square = columns.T @ columns
    if not len(values) or np.trace(square) <= 0:
        return None
    ridge = RIDGE * np.trace(square) / 4 * np.eye(len(square))
    return np.asarray(np.linalg.solve(square + ridge, columns.T @ values))


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
