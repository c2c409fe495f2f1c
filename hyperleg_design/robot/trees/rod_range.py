"""What the rods of a design do over the ranges of the joints that they span."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from hyperleg_design.errors import InfeasibleError
from hyperleg_design.robot.trees.limb_actuation import crank_turn
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.robot.trees.tree_limb import ancestors, default_position

POSTURES = 200
"""Postures at most in which a rod is tried: an even grid over the joints that it spans."""


@dataclass(frozen=True)
class RodRange:
    """Reductions of one motor's linkage over the ranges of its joints."""

    motor: str
    reduction: dict[str, tuple[float, float]]
    """Smallest and largest reduction between motor and joint, gear included, by joint [-]."""
    default: dict[str, float]
    """The same in the default posture [-]."""
    beyond: dict[str, float]
    """A posture in which the rod does not reach, by joint [deg]; empty where it always does."""
    reversed: dict[str, dict[str, float]]
    """For each joint whose reduction passes zero, a posture in which the motor turns it the other
    way than in the default posture, by joint [deg]: in between lies a dead centre, where the motor
    cannot move it."""


def rod_ranges(design: TreeDesign) -> tuple[RodRange, ...]:
    """Try the rods of a design over the ranges of motion.

    The joints that a rod spans take all combinations of an even grid over their ranges; the others
    stay in the default posture.

    Args:
        design: one robot.

    Returns:
        One range for each rod, in the order of the file.
    """
    return tuple(_range(design, motor) for motor in design.rod_sections)


def _range(design: TreeDesign, motor: str) -> RodRange:
    joints = list(design.joint_sections)
    rod, rest = design.rod_sections[motor], default_position(design)
    spanned = set(ancestors(design, str(rod.end))) - set(ancestors(design, str(rod.carrier)))
    rows = [row for row, name in enumerate(joints) if name in spanned]
    names, gear = [joints[row] for row in rows], float(design.actuator_sections[motor].gear)
    own = gear * crank_turn(design, motor, rest)[1][rows]
    each = max(3, int(POSTURES ** (1 / max(1, len(rows)))))
    sections = [design.joint_sections[name] for name in names]
    grids = [np.linspace(float(s.lower_deg), float(s.upper_deg), each) for s in sections]
    columns: list[np.ndarray] = [own]
    beyond: dict[str, float] = {}
    turned: dict[str, dict[str, float]] = {}
    for angles in product(*grids):
        posture = dict(zip(names, np.round(angles, 1).tolist(), strict=True))
        position = np.array(rest)
        position[rows] = np.deg2rad(angles)
        try:
            columns.append(gear * crank_turn(design, motor, position)[1][rows])
        except InfeasibleError:
            beyond = beyond or posture
            continue
        for name, here, there in zip(names, own, columns[-1], strict=True):
            if here * there < 0:
                turned.setdefault(name, posture)
    ends = zip(np.min(columns, 0).tolist(), np.max(columns, 0).tolist(), strict=True)
    return RodRange(
        motor,
        dict(zip(names, ends, strict=True)),
        dict(zip(names, own.tolist(), strict=True)),
        beyond,
        turned,
    )
