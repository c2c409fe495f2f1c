"""The kinematic tree of one robot: links, joints, drawings and pads, whatever family of designs it
comes from.
"""

from __future__ import annotations

import functools
import operator
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Shape:
    """A drawn or colliding primitive in its link's frame."""

    kind: str
    """`box` (full sizes), `cylinder` (radius, length, along z) or `sphere` (radius)."""
    size: tuple[float, ...]
    """Dimensions of the shape [m]."""
    position: tuple[float, float, float]
    """Position of the centre in the link's frame [m]."""


@dataclass(frozen=True, eq=False)
class Link:
    """A rigid link of the robot, with its inertia and its shapes."""

    name: str
    mass: float
    """Mass [kg]; zero only for a link that is fixed to another."""
    com: np.ndarray
    """Centre of mass [m] `(3,)`."""
    inertia: np.ndarray
    """Inertia about the centre of mass [kg m^2], `(3, 3)`."""
    visuals: tuple[Shape, ...]
    pads: tuple[Shape, ...] = ()
    """Spheres that touch the ground."""


@dataclass(frozen=True)
class TreeJoint:
    """A joint between two links."""

    name: str
    parent: str
    child: str
    position: tuple[float, float, float]
    """Position of the child's frame in the parent's [m]."""
    axis: tuple[float, float, float]
    fixed: bool
    lower: float
    """Lower end of the range of motion [rad]."""
    upper: float
    """Upper end of the range of motion [rad]."""
    effort: float
    """Largest torque [Nm]."""
    velocity: float
    """No-load speed [rad/s]."""
    coulomb: float
    """Coulomb friction [Nm]."""
    viscous: float
    """Viscous friction [Nm s/rad]."""
    default: float
    """Posture to which actions are added [rad]."""
    turn: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Roll, pitch and yaw of the child's frame in the parent's, as in URDF [rad]."""


@dataclass(frozen=True)
class Tree:
    """Links from the base outward, and the joints between them, limb by limb, parents before
    children.
    """

    name: str
    links: tuple[Link, ...]
    joints: tuple[TreeJoint, ...]
    base: str = "pelvis"
    """Root link."""
    floating: bool = True
    """Whether the root link moves freely; it stands still otherwise."""
    height: float = 0.0
    """Height of a fixed root link above the floor [m]."""
    limbs: tuple[str, ...] = ("left", "right")
    """Names of the copies of the limb; one empty name where the robot is written out whole."""
    hyperleg: bool = True
    """Whether it is HyperLeg's: a pelvis, two legs, feet with heel, ball and perhaps toe."""

    @property
    def mass(self) -> float:
        """Mass of the whole robot [kg]."""
        return mass_of(self.links)

    @property
    def moving(self) -> tuple[TreeJoint, ...]:
        """Joints that move, in order."""
        return tuple(j for j in self.joints if not j.fixed)

    def link(self, name: str) -> Link:
        """Find a link by its name.

        Args:
            name: of the link.

        Returns:
            The link.

        Raises:
            StopIteration: there is none of this name.
        """
        return next(link for link in self.links if link.name == name)


def mass_of(links: Iterable[Link]) -> float:
    """Add the masses of links from left to right.

    `sum` compensates rounding from Python 3.12 on, so it would not give the same bytes everywhere.

    Args:
        links: the links.

    Returns:
        Their mass [kg].
    """
    return functools.reduce(operator.add, (link.mass for link in links), 0.0)
