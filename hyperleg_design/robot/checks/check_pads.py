"""Whether all feet of a robot stand on the floor in its default posture."""

from __future__ import annotations

from hyperleg_design.robot.checks.finding import Finding
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.robot.trees.tree_limb import pad_heights

HANGING = 5e-3
"""Height above the lowest pad from which a pad counts as in the air [m] (assumed: soft pads give by
a few millimetres, and joint angles are written in whole degrees)."""


def hanging_pads(design: TreeDesign) -> dict[str, float]:
    """Find the pads that are in the air while the lowest pad is on the floor, in the default
    posture.

    Args:
        design: one robot.

    Returns:
        Heights of their lowest points above that of the lowest pad [m], by name of the pad; pads of
        the trunk are not among them.
    """
    heights = {name: float(height) for name, height in pad_heights(design).items()}
    return {name: height for name, height in heights.items() if height > HANGING}


def check_pads(design: TreeDesign) -> list[Finding]:
    """Check that no pad hangs in the air in the default posture.

    Args:
        design: one robot.

    Returns:
        One warning that names the pads that do, and their heights.
    """
    hanging = hanging_pads(design)
    if not hanging:
        return []
    remedy = "change default_deg or the pads, unless these are meant to hang"
    return [Finding("warning", "pads", f"in the default posture {pads_text(hanging)}", remedy)]


def pads_text(hanging: dict[str, float]) -> str:
    """Write which pads hang how high.

    Args:
        hanging: heights above the lowest pad [m], by name of the pad.

    Returns:
        The text, without a full stop.
    """
    heights = ", ".join(f"{name} {1e3 * height:.0f} mm" for name, height in hanging.items())
    return f"pads hang above the lowest pad: {heights}"
