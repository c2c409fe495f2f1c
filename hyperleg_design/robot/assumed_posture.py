"""The default posture of an imported robot, as far as nobody states it."""

from __future__ import annotations

import numpy as np

from hyperleg_design.robot.parameters.values import Origin, some
from hyperleg_design.robot.trees.tree_design import TreeDesign

NEAREST = "the angle of the range nearest to zero"
"""Source of the default posture of a joint for which the actuation file states none."""


def nearest_to_zero(lower: float, upper: float) -> float:
    """Find the angle of a range that is nearest to zero.

    Args:
        lower: end of the range [deg].
        upper: end of the range [deg].

    Returns:
        The angle, away from the end by less than 0.01 degrees where that gives it two decimals
        [deg].
    """
    nearest = float(np.clip(0.0, lower, upper))
    plain = float(np.copysign(np.ceil(abs(nearest) * 100 - 1e-6) / 100, nearest))
    return plain if lower <= plain <= upper else nearest


def assumed_posture(design: TreeDesign) -> dict[str, float]:
    """Collect the default angles that neither the file nor the actuation file states.

    Args:
        design: the imported robot.

    Returns:
        The angles by joint [deg].
    """
    return {
        name: float(joint.default_deg)
        for name, joint in design.joint_sections.items()
        if design.origins[f"joints.{name}.default_deg"] == Origin("assumed", NEAREST)
    }


def posture_line(design: TreeDesign) -> str:
    """Write which default angles an import assumed.

    Args:
        design: the imported robot.

    Returns:
        One line; empty where the actuation file states them all.
    """
    assumed = assumed_posture(design)
    if not assumed:
        return ""
    bent = [f"{name} {angle:g}" for name, angle in assumed.items() if angle]
    count = f"{len(assumed)} joint{'s' if len(assumed) > 1 else ''}"
    angles = f"0, but {some(bent)}" if bent else "0"
    remedy = "joints: {NAME: {default_deg: ...}} in the actuation file states it"
    return f"default_deg is assumed for {count} as {NEAREST}: {angles}; {remedy}"
