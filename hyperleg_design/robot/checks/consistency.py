"""Whether the numbers of a design fit together: geometry, ranges, masses, transmission."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot import masses, motors, transmission
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
    _check_name(design, where)
    _check_batch(design, where)

    def require(good: Any, field: str, remedy: str) -> None:
        if np.all(good):
            return
        value = design[field]
        if (
            np.ndim(good) == 1
            and isinstance(value, np.ndarray)
            and value.shape[:1] == np.shape(good)
        ):
            value = value[np.argmin(good)]
        raise InputError(
            where,
            field,
            value.tolist() if isinstance(value, np.ndarray) else value,
            remedy,
            bad=~np.asarray(good),
        )

    for name in JOINTS:
        joint = getattr(design.joints, name)
        require(
            joint.lower_deg < joint.upper_deg,
            f"joints.{name}.lower_deg",
            "must lie below upper_deg; the range is reversed or empty",
        )
        inside = (joint.lower_deg <= joint.default_deg) & (joint.default_deg <= joint.upper_deg)
        require(inside, f"joints.{name}.default_deg", "must lie within lower_deg .. upper_deg")

    leg = leg_length(design)
    foot = design.foot.heel_length + design.foot.ball_length + design.toe.length
    require(
        foot < leg, "foot.ball_length", "makes the foot longer than the leg; lengths are metres"
    )
    require(
        design.foot.ankle_height < design.shank.length,
        "foot.ankle_height",
        "must be below the shank's length",
    )
    require(
        design.toe.axis_height <= design.foot.ankle_height,
        "toe.axis_height",
        "must not lie above the ankle axis (foot.ankle_height)",
    )
    require(
        design.foot.width < 2 * design.hip.spacing,
        "foot.width",
        "makes the feet overlap; it must be below twice hip.spacing",
    )
    require(
        design.contact.pad_radius <= design.toe.axis_height + design.foot.width,
        "contact.pad_radius",
        "is larger than the foot",
    )
    carriers = design.hip.yaw_carrier_mass + design.hip.roll_carrier_mass
    require(
        carriers < design.thigh.mass,
        "thigh.mass",
        "must exceed the hip carriers counted in it (hip.yaw_carrier_mass + hip.roll_carrier_mass)",
    )
    require(
        design.foot.cross_mass < design.foot.mass,
        "foot.cross_mass",
        "must be below foot.mass, in which it is counted",
    )
    if design.toe.joint != "locked":
        require(
            np.asarray(design.toe.mass) > 1e-6,
            "toe.mass",
            "must be positive where the toe moves; a toe without mass needs toe.joint: locked",
        )
    if design.toe.joint == "active" and not design.actuators.toe_installed:
        raise InputError(
            where,
            "actuators.toe_installed",
            False,
            "an active toe needs its motor; set toe.joint: locked",
        )
    if design.toe.joint == "passive" and design.actuators.toe_installed:
        raise InputError(
            where,
            "actuators.toe_installed",
            True,
            "a passive toe has a spring and no motor; set it to false",
        )

    _check_inertia(design, where)

    motors.check_names(design, where)
    masses.check_masses(design, where)
    transmission.check_invertible(design, where)


def _check_name(design: HyperLeg, where: str) -> None:
    """Names become file names, and names in URDF and MJCF."""
    if not isinstance(design.name, str) or not re.fullmatch(
        r"[A-Za-z0-9][A-Za-z0-9_.-]{0,99}", design.name
    ):
        raise InputError(
            where,
            "name",
            design.name,
            "expects a letter or digit, then letters, digits, dots, dashes or underscores, 100 at "
            "most",
        )


def _check_batch(design: HyperLeg, where: str) -> None:
    sizes = {path: size for path, size in design.batch_sizes().items() if size > 1}
    if len(set(sizes.values())) > 1:
        first, last = min(sizes, key=lambda p: sizes[p]), max(sizes, key=lambda p: sizes[p])
        raise InputError(
            where,
            last,
            sizes[last],
            f"is the length of its batch, but that of {first} is {sizes[first]}; make them equal",
        )


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
        good = squared[..., 2] <= squared[..., 0] + squared[..., 1] + 1e-12
        if not np.all(good):
            value = np.asarray(design[field])
            shown = value if value.ndim == 1 else value[np.argmin(good)]
            remedy = (
                "no body has these: the largest squared radius must not exceed the sum of "
                "the "
                "other two"
            )
            raise InputError(where, field, shown.tolist(), remedy, bad=~good)
