"""Whether the mass of a URDF's robot fits its size."""

from __future__ import annotations

from typing import Any

import numpy as np

from hyperleg_design.robot.checks.finding import Finding

DENSEST = 2000.0
"""Total mass over the cube of the largest extent from which masses look like grams [kg/m^3]: of
about 70 robots of `example-robot-data`, the densest has 110, and in grams the lightest has 6800."""
SMALLEST = 0.05
"""Extent from which a robot has a size to compare with [m]."""


def check_mass(model: Any, metre: float = 1.0) -> list[Finding]:
    """Compare the total mass with the distance between the outermost points of the zero posture.

    Args:
        model: Pinocchio's model of the robot.
        metre: length of a metre in the file's unit; 1000 where lengths are millimetres.

    Returns:
        A warning where the robot is denser than `DENSEST`.
    """
    import pinocchio

    data = model.createData()
    pinocchio.framesForwardKinematics(model, data, pinocchio.neutral(model))
    points = [frame.translation for frame in data.oMf]
    bodies = [(body, at) for body, at in zip(model.inertias, data.oMi, strict=True) if body.mass]
    points += [at.act(body.lever) for body, at in bodies]
    places = np.array(points)
    extent = float(np.linalg.norm(places[:, None] - places, axis=-1).max()) / metre
    mass = sum(body.mass for body, _ in bodies)
    if extent < SMALLEST or mass < DENSEST * extent**3:
        return []
    message = f"weighs {mass:.4g} kg at {extent:.3g} m between its outermost points"
    return [Finding("warning", "<robot>", message, "looks like grams; a URDF uses kg and kg m^2")]
