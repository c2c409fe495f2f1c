"""Joint torques of two reference postures, in closed form, with each design's own masses and
lengths.

Sagittal statics: link pitches theta (positive turns the front down) are sums of the joint angles of
hip pitch, knee, ankle pitch and toe from an upright trunk; a link of length L hangs at (-L sin
theta, -L cos theta) below its upper joint. With vertical ground force F at x_c and links of mass
m_i at x_i behind a joint at x_j, that joint holds

    torque_j = F (x_c - x_j) - sum over links behind j of m_i g (x_i - x_j)

where F counts only for joints above the link that it acts on: flat on the ground the toe is not
loaded. Hip yaw, hip roll and ankle roll carry nothing in this plane. Postures and loads are ours
(assumed), the same for all designs:

- squat: both feet flat, knee at 90 deg, trunk upright, half the weight a leg; the shank leans so
  that the robot's centre of mass stands over the middle between heel and toe axis, which makes it
  an equilibrium.
- push-off: one leg carries 1.1 times the weight, inertia forces neglected, hip 10 deg behind, knee
  10 deg, ankle 10 deg plantar flexed, so the foot stands 30 deg steep; an active toe lies flat (-30
  deg) and is loaded at its middle, a locked one leaves the tip as the only contact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.robot.mass.bodies import Inertial
from hyperleg_design.robot.masses import mass_table
from hyperleg_design.robot.models import GRAVITY
from hyperleg_design.robot.names import JOINTS
from hyperleg_design.robot.transmission import joint_names

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hyperleg_design.robot.design import Design

SQUAT_KNEE = np.deg2rad(90.0)
"""Knee angle of the squat [rad], assumed."""

PUSH_OFF = np.deg2rad([10.0, 10.0, 10.0, -30.0])
"""Hip pitch, knee, ankle pitch and toe at push-off [rad], assumed; a locked toe stays at zero."""

PUSH_OFF_LOAD = 1.1
"""Vertical ground force at push-off over the weight [-], assumed: the second peak of a human
walk."""

PUSH_OFF_ON_TOE = 0.5
"""Where along an active toe the push-off load stands [-], assumed."""


@dataclass(frozen=True, eq=False)
class StaticLoad:
    """A posture, its ground force a leg, and the joint torques that hold it."""

    angles: np.ndarray
    """Hip pitch, knee, ankle pitch, toe [rad], `(..., 4)`."""
    force: np.ndarray
    """Vertical ground force on the leg [N], `(...)`."""
    pressure_point: np.ndarray
    """Where it acts, ahead of the hip axis [m], `(...)`."""
    torque: np.ndarray
    """Torques of the joints that move, in their order [Nm], `(..., joints)`."""


def squat(design: Design, inertials: Mapping[str, Inertial]) -> StaticLoad:
    """Compute the joint torques of the squat in closed form.

    The robot's centre of mass is `a sin(lean) + b cos(lean) + c` ahead of the ankle for a knee at a
    fixed angle, so the lean of the shank follows in closed form.

    Args:
        design: a robot or batch.
        inertials: of its left leg, by link.

    Returns:
        Angles and torques; NaN where no lean brings the centre of mass over the foot.
    """
    total = np.asarray(mass_table(design).total, float)
    thigh, shank = np.asarray(design.thigh.length, float), np.asarray(design.shank.length, float)
    pelvis = inertials["pelvis"]
    # masses with the lean alpha of the shank and the pitch alpha - knee of the thigh: x of a point
    # (px, -pz) of a link pitched by theta is px cos(theta) - pz sin(theta), measured from its upper
    # joint
    sine, cosine, constant = np.zeros(total.shape), np.zeros(total.shape), np.zeros(total.shape)
    knee_sin, knee_cos = np.sin(SQUAT_KNEE), np.cos(SQUAT_KNEE)

    def add_shank(mass: np.ndarray, ahead: np.ndarray, down: np.ndarray) -> None:
        # from the ankle: (shank - down) sin(alpha) + ahead cos(alpha)
        nonlocal sine, cosine
        sine = sine + mass * (shank - down)
        cosine = cosine + mass * ahead

    def add_thigh(mass: np.ndarray, ahead: np.ndarray, down: np.ndarray) -> None:
        # from the knee: (thigh - down) sin(alpha - knee) + ahead cos(alpha - knee)
        nonlocal sine, cosine
        reach = thigh - down
        sine = sine + mass * (shank + reach * knee_cos + ahead * knee_sin)
        cosine = cosine + mass * (-reach * knee_sin + ahead * knee_cos)

    for name in ("ankle_cross", "foot", "toe_plate"):
        link = inertials[name]
        offset = np.asarray(design.foot.ball_length) if name == "toe_plate" else 0.0
        constant = constant + 2 * link.mass * (link.com[..., 0] + offset)
    add_shank(
        2 * inertials["shank"].mass, inertials["shank"].com[..., 0], -inertials["shank"].com[..., 2]
    )
    add_thigh(
        2 * inertials["thigh"].mass, inertials["thigh"].com[..., 0], -inertials["thigh"].com[..., 2]
    )
    for carrier in ("hip_yaw_carrier", "hip_roll_carrier"):
        # in the hip, upright like the trunk (their own centres of mass lie on the hip axis)
        add_thigh(2 * inertials[carrier].mass, np.zeros(()), np.zeros(()))
    add_thigh(pelvis.mass, np.zeros(()), np.zeros(()))
    constant = constant + pelvis.mass * pelvis.com[..., 0]

    middle = (np.asarray(design.foot.ball_length) - np.asarray(design.foot.heel_length)) / 2
    radius = np.hypot(sine, cosine)
    with np.errstate(invalid="ignore"):
        lean = np.arcsin((total * middle - constant) / radius) - np.arctan2(cosine, sine)
    angles = np.stack(
        [lean - SQUAT_KNEE, np.full(lean.shape, SQUAT_KNEE), -lean, np.zeros(lean.shape)], -1
    )
    force = total * GRAVITY / 2
    pressure = _points(design, angles)["ankle"] + middle
    return StaticLoad(
        angles,
        force,
        pressure,
        holding_torque(design, inertials, angles, force, pressure, on_toe=False),
    )


def push_off(design: Design, inertials: Mapping[str, Inertial]) -> StaticLoad:
    """Compute the joint torques of the push-off in closed form.

    Args:
        design: a robot or batch.
        inertials: of its left leg, by link.

    Returns:
        Angles and torques.
    """
    total = np.asarray(mass_table(design).total, float)
    active = design.toe.joint == "active"
    angles = np.broadcast_to(
        PUSH_OFF * (1.0, 1.0, 1.0, 1.0 if active else 0.0), (*design.batch_shape, 4)
    )
    points = _points(design, angles)
    pitch = angles.sum(-1)
    reach = np.asarray(design.toe.length) * (PUSH_OFF_ON_TOE if active else 1.0)
    # along the toe from its axis, on the sole
    pressure = (
        points["toe"] + reach * np.cos(pitch) - np.asarray(design.toe.axis_height) * np.sin(pitch)
    )
    force = PUSH_OFF_LOAD * total * GRAVITY
    return StaticLoad(
        angles,
        force,
        pressure,
        holding_torque(design, inertials, angles, force, pressure, on_toe=True),
    )


def holding_torque(
    design: Design,
    inertials: Mapping[str, Inertial],
    angles: np.ndarray,
    force: np.ndarray,
    pressure_point: np.ndarray,
    *,
    on_toe: bool,
) -> np.ndarray:
    """Compute the torques of the joints that move, by the equation in the module's docstring.

    Args:
        design: a robot or batch.
        inertials: of its left leg.
        angles: hip pitch, knee, ankle pitch, toe [rad], `(..., 4)`.
        force: vertical ground force on the leg [N].
        pressure_point: where it acts, ahead of the hip axis [m].
        on_toe: whether the force acts on the toe; on the foot otherwise.

    Returns:
        The torques [Nm], `(..., joints)`.
    """
    points = _points(design, angles)
    pitch = np.cumsum(angles, -1)
    links = (
        ("thigh", "hip", 0),
        ("shank", "knee", 1),
        ("ankle_cross", "ankle", 2),
        ("foot", "ankle", 2),
        ("toe_plate", "toe", 3),
    )
    # of each link: mass, and where its weight acts
    placed = []
    for name, origin, level in links:
        com = inertials[name].com
        x = (
            points[origin]
            + com[..., 0] * np.cos(pitch[..., level])
            + com[..., 2] * np.sin(pitch[..., level])
        )
        placed.append((inertials[name].mass, x))
    torque = [np.zeros(())] * len(JOINTS)
    # the cross turns with the ankle's pitch, so it is behind that joint; its own centre is on the
    # axis
    for column, origin, first in ((2, "hip", 0), (3, "knee", 1), (4, "ankle", 2), (6, "toe", 4)):
        behind = sum(
            (mass * GRAVITY * (x - points[origin]) for mass, x in placed[first:]),
            start=np.zeros(()),
        )
        pushed = 0.0 if origin == "toe" and not on_toe else force
        torque[column] = pushed * (pressure_point - points[origin]) - behind
    return np.stack(np.broadcast_arrays(*torque), -1)[..., : len(joint_names(design))]


def _points(design: Design, angles: np.ndarray) -> dict[str, np.ndarray]:
    """How far the joint axes lie ahead of the hip's [m], each `(...)`."""
    theta = np.cumsum(angles, -1)
    knee = -np.asarray(design.thigh.length) * np.sin(theta[..., 0])
    ankle = knee - np.asarray(design.shank.length) * np.sin(theta[..., 1])
    drop = np.asarray(design.foot.ankle_height) - np.asarray(design.toe.axis_height)
    toe = (
        ankle
        + np.asarray(design.foot.ball_length) * np.cos(theta[..., 2])
        - drop * np.sin(theta[..., 2])
    )
    return {"hip": np.zeros(knee.shape), "knee": knee, "ankle": ankle, "toe": toe}
