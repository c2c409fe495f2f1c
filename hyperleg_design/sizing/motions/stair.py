"""A stair step: shift the weight, lift one foot onto the step, rise, bring the other foot beside
it.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.models import rigid_body_model
from hyperleg_design.robot.names import SIDES
from hyperleg_design.sizing.motions.balance import Series, balanced_states, lifted
from hyperleg_design.sizing.motions.foot_path import FootPath, Step, foot_path, quintic
from hyperleg_design.sizing.motions.motion import Motion, check_positive, contact_mask
from hyperleg_design.sizing.motions.squat import sole_middle

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design


@dataclass(frozen=True, kw_only=True)
class StairPlan:
    """Step and pace; all assumed."""

    step_height: float = 0.17
    """Height of the step [m]; that of a common stair."""
    step_depth: float = 0.29
    """How far ahead the feet stand on the step [m]."""
    shift: float = 0.4
    """Weight from both feet to one, or back [s]."""
    swing: float = 0.45
    """A foot in the air [s]."""
    rise: float = 0.6
    """Weight from the lower foot to the upper one while the body rises [s]."""
    width: float = 1.0
    """Distance between the feet over the distance between the hips [-]."""
    clearance: float = 0.06
    """Added height of the swinging foot in the middle [m]."""
    pitch_off: float = 0.55
    """Pitch of the rear foot as it leaves the lower floor [rad]."""
    lean: float = 0.10
    """Lean of the trunk over the standing foot [rad]; upright, the hips' narrow range inward (5
    deg) would not let the robot stand there."""
    inward: float = 0.4
    """How far inside the standing foot's middle the pressure is, over the half distance of its pads
    [-]."""
    upper_pressure: float = 0.2
    """Where the upper foot takes the weight, from below its ankle to its middle [-]; further ahead
    the ankle would bend too far."""
    heel_rise: float = 0.30
    """When in the rise the rear heel leaves the floor [-]."""
    min_knee: float = 0.30
    """Least knee flexion [rad]."""

    def __post_init__(self) -> None:
        fields = ("step_height", "step_depth", "shift", "swing", "rise", "clearance", "min_knee")
        check_positive("stair", **{name: getattr(self, name) for name in fields})
        if not 0 <= self.pitch_off < 1.2:
            raise InputError("stair", "pitch_off", self.pitch_off, "expects 0 .. 1.2 rad")


def stair(design: Design, plan: StairPlan | None = None, samples: int = 151) -> Motion:
    """Plan one step up a stair, left foot first, from rest to rest.

    The heel of the rear foot rises as the body does, over the toe where that moves.

    Args:
        design: a robot, of any variant.
        plan: step and pace.
        samples: in all.

    Returns:
        The motion.

    Raises:
        InfeasibleError: the step is too high for the legs, or a joint's range ends before.
        InputError: a plan that makes no sense.
    """
    plan = plan or StairPlan()
    if samples < 40:
        raise InputError("stair", "samples", samples, "expects at least 40")
    model = rigid_body_model(design)
    times = _times(plan)
    time = np.linspace(0.0, times.end, samples)
    half, ahead, high = plan.width * design.hip.spacing / 2, plan.step_depth, plan.step_height
    inner = half - plan.inward * max(design.foot.width / 2 - design.contact.pad_radius, 0.0)
    feet = _feet(design, plan, times, time, half)
    path = _pressure(design, plan, times, time, inner)
    pressure, lean = path[0], -plan.lean / inner * path[..., 1]

    climb = np.zeros((3, samples))
    climb[0, time >= times.over] = high
    rising = (time >= times.landed) & (time < times.over)
    climb[:, rising] = quintic(time[rising], times.landed, times.over, (0, 0, 0), (high, 0, 0))

    def height(place: np.ndarray, _rise: np.ndarray) -> np.ndarray:
        return lifted(design, place, feet, climb, plan.min_knee, lean[0])

    states = balanced_states(
        model, feet, pressure, height, Series(times.end / (samples - 1), mirrored=True), roll=lean
    )
    assumed = {
        "step": f"{high:g} m high, {ahead:g} m ahead, {SIDES[0]} foot first, {times.end:.2f} s "
        "from rest to rest (assumed)",
        "pelvis": f"leans by {np.rad2deg(plan.lean):.0f} deg over the standing foot and rises as "
        f"the weight passes (assumed)",
        "knee": f"never straighter than {np.rad2deg(plan.min_knee):.0f} deg (assumed)",
        "balance": "the zero-moment point goes from foot to foot (assumed)",
    }
    return Motion(
        "stair",
        model,
        time,
        states.q,
        states.v,
        states.a,
        contact_mask(model, feet),
        feet,
        pressure,
        False,
        ahead,
        assumed,
    )


class _Times(NamedTuple):
    """When the parts of a step end [s]."""

    start: float
    leave: float
    """The weight begins to go to the right foot."""
    up: float
    """The left foot leaves the floor."""
    landed: float
    """The left foot stands on the step."""
    over: float
    """The weight is on the left foot, and the right one leaves the floor."""
    beside: float
    """The right foot stands on the step, too."""
    centred: float
    """The weight is on both feet."""
    end: float


def _times(plan: StairPlan) -> _Times:
    half = plan.shift / 2
    parts = (0.0, half, plan.shift, plan.swing, plan.rise, plan.swing, plan.shift, half)
    return _Times(*np.cumsum(parts))


def _feet(
    design: Design, plan: StairPlan, times: _Times, time: np.ndarray, half: float
) -> tuple[FootPath, FootPath]:
    """Paths of the left and the right foot, which stand `half` [m] beside the middle."""
    ahead, high = plan.step_depth, plan.step_height
    heel_up = times.landed + plan.heel_rise * plan.rise
    left = Step(
        times.up,
        times.up,
        times.landed,
        times.landed,
        (0.0, half, 0.0),
        (ahead, half, high),
        0.0,
        0.0,
        plan.clearance,
    )
    right = Step(
        heel_up,
        times.over,
        times.beside,
        times.beside,
        (0.0, -half, 0.0),
        (ahead, -half, high),
        plan.pitch_off,
        0.0,
        plan.clearance,
    )
    return foot_path(design, time, [left]), foot_path(design, time, [right])


def _pressure(
    design: Design, plan: StairPlan, times: _Times, time: np.ndarray, inner: float
) -> np.ndarray:
    """Centre of pressure with rate and acceleration, `(3, samples, 3)`; it is `inner` [m] beside
    the middle while one foot bears all.
    """
    ahead, high = plan.step_depth, plan.step_height
    middle = sole_middle(design)
    tip = design.foot.ball_length + design.toe.length - design.contact.pad_radius
    upper = np.array([ahead + plan.upper_pressure * middle, inner, high])
    stops = (
        (times.start, np.array([middle, 0.0, 0.0])),
        (times.leave, np.array([middle, 0.0, 0.0])),
        (times.up, np.array([middle, -inner, 0.0])),
        (times.landed, np.array([middle + 0.85 * (tip - middle), -inner, 0.0])),
        (times.over, upper),
        (times.beside, upper),
        (times.centred, np.array([ahead + middle, 0.0, high])),
        (times.end, np.array([ahead + middle, 0.0, high])),
    )
    path = np.zeros((3, len(time), 3))
    for (t0, p0), (t1, p1) in itertools.pairwise(stops):
        inside = (time >= t0) & (time <= t1)
        for axis in range(3):
            begin, end = (p0[axis], 0, 0), (p1[axis], 0, 0)
            path[:, inside, axis] = quintic(time[inside], t0, t1, begin, end)
    return path
