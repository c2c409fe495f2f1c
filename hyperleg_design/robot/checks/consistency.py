"""Whether the numbers of a design fit together: geometry, ranges, masses, transmission."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot import masses, motors, transmission
from hyperleg_design.robot.checks.refusal import check_batch, check_name, refuse
from hyperleg_design.robot.names import JOINTS

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.hyperleg import HyperLeg


def check_design(design: HyperLeg) -> None:
    """Check that the numbers of a design fit together, and report the first that does not.

    Args:
        design: a robot or batch.

    Raises:
        InputError: names the field, its value and what would be right.
    """
    where = str(design.source or design.name)
    check_name(design, where)
    check_batch(design, where)
    for field, good, remedy in _requirements(design):
        refuse(where, field, good, design[field], remedy)
    _check_toe_motor(design, where)
    _check_inertia(design, where)
    motors.check_names(design, where)
    masses.check_masses(design, where)
    transmission.check_invertible(design, where)


def _requirements(design: HyperLeg) -> Iterator[tuple[str, Any, str]]:
    """Fields in the order of the checks, whether each is good, and what would be right."""
    for name in JOINTS:
        joint = getattr(design.joints, name)
        yield (
            f"joints.{name}.lower_deg",
            joint.lower_deg < joint.upper_deg,
            "must lie below upper_deg; the range is reversed or empty",
        )
        yield (
            f"joints.{name}.default_deg",
            (joint.lower_deg <= joint.default_deg) & (joint.default_deg <= joint.upper_deg),
            "must lie within lower_deg .. upper_deg",
        )
    hip, foot, toe = design.hip, design.foot, design.toe
    yield (
        "foot.ball_length",
        foot.heel_length + foot.ball_length + toe.length < leg_length(design),
        "makes the foot longer than the leg; lengths are metres",
    )
    yield (
        "foot.ankle_height",
        foot.ankle_height < design.shank.length,
        "must be below the shank's length",
    )
    yield (
        "toe.axis_height",
        toe.axis_height <= foot.ankle_height,
        "must not lie above the ankle axis (foot.ankle_height)",
    )
    yield (
        "foot.width",
        foot.width < 2 * hip.spacing,
        "makes the feet overlap; it must be below twice hip.spacing",
    )
    yield (
        "contact.pad_radius",
        design.contact.pad_radius <= toe.axis_height + foot.width,
        "is larger than the foot",
    )
    yield (
        "thigh.mass",
        hip.yaw_carrier_mass + hip.roll_carrier_mass < design.thigh.mass,
        "must exceed the hip carriers counted in it (hip.yaw_carrier_mass + hip.roll_carrier_mass)",
    )
    yield (
        "foot.cross_mass",
        foot.cross_mass < foot.mass,
        "must be below foot.mass, in which it is counted",
    )
    if toe.joint != "locked":
        yield (
            "toe.mass",
            np.asarray(toe.mass) > 1e-6,
            "must be positive where the toe moves; a toe without mass needs toe.joint: locked",
        )


def _check_toe_motor(design: HyperLeg, where: str) -> None:
    """An active toe has a motor, and a passive one has none."""
    installed = bool(design.actuators.toe_installed)
    remedies = {
        ("active", False): "an active toe needs its motor; set toe.joint: locked",
        ("passive", True): "a passive toe has a spring and no motor; set it to false",
    }
    if remedy := remedies.get((str(design.toe.joint), installed)):
        raise InputError(where, "actuators.toe_installed", installed, remedy)


def leg_length(design: HyperLeg) -> Any:
    """Compute the distance from the hip-pitch axis to the sole of a straight leg.

    Args:
        design: a robot or batch.

    Returns:
        The length [m], `(...)`.
    """
    return design.thigh.length + design.shank.length + design.foot.ankle_height


def _check_inertia(design: HyperLeg, where: str) -> None:
    """Radii of gyration obey the triangle inequality, as those of any body do."""
    for field in (
        "pelvis.gyration",
        "thigh.gyration_fraction",
        "shank.gyration_fraction",
        "foot.gyration",
        "toe.gyration",
    ):
        squared = np.sort(np.asarray(design[field]) ** 2, axis=-1)
        refuse(
            where,
            field,
            squared[..., 2] <= squared[..., 0] + squared[..., 1] + 1e-12,
            design[field],
            "no body has these: the largest squared radius must not exceed the sum of the other "
            "two",
        )
