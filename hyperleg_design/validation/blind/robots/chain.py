"""Robots that the rigs hold: a tree of hinges in Pinocchio, its motors and what its data sheet says
of them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import pinocchio

GRAVITY = np.array([0.0, 0.0, -9.81])


@dataclass(frozen=True, eq=False)
class Link:
    """A moving body with its joint."""

    name: str
    joint: str
    parent: int
    """Index of the moving body that carries it; -1 for the fixed base."""
    rotation: np.ndarray
    """Parent from joint frame `(3, 3)`."""
    place: np.ndarray
    """Of the joint frame in the parent's `(3,)` [m]."""
    axis: np.ndarray
    """In the joint frame `(3,)`."""
    mass: float
    """[kg]"""
    com: np.ndarray
    """In the joint frame `(3,)` [m]."""
    inertia: np.ndarray
    """About the centre of mass, axes of the joint frame `(3, 3)` [kg m^2]."""


@dataclass(frozen=True, eq=False)
class Chain:
    """A fixed-base robot with `n` joints and `m` motors, all values nominal."""

    name: str
    links: tuple[Link, ...]
    motors: tuple[str, ...]
    joint_from_motor: np.ndarray
    """M `(n, m)`: joint torque over motor torque; motor velocity is M^T joint velocity."""
    rotor_inertia: np.ndarray
    """At the motors `(m,)` [kg m^2]."""
    coulomb: np.ndarray
    """At the joints `(n,)` [Nm]."""
    viscous: np.ndarray
    """At the joints `(n,)` [Nms/rad]."""
    stiffness: np.ndarray
    """Gain of the joint controller `(n,)` [Nm/rad]."""
    damping: np.ndarray
    """Gain of the joint controller `(n,)` [Nms/rad]."""
    peak_torque: np.ndarray
    """Of the motors `(m,)` [Nm]."""
    stall_torque: np.ndarray
    """Of the motors at the nominal voltage, extrapolated `(m,)` [Nm]."""
    no_load_speed: np.ndarray
    """Of the motors at the nominal voltage `(m,)` [rad/s]."""
    torque_constant: np.ndarray
    """Of the motors `(m,)` [Nm/A]."""
    low: np.ndarray
    high: np.ndarray
    """Limits of the joints `(n,)` [rad]."""
    rest: np.ndarray
    """Middle posture that motions start from `(n,)` [rad]."""
    voltage: float
    """Nominal supply [V]."""
    mjcf: str | None
    """Text of its MJCF, where that is how a user would name it; None for a design."""
    robot: str
    """Name or file under which logs and the diagnosis know it."""

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints, from the base outward."""
        return tuple(link.joint for link in self.links)

    @property
    def diagonal(self) -> bool:
        """Whether motors and joints are one to one."""
        n, m = self.joint_from_motor.shape
        return n == m and not np.any(
            self.joint_from_motor - np.diag(np.diag(self.joint_from_motor))
        )

    def with_link(self, name: str, **values: Any) -> Chain:
        """Copy with other values of one link.

        Args:
            name: of the link.
            values: of the link's fields.

        Returns:
            The copy.
        """
        return replace(
            self,
            links=tuple(
                replace(link, **values) if link.name == name else link for link in self.links
            ),
        )

    def with_point_mass(self, name: str, mass: float, com: np.ndarray) -> Chain:
        """Copy with a point mass [kg] fixed to a link at `com` of its joint frame [m].

        Args:
            name: of the link.
            mass: [kg].
            com: in the joint's frame `(3,)` [m].

        Returns:
            The copy.
        """
        link = next(link for link in self.links if link.name == name)
        total = link.mass + mass
        middle = (link.mass * link.com + mass * np.asarray(com)) / total
        inertia = (
            link.inertia
            + steiner(link.mass, link.com - middle)
            + steiner(mass, np.asarray(com) - middle)
        )
        return self.with_link(name, mass=total, com=middle, inertia=inertia)

    def pinocchio(self, gravity: np.ndarray = GRAVITY) -> pinocchio.Model:
        """Its rigid bodies, without rotors.

        Args:
            gravity: `(3,)` [m/s^2].

        Returns:
            The model.
        """
        import pinocchio as pin

        model: Any = pin.Model()
        model.name = self.name
        ids: list[int] = []
        for link in self.links:
            parent = ids[link.parent] if link.parent >= 0 else 0
            ids.append(
                model.addJoint(
                    parent,
                    pin.JointModelRevoluteUnaligned(link.axis),
                    pin.SE3(link.rotation, link.place),
                    link.joint,
                )
            )
            model.appendBodyToJoint(
                ids[-1], pin.Inertia(link.mass, link.com, link.inertia), pin.SE3.Identity()
            )
        model.gravity.linear = np.asarray(gravity, float)
        return model


def steiner(mass: float, offset: np.ndarray) -> np.ndarray:
    """Inertia of a point mass about a point `offset` away `(3, 3)` [kg m^2].

    Args:
        mass: [kg].
        offset: `(3,)` [m].

    Returns:
        The inertia `(3, 3)` [kg m^2].
    """
    return mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))
