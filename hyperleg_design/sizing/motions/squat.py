"""A squat: both feet flat, the pelvis goes down and up, the pressure stays where it was."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.kinematics.tree import SIGN
from hyperleg_design.robot.models import rigid_body_model
from hyperleg_design.robot.names import SIDES
from hyperleg_design.sizing.motions.balance import Series, balanced_states, lifted
from hyperleg_design.sizing.motions.foot_path import FLAT, FootPath
from hyperleg_design.sizing.motions.motion import Motion, check_positive, contact_mask

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design


@dataclass(frozen=True, kw_only=True)
class SquatPlan:
    """Depth and pace of the squat; all assumed."""

    depth: float = 0.18
    """Depth that the pelvis sinks, top to bottom [m]."""
    period: float = 2.0
    """Down and up [s]."""
    min_knee: float = 0.30
    """Knee flexion at the top [rad]."""

    def __post_init__(self) -> None:
        check_positive("squat", depth=self.depth, period=self.period, min_knee=self.min_knee)


def standing_feet(design: Design, count: int) -> tuple[FootPath, FootPath]:
    """Plan both feet flat under the hips; the ankles stand at x = 0.

    Args:
        design: one robot.
        count: number of samples.

    Returns:
        Left and right path.
    """
    feet = []
    for side in SIDES:
        position = np.zeros((3, count, 3))
        position[0] = [0.0, SIGN[side] * design.hip.spacing / 2, design.foot.ankle_height]
        feet.append(
            FootPath(position, np.zeros((3, count)), np.zeros((3, count)), np.full(count, FLAT))
        )
    return feet[0], feet[1]


def sole_middle(design: Design) -> float:
    """Compute the middle between the pads of heel and tip.

    Args:
        design: one robot.

    Returns:
        Its distance ahead of the ankle [m].
    """
    tip = design.foot.ball_length + design.toe.length
    return float(tip - design.foot.heel_length) / 2


def squat(design: Design, plan: SquatPlan | None = None, samples: int = 81) -> Motion:
    """Plan one squat, down and up as a sinusoid.

    Args:
        design: a robot, of any variant.
        plan: depth and pace.
        samples: in a period.

    Returns:
        The motion.

    Raises:
        InfeasibleError: a joint's range ends before.
        InputError: a plan that makes no sense.
    """
    plan = plan or SquatPlan()
    if samples < 20:
        raise InputError("squat", "samples", samples, "expects at least 20")
    model = rigid_body_model(design)
    time = np.arange(samples) * plan.period / samples
    feet = standing_feet(design, samples)
    pressure = np.zeros((samples, 3))
    pressure[:, 0] = sole_middle(design)
    rate = 2 * np.pi / plan.period
    wave = (
        plan.depth
        / 2
        * np.stack(
            [np.cos(rate * time) - 1, -rate * np.sin(rate * time), -(rate**2) * np.cos(rate * time)]
        )
    )

    def height(place: np.ndarray, _rise: np.ndarray) -> np.ndarray:
        return lifted(design, place, feet, wave, plan.min_knee)

    states = balanced_states(
        model, feet, pressure, height, Series(plan.period / samples, mirrored=False)
    )
    assumed = {
        "squat": f"{plan.depth:g} m in {plan.period:g} s, down and up as a sinusoid (assumed)",
        "feet": "flat under the hips, trunk upright, pressure in the middle of the soles (assumed)",
    }
    return Motion(
        "squat",
        model,
        time,
        states.q,
        states.v,
        states.a,
        contact_mask(model, feet),
        feet,
        pressure,
        True,
        0.0,
        assumed,
    )
