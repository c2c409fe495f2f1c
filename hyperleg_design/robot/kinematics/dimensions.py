"""Mass and height of a robot of any family, batched."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from hyperleg_design.robot import masses
from hyperleg_design.robot.checks.consistency import leg_length
from hyperleg_design.robot.trees import limb_masses, tree_limb
from hyperleg_design.robot.trees.tree_design import TreeDesign

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design
    from hyperleg_design.robot.parameters.described import RobotDesign


def total_mass(design: RobotDesign) -> Any:
    """Compute the mass of the robot.

    Args:
        design: a robot or batch, of any family.

    Returns:
        The mass [kg], `(...)`.
    """
    if isinstance(design, TreeDesign):
        return limb_masses.limb_masses(design).total
    return masses.mass_table(cast("Design", design)).total


def limb_mass(design: RobotDesign) -> Any:
    """Compute the mass of one limb: of one leg, or of the links that move against the root
    link.

    Args:
        design: a robot or batch, of any family.

    Returns:
        The mass [kg], `(...)`.
    """
    if isinstance(design, TreeDesign):
        return limb_masses.limb_masses(design).limb
    return masses.mass_table(cast("Design", design)).leg


def zero_height(design: RobotDesign) -> Any:
    """Compute the height of the base's origin above the floor in the zero posture.

    Args:
        design: a robot or batch, of any family.

    Returns:
        The height [m], `(...)`.
    """
    if isinstance(design, TreeDesign):
        return tree_limb.standing_height(design)
    return leg_length(cast("Design", design))


def standing_height(design: TreeDesign) -> np.ndarray:
    """Compute the height of the base's origin above the floor in the default posture.

    Args:
        design: a robot or batch that writes its tree out.

    Returns:
        The height [m], `(...)`.
    """
    return tree_limb.standing_height(design, tree_limb.default_position(design))
