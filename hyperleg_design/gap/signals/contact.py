"""Where and how a robot meets the ground in a log: forces of its pads, and which feet touch, or
may.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.errors import InputError, meant
from hyperleg_design.gap.logs.columns import CONTACT, force_names
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.base import BaseMotion
from hyperleg_design.gap.model.pads import pad_points
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.channels import resampled
from hyperleg_design.gap.signals.nominal_ground import floor_height

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

TOUCHING_FORCE = 2.0
"""Force from which a foot touches [N]; assumed, above the noise of foot sensors."""
TOUCHING_HEIGHT = 0.03
"""Height over the lowest foot up to which a foot may touch, where no force is logged [m]; assumed,
a low swing."""

FLIGHT = 0.1
"""Force that the motion needs from outside, over the weight, below which no foot touches;
assumed."""


@dataclass(frozen=True, eq=False)
class Ground:
    """What a log knows of the ground, `t` ticks."""

    subject: Subject
    foot_force: np.ndarray | None = None
    """World frame `(t, f, 3)` [N]."""
    pad_force: np.ndarray | None = None
    """World frame `(t, P, 3)` [N]; NaN on the pads of a foot while it touches and the place of its
    force is unknown."""
    touching: np.ndarray | None = None
    """Feet that touch, or may `(t, f)`; None of a fixed base without a floor within reach, or
    contact forces."""

    @cached_property
    def unknown(self) -> tuple[np.ndarray, np.ndarray]:
        """Feet that touch, or may, with an unknown force, and those whose force is known, but not
        where under the foot it acts `(t, f)`; `(1, f)` of a fixed base without forces.
        """
        feet = len(self.subject.feet)
        if self.touching is None or self.pad_force is None or self.foot_force is None:
            none = np.zeros((1, feet), bool)
            return none if self.touching is None else self.touching, none
        lost, foot_of = ~np.isfinite(self.pad_force).all(-1), self.subject.pad_foot
        unknown = np.stack([lost[:, foot_of == foot].any(1) for foot in range(feet)], 1)
        force = np.isfinite(self.foot_force).all(-1)
        return unknown & ~force, unknown & force

    @cached_property
    def pushing(self) -> np.ndarray | None:
        """Force on each pad, or its equal share of what its foot feels where nobody measured where
        that acts; 0 where it is unknown. In the world `(t, P, 3)` [N]; None without contact forces.
        """
        if self.pad_force is None or self.foot_force is None:
            return None
        foot_of = self.subject.pad_foot
        shares = self.foot_force[:, foot_of] / np.bincount(foot_of)[foot_of][:, None]
        known = np.isfinite(self.pad_force).all(-1, keepdims=True)
        return np.nan_to_num(np.where(known, self.pad_force, shares))


def contacts(
    log: Log,
    subject: Subject,
    ticks: np.ndarray,
    position: np.ndarray,
    base: BaseMotion | None,
    needed: np.ndarray | None = None,
) -> Ground:
    """Compute the contact of one log with the ground.

    Forces are logged by pad, or by foot, which is as good where a foot has one pad. A foot of whose
    force a log tells nothing may touch where it is near the lowest foot, and carries nothing
    elsewhere: shapes on hips, which many files have, are no feet.

    Args:
        log: of this subject.
        subject: the robot.
        ticks: `(t,)` [s].
        position: of the joints `(t, n)` [rad].
        base: of a floating base.
        needed: force that the motion of a floating base needs from outside `(t, 3)` [N]; in flight
            none.

    Returns:
        Forces of pads, and which feet touch or may touch.

    Raises:
        InputError: a force on a foot that the robot does not have.
    """
    feet, pads = subject.feet, subject.pads
    pad_names = [p.name for p in pads]
    named = [_logged_as(subject, foot, log.feet) for foot in range(len(feet))]
    for name in log.feet:
        if name not in (*feet, *named, *pad_names):
            remedy = f"is no foot of this robot; {meant(name, [*feet, *pad_names])}"
            raise InputError(log.name, "contact_force", name, remedy)
    if not feet:
        return Ground(subject)
    if not log.feet:
        touching = (
            _on_floor(subject, position) if base is None else _may_touch(subject, position, base)
        )
        weight = subject.tree.mass * np.linalg.norm(subject.gravity)
        if touching is not None and needed is not None:
            touching &= (np.linalg.norm(needed, axis=1) > FLIGHT * weight)[:, None]
        return Ground(subject, touching=touching)

    def force(names: list[str] | tuple[str, ...]) -> np.ndarray:
        known = log.stack(CONTACT, force_names(names))
        return resampled(log.time, known, ticks).reshape(len(ticks), -1, 3)

    on_pads, on_feet = force(pad_names), force(named)
    unlogged = _feet_without_force(subject, named, log.feet)
    if unlogged and base is not None:
        near = _may_touch(subject, position, base)[:, unlogged, None]
        on_feet[:, unlogged] = np.where(near, np.nan, 0.0)
    total = np.stack(
        [np.where(subject.pad_foot[:, None] == f, on_pads, 0.0).sum(1) for f in range(len(feet))], 1
    )
    total = np.where(np.isfinite(total), total, on_feet)
    touching = np.linalg.norm(total, axis=-1) > TOUCHING_FORCE
    touching |= ~np.isfinite(total).all(-1)
    for foot in range(len(feet)):
        own = np.flatnonzero(subject.pad_foot == foot)
        missing = ~np.isfinite(on_pads[:, own]).all((1, 2))
        shared = (
            on_feet[:, foot] if len(own) == 1 else np.where(touching[:, foot, None], np.nan, 0.0)
        )
        on_pads[:, own] = np.where(missing[:, None, None], shared[:, None], on_pads[:, own])
    return Ground(subject, total, on_pads, touching)


def unknown_rows(ground: Ground, margin: int) -> np.ndarray:
    """Find the joint rows that an unknown force of the ground reaches.

    Args:
        ground: contact of the log.
        margin: ticks by which the rows are widened.

    Returns:
        `(t, n)`; `(1, n)` where there is none.
    """
    subject, unknown = ground.subject, np.logical_or(*ground.unknown)
    out = np.zeros((len(unknown), len(subject.joints)), bool)
    for foot, wide in enumerate(widened(unknown, margin).T):
        out[:, foot_chain(subject, foot)] |= wide[:, None]
    return out


def widened(ticks: np.ndarray, margin: int) -> np.ndarray:
    """Add the ticks around some.

    Args:
        ticks: `(t, ...)` of bool.
        margin: how many to either side.

    Returns:
        The same, widened.
    """
    from scipy.ndimage import maximum_filter1d

    return np.asarray(maximum_filter1d(ticks.astype(np.uint8), 2 * margin + 1, axis=0) > 0)


def known_of_base(ground: Ground) -> np.ndarray:
    """Find the rows of a floating base that known forces of the ground explain: all where all is
    known, those of forces where nobody knows where these act.

    Args:
        ground: contact of the log.

    Returns:
        `(t, 6)`, or `(1, 6)`.
    """
    force, place = (feet.any(1, keepdims=True) for feet in ground.unknown)
    return np.repeat(np.concatenate([~force, ~force & ~place], 1), 3, axis=1)


def foot_chain(subject: Subject, foot: int) -> list[int]:
    """List the joints between the base and a foot.

    Args:
        subject: the robot.
        foot: index of the foot.

    Returns:
        Indices of joints.
    """
    joints: set[int] = set()
    for pad in subject.pads:
        if pad.foot == foot:
            joints |= set(subject.tree.chain_to(pad.link))
    return sorted(joints)


def _logged_as(subject: Subject, foot: int, logged: Collection[str]) -> str:
    """Name under which a log has the force on a foot: its own, or that of its only shape, whose
    corners or ends are its pads.
    """
    name = subject.feet[foot]
    shapes = {p.name.rpartition("_")[0] for p in subject.pads if p.foot == foot}
    (shape,) = shapes if len(shapes) == 1 else (name,)
    return shape if name not in logged and shape in logged else name


def _feet_without_force(
    subject: Subject, named: Sequence[str], logged: Collection[str]
) -> list[int]:
    """Indices of the feet for which a log holds neither a force of their own nor one of a pad."""
    return [
        index
        for index, foot in enumerate(named)
        if foot not in logged
        and not any(p.foot == index and p.name in logged for p in subject.pads)
    ]


def _may_touch(subject: Subject, position: np.ndarray, base: BaseMotion) -> np.ndarray:
    """Feet near the lowest one, by forward kinematics."""
    lowest = _lowest(subject, position, base.rotation)
    return np.asarray(lowest < lowest.min(1, keepdims=True) + TOUCHING_HEIGHT)


def _on_floor(subject: Subject, position: np.ndarray) -> np.ndarray | None:
    """Feet of a robot on a stand or a rail that are near the floor of its model; None where none is
    ever, or where one is far below: then the floor lies elsewhere.
    """
    floor = floor_height(subject.model)
    if floor is None:
        return None
    height = _lowest(subject, position, np.broadcast_to(np.eye(3), (len(position), 3, 3))) - floor
    near = np.abs(height) < TOUCHING_HEIGHT
    return near if near.any() and height.min() > -2 * TOUCHING_HEIGHT else None


def _lowest(subject: Subject, position: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """Height of the lowest point of each foot over the base's origin `(t, f)` [m]."""
    points = pad_points(subject, position, rotation)
    height = np.einsum("ti,tpi->tp", rotation[:, 2], points)
    feet = range(len(subject.feet))
    return np.stack([height[:, subject.pad_foot == f].min(1) for f in feet], 1)
