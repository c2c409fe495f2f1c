"""Mass, centre of mass and inertia of every link, batched over designs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot import masses
from hyperleg_design.robot.mass.bodies import Inertial, shifted

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.hyperleg import HyperLeg

LEG_LINKS = (
    "hip_yaw_carrier",
    "hip_roll_carrier",
    "thigh",
    "shank",
    "ankle_cross",
    "foot",
    "toe_plate",
)
"""Links of a leg, one behind each joint of `names.JOINTS`."""


def inertials(design: HyperLeg, side: float = 1.0) -> dict[str, Inertial]:
    """Inertials of the pelvis and of the links of one leg.

    Args:
        design: a robot or batch.
        side: 1 for the left leg, -1 for the right, which mirrors y.

    Returns:
        `pelvis` and each of `LEG_LINKS`. A locked toe is still its own link, fixed to the foot.

    Raises:
        InputError: the housed actuators leave a link with an inertia that no body has.
    """
    table = masses.mass_table(design)
    carrier = np.asarray(design.hip.carrier_gyration, float)[..., None] * np.ones(3)
    foot_link = table.foot - design.foot.cross_mass
    zero = np.zeros(3)
    links = {
        "pelvis": _with_housed(
            design,
            "pelvis",
            table,
            _declared(
                table.pelvis - _change(table, "pelvis", 2),
                design.pelvis.com,
                design.pelvis.gyration,
            ),
        ),
        "hip_yaw_carrier": _declared(design.hip.yaw_carrier_mass, zero, carrier),
        "hip_roll_carrier": _declared(design.hip.roll_carrier_mass, zero, carrier),
    }
    carriers = design.hip.yaw_carrier_mass + design.hip.roll_carrier_mass
    for name, carrier_mass in (("thigh", carriers), ("shank", 0.0)):
        part = getattr(design, name)
        com = _vector(part.com_forward, side * part.com_outward, -part.com_fraction * part.length)
        gyration = np.asarray(part.gyration_fraction) * np.asarray(part.length, float)[..., None]
        body = _declared(
            getattr(table, name) - _change(table, name, 1) - carrier_mass, com, gyration
        )
        links[name] = _with_housed(design, name, table, body)
    mirror = np.array([1.0, side, 1.0])
    links["ankle_cross"] = _declared(
        design.foot.cross_mass,
        zero,
        np.asarray(design.foot.cross_gyration, float)[..., None] * np.ones(3),
    )
    links["foot"] = _declared(foot_link, design.foot.com * mirror, design.foot.gyration)
    links["toe_plate"] = _declared(table.toe, design.toe.com * mirror, design.toe.gyration)
    return links


def _vector(*parts: Any) -> np.ndarray:
    return np.stack(np.broadcast_arrays(*(np.asarray(p, float) for p in parts)), -1)


def _declared(mass: Any, com: Any, gyration: Any) -> Inertial:
    mass = np.asarray(mass, float)
    diagonal = mass[..., None] * np.asarray(gyration, float) ** 2
    com = np.asarray(com, float)
    return Inertial(
        mass,
        np.broadcast_to(com, np.broadcast_shapes(com.shape, diagonal.shape)),
        diagonal[..., None] * np.eye(3),
    )


def _change(table: masses.MassTable, segment: str, legs: int) -> Any:
    return sum((h.change * legs for h in table.housed if h.segment == segment), start=np.zeros(()))


def _with_housed(
    design: HyperLeg, segment: str, table: masses.MassTable, body: Inertial
) -> Inertial:
    """The body with the changes of housed actuators added as points; the same body where nothing
    changed.
    """
    points: list[tuple[Any, np.ndarray]] = []
    for housed in table.housed:
        if housed.segment != segment or not np.any(housed.change):
            continue
        if segment == "pelvis":
            half = np.asarray(design.hip.spacing, float) / 2
            points += [
                (housed.change, _vector(0 * half, sign * half, 0 * half)) for sign in (1, -1)
            ]
        else:
            depth = housed.fraction * getattr(design, segment).length
            points.append((housed.change, _vector(0.0 * depth, 0.0 * depth, -depth)))
    if not points:
        return body
    mass = body.mass + sum(np.asarray(m) for m, _ in points)
    moment = body.mass[..., None] * body.com + sum(np.asarray(m)[..., None] * p for m, p in points)
    com = moment / mass[..., None]
    inertia = (
        body.inertia
        + shifted(body.mass, body.com - com)
        + sum(shifted(np.asarray(m), p - com) for m, p in points)
    )
    principal = np.linalg.eigvalsh(inertia)
    bad = (principal[..., 0] <= 0) | (
        principal[..., 2] > principal[..., 0] + principal[..., 1] + 1e-12
    )
    if np.any(bad):
        field = f"{segment}.gyration_fraction" if segment != "pelvis" else "pelvis.gyration"
        remedy = (
            "is too small for the actuators that leave this segment: its inertia would be no body's"
        )
        raise InputError(design.source or design.name, field, None, remedy, bad=bad)
    # a body that nothing joined or left keeps its declared numbers to the bit, whatever else is in
    # the batch
    changed = np.any(np.stack(np.broadcast_arrays(*(np.asarray(m) != 0 for m, _ in points))), 0)
    return Inertial(
        mass,
        np.where(changed[..., None], com, body.com),
        np.where(changed[..., None, None], inertia, body.inertia),
    )
