"""A planned walk: steps of one length, the trunk upright, heel first, rolling over the toes at the
end of each stance.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.kinematics.tree import SIGN
from hyperleg_design.robot.models import rigid_body_model
from hyperleg_design.sizing.motions.balance import Series, balanced_states, lifted
from hyperleg_design.sizing.motions.foot_path import FootPath, Step, foot_path, quintic
from hyperleg_design.sizing.motions.motion import Motion, check_positive, contact_mask

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design


@dataclass(frozen=True, kw_only=True)
class WalkPlan:
    """What the walk looks like.

    Only the speed is the paper's. The rest is assumed: of the plans near human walking that a
    random search tried, one that keeps every motor of the paper's robot inside its envelope, with
    the active toe and without it. Knees as straight as a human's would have to turn faster, as the
    heel rises, than their motors can.
    """

    speed: float = 1.33
    """Mean forward speed [m/s] (paper, Table III)."""
    step_time: float = 0.42
    """One step [s]."""
    double_support: float = 0.22
    """Part of a step with both feet down [-]."""
    step_width: float = 0.8
    """Distance between the feet over the distance between the hips [-]."""
    heel_rise: float = 0.20
    """When in double support the rear heel leaves the floor [-]; the front heel has met it
    before."""
    foot_flat: float = 0.57
    """When in double support the front foot is flat [-]."""
    pitch_off: float = 0.49
    """Pitch of the foot as it leaves [rad]."""
    pitch_land: float = -0.25
    """Pitch of the foot as it lands, toes up [rad]."""
    clearance: float = 0.013
    """Height added to the swinging foot in the middle [m]."""
    load_swing: float = 0.20
    """Amplitude of the vertical force over weight, largest in double support [-]."""
    min_knee: float = 0.65
    """Least knee flexion [rad]; the pelvis is as high as this lets it be."""
    pressure_start: float = 0.0
    """Where on the way from below the ankle to the toe axis the pressure starts in single support
    [-]."""
    pressure_end: float = 0.82
    """Where on the way from the toe axis to the tip pads the pressure ends in single support
    [-]."""

    def __post_init__(self) -> None:
        check_positive(
            "walk",
            speed=self.speed,
            step_time=self.step_time,
            step_width=self.step_width,
            min_knee=self.min_knee,
        )
        for name in ("double_support", "heel_rise", "foot_flat"):
            if not 0 < getattr(self, name) < 1:
                raise InputError("walk", name, getattr(self, name), "must lie between 0 and 1")
        if not (0 <= self.pitch_off < 1.2 and -0.8 < self.pitch_land <= 0):
            raise InputError(
                "walk",
                "pitch_off, pitch_land",
                (self.pitch_off, self.pitch_land),
                "expects 0 .. 1.2 and -0.8 .. 0 rad",
            )


def walk(design: Design, plan: WalkPlan | None = None, samples: int = 101) -> Motion:
    """Plan one stride (two steps) of a steady walk.

    The feet follow their steps. The centre of pressure runs from heel to toe in single support, and
    to the other foot in double support. The path of the pelvis makes the zero-moment point of the
    whole robot equal to it.

    Args:
        design: a robot, of any variant.
        plan: speed, timing and shape.
        samples: in a stride; an odd number leaves no harmonic uncorrected.

    Returns:
        The motion.

    Raises:
        InfeasibleError: the legs are too short for the step, or a joint's range ends before.
        InputError: a plan that makes no sense, or fewer than 20 samples.
    """
    plan = plan or WalkPlan()
    if samples < 20:
        raise InputError("walk", "samples", samples, "expects at least 20")
    model = rigid_body_model(design)
    stride_time = 2 * plan.step_time
    time = np.arange(samples) * stride_time / samples
    feet = (_foot(design, plan, time, "left"), _foot(design, plan, time, "right"))
    pressure = _pressure(design, plan, time)
    drift = np.zeros((3, samples, 2))
    drift[0, :, 0], drift[1, :, 0] = plan.speed * time, plan.speed
    load = 1 + plan.load_swing * np.cos(
        2 * np.pi * (time / plan.step_time - plan.double_support / 2)
    )

    def height(place: np.ndarray, rise: np.ndarray) -> np.ndarray:
        return lifted(design, place, feet, rise, plan.min_knee)

    states = balanced_states(
        model, feet, pressure, height, Series(stride_time / samples, mirrored=False), drift, load
    )
    return Motion(
        "walk",
        model,
        time,
        states.q,
        states.v,
        states.a,
        contact_mask(model, feet),
        feet,
        pressure,
        True,
        plan.speed * stride_time,
        _assumed(plan),
    )


def _assumed(plan: WalkPlan) -> dict[str, str]:
    return {
        "speed": f"{plan.speed:g} m/s (paper, Table III)",
        "step": f"{plan.step_time:g} s, {plan.speed * plan.step_time:.3f} m; both feet down for "
        f"{100 * plan.double_support:g} % of it (assumed)",
        "feet": f"leave pitched by {np.rad2deg(plan.pitch_off):.0f} deg, land at "
        f"{np.rad2deg(plan.pitch_land):.0f} deg without impact (assumed)",
        "pelvis": f"upright, as high as a knee of {np.rad2deg(plan.min_knee):.0f} deg lets it be "
        f"(assumed)",
        "load": f"the vertical force swings by {100 * plan.load_swing:g} % of the weight (assumed)",
        "balance": "the zero-moment point runs from heel to toe and on to the other foot (assumed)",
    }


def _foot(design: Design, plan: WalkPlan, time: np.ndarray, side: str) -> FootPath:
    """Left lands at time zero at the origin, right half a stride later and half a stride ahead."""
    late = 0.0 if side == "left" else plan.step_time
    stride, both = 2 * plan.step_time, plan.double_support * plan.step_time
    y = SIGN[side] * plan.step_width * design.hip.spacing / 2
    steps = []
    for index in (-2, -1, 0, 1):
        land = late + (index + 1) * stride
        leaves = land - stride + plan.step_time
        x = plan.speed * (land - stride)
        steps.append(
            Step(
                leaves + plan.heel_rise * both,
                leaves + both,
                land,
                land + plan.foot_flat * both,
                (x, y, 0.0),
                (x + plan.speed * stride, y, 0.0),
                plan.pitch_off,
                plan.pitch_land,
                plan.clearance,
            )
        )
    return foot_path(design, time, steps)


def _pressure(design: Design, plan: WalkPlan, time: np.ndarray) -> np.ndarray:
    """Planned centre of pressure, `(n, 3)`: steady along the foot, then across to the other in
    double support.
    """
    radius = float(design.contact.pad_radius)
    back = plan.pressure_start * design.foot.ball_length
    front = design.foot.ball_length + plan.pressure_end * (design.toe.length - radius)
    both, step = plan.double_support * plan.step_time, plan.step_time
    y = plan.step_width * design.hip.spacing / 2
    rate = (front - back) / (step - both)
    pressure = np.zeros((len(time), 3))
    for index in range(2):  # the foot that lands at index * step takes over from the other
        sign = 1.0 if index == 0 else -1.0
        x = plan.speed * index * step
        inside = (time >= index * step) & (time < (index + 1) * step)
        local = time[inside] - index * step
        shift = quintic(
            local, 0, both, (x - plan.speed * step + front, rate, 0.0), (x + back, rate, 0.0)
        )[0]
        across = quintic(local, 0, both, (-sign * y, 0.0, 0.0), (sign * y, 0.0, 0.0))[0]
        pressure[inside, 0] = np.where(local < both, shift, x + back + rate * (local - both))
        pressure[inside, 1] = np.where(local < both, across, sign * y)
    return pressure
