"""Reward terms: one function each, of the state after a policy step.

A term returns its value in every simulation, `(n,)`; a task multiplies it by its weight and by the
policy step, as Isaac Lab does. `paper` marks those of Table II; all others are deviations from the
paper and are reported as such.
"""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.reading import summary_line
from hyperleg_design.simulation import human_gait
from hyperleg_design.simulation.layout import Layout
from hyperleg_design.simulation.model import foot_loads
from hyperleg_design.simulation.settings import Clock
from hyperleg_design.simulation.state import Goal, State

TOUCH = 1.0
"""Vertical force from which a foot counts as standing [N]; assumed."""


@dataclass(frozen=True)
class Robot:
    """What terms know of the robot and the task besides the state."""

    layout: Layout
    """Layout of all simulations together, or of each of them."""
    clock: Clock

    def take(self, rows: np.ndarray) -> Robot:
        """Take the robots of some of the simulations.

        Args:
            rows: their indices.

        Returns:
            The smaller object.
        """
        return dataclasses.replace(self, layout=self.layout.take(rows))


@dataclass(frozen=True)
class Term:
    """A reward term: its function, parameters and description."""

    name: str
    function: Callable[..., np.ndarray]
    paper: bool
    """Whether Table II has it."""
    needs_goal: bool
    """Whether it needs waypoints."""
    needs_joints: tuple[str, ...] = ()
    """Joints that each of the robot's limbs must have."""

    @property
    def description(self) -> str:
        """First paragraph of its docstring."""
        return summary_line(self.function)

    @property
    def parameters(self) -> dict[str, float]:
        """Parameters besides state and robot, with their defaults."""
        return {
            n: p.default
            for n, p in inspect.signature(self.function).parameters.items()
            if p.default is not inspect.Parameter.empty
        }


TERMS: dict[str, Term] = {}
"""All terms by name."""


def term(
    *, paper: bool = False, goal: bool = False, joints: Sequence[str] = ()
) -> Callable[[Callable[..., np.ndarray]], Callable[..., np.ndarray]]:
    """Register a function as a reward term under its own name.

    Args:
        paper: whether the term is in Table II of the paper.
        goal: whether it needs waypoints.
        joints: names of joints, without the limb's, that a robot must have.

    Returns:
        A decorator, which returns the function unchanged.
    """

    def registered(function: Callable[..., np.ndarray]) -> Callable[..., np.ndarray]:
        TERMS[function.__name__] = Term(function.__name__, function, paper, goal, tuple(joints))
        return function

    return registered


def _goal(state: State) -> Goal:
    assert state.goal is not None
    return state.goal


@term(paper=True)
def termination(state: State, robot: Robot) -> np.ndarray:
    """1 where the robot has fallen."""
    return state.terminated.astype(float)


@term(paper=True)
def power(state: State, robot: Robot) -> np.ndarray:
    """Joule heat plus signed mechanical power of all motors [W], mean over the substeps."""
    return state.power


@term(paper=True)
def thermal(state: State, robot: Robot) -> np.ndarray:
    """Sum over motors of [-(dh/dt + h / T)]+ [1/s]."""
    return state.thermal_excess


@term(paper=True)
def linear_velocity(state: State, robot: Robot, width: float = 0.1) -> np.ndarray:
    """exp(-|v_cmd - v|^2 / width), horizontal velocity in the yaw frame."""
    error = state.command[:, :2] - state.motion.walking_velocity
    return np.exp(-np.einsum("ni,ni->n", error, error) / width)


@term(paper=True)
def angular_velocity(state: State, robot: Robot, width: float = 0.2) -> np.ndarray:
    """exp(-(w_cmd - w)^2 / width), about the vertical."""
    return np.exp(-((state.command[:, 2] - state.motion.yaw_rate) ** 2) / width)


@term(paper=True, goal=True)
def goal_arrival(state: State, robot: Robot) -> np.ndarray:
    """1 in the step that comes within the arrival radius of the waypoint."""
    return _goal(state).arrived.astype(float)


@term(paper=True, goal=True)
def position_progress(state: State, robot: Robot) -> np.ndarray:
    """max(d* - d, 0): how much closer than ever before to the waypoint [m]."""
    return _goal(state).progress


@term()
def contact_match(state: State, robot: Robot) -> np.ndarray:
    """Fraction of the feet that stand, or do not, as the gait clock says."""
    stands = state.foot_load[-1] > TOUCH
    should = stance(state.phase, robot.clock.stance, robot.layout.foot_phase)
    return np.add.reduce(stands == should, 1) / stands.shape[1]


@term()
def flight(state: State, robot: Robot) -> np.ndarray:
    """1 where no foot touches the floor."""
    return np.logical_and.reduce(state.foot_load[-1] <= TOUCH, 1).astype(float)


@term()
def tilt(state: State, robot: Robot) -> np.ndarray:
    """Squared horizontal part of gravity's direction in the pelvis's frame: how far from
    upright.
    """
    level = state.motion.rotation[:, 2, :2]
    return np.einsum("ni,ni->n", level, level)


@term()
def action_rate(state: State, robot: Robot) -> np.ndarray:
    """Squared change of the action."""
    change = state.action - state.previous_action
    return np.einsum("nj,nj->n", change, change)


@term()
def foot_slide(state: State, robot: Robot) -> np.ndarray:
    """Sliding speed of the feet [m/s]: of each foot's touching pads the mean, weighted by load,
    summed over the feet.
    """
    weighted = foot_loads(state.pad_load[-1] * state.pad_slip, robot.layout.pads_of_foot)
    return np.einsum("nf->n", weighted / np.maximum(state.foot_load[-1], TOUCH))


@term(joints=("hip_yaw", "hip_roll"))
def hip_deviation(state: State, robot: Robot) -> np.ndarray:
    """Hip yaw and roll away from the default posture, summed [rad]."""
    places = robot.layout.hip_sideways
    return np.einsum(
        "nj->n", np.abs(state.motion.joint_position[:, places] - robot.layout.default[..., places])
    )


@term()
def posture_deviation(state: State, robot: Robot) -> np.ndarray:
    """Squared distance of all joints from the default posture, summed [rad^2]."""
    away = state.motion.joint_position - robot.layout.default
    return np.einsum("nj,nj->n", away, away)


@term()
def roll_pitch_rate(state: State, robot: Robot) -> np.ndarray:
    """Squared roll and pitch rate of the pelvis [rad^2/s^2]."""
    rate = state.motion.angular_velocity[:, :2]
    return np.einsum("ni,ni->n", rate, rate)


@term()
def joint_limits(state: State, robot: Robot, share: float = 0.95) -> np.ndarray:
    """Joint angles outside the inner share of their range of motion, summed [rad]."""
    middle, half = (
        (robot.layout.upper + robot.layout.lower) / 2,
        (robot.layout.upper - robot.layout.lower) / 2,
    )
    return np.einsum(
        "nj->n", np.maximum(np.abs(state.motion.joint_position - middle) - share * half, 0.0)
    )


def _near(away: np.ndarray, state: State, width: float, spread: float) -> np.ndarray:
    """exp(-(d / spread)^2 - |v_cmd - v|^2 / width), d the distance from the human cycle."""
    motion, goal = state.motion, state.goal
    commanded = state.command[:, :2]
    if goal is not None:
        commanded = goal.offset * (goal.speed_cap / np.maximum(goal.distance, 1e-9))[:, None]
    error = commanded - motion.walking_velocity
    return np.exp(-((away / spread) ** 2) - np.einsum("ni,ni->n", error, error) / width)


@term(joints=tuple(human_gait.KNOTS))
def human_cycle(state: State, robot: Robot, width: float = 0.25, spread: float = 1.0) -> np.ndarray:
    """exp(-(d / spread)^2 - |v_cmd - v|^2 / width), d the distance from the nearest phase of human
    walking; with waypoints, v_cmd is the speed cap toward the present one.
    """
    motion, joints = state.motion, robot.layout.joints
    away = human_gait.distance(joints, motion.joint_position, motion.joint_velocity)
    return _near(away, state, width, spread)


@term(joints=tuple(human_gait.KNOTS))
def human_stride(
    state: State, robot: Robot, width: float = 0.25, spread: float = 1.0
) -> np.ndarray:
    """As `human_cycle`, with the distance from human walking at the phase of the gait clock, whose
    period must be that of the cycle.
    """
    motion, joints = state.motion, robot.layout.joints
    away = human_gait.distance_at(joints, motion.joint_position, motion.joint_velocity, state.phase)
    return _near(away, state, width, spread)


@term(joints=("knee", "ankle_pitch"))
def stance_flexion(state: State, robot: Robot, free: float = 0.26) -> np.ndarray:
    """Knee flexion and ankle dorsiflexion beyond a free angle [rad], of each leg weighted by the
    share of the body's weight on its foot, at most 1, and summed: how crouched the robot stands.
    """
    layout, position = robot.layout, state.motion.joint_position
    knees, ankles = (layout.joint_indices(name) for name in ("knee", "ankle_pitch"))
    load = np.minimum(state.foot_load[-1] / np.reshape(layout.weight, (-1, 1)), 1.0)
    bent = np.maximum(position[:, knees] - free, 0.0) + np.maximum(-position[:, ankles] - free, 0.0)
    return np.einsum("nf,nf->n", load, bent)


@term()
def ground_force(state: State, robot: Robot, body_weights: float = 1.5) -> np.ndarray:
    """Largest vertical force on one foot within the step above so many body weights, in body
    weights.
    """
    peak = state.foot_load.max((0, 2))
    return np.maximum(peak / robot.layout.weight - body_weights, 0.0)


@term(goal=True)
def goal_speed(state: State, robot: Robot) -> np.ndarray:
    """Speed toward the waypoint up to the speed cap [m/s]."""
    goal = _goal(state)
    toward = np.einsum("ni,ni->n", state.motion.walking_velocity, goal.offset) / np.maximum(
        goal.distance, 1e-9
    )
    return np.minimum(toward, goal.speed_cap)


@term(goal=True)
def goal_turning(state: State, robot: Robot, gain: float = 2.0, fastest: float = 3.0) -> np.ndarray:
    """exp(-e^2) - 0.2 |e|, e the yaw rate's distance [rad/s] from the gain [1/s] times the heading
    error, up to the fastest.
    """
    error = np.clip(gain * _goal(state).heading_error, -fastest, fastest) - state.motion.yaw_rate
    return np.exp(-(error**2)) - 0.2 * np.abs(error)


@term(goal=True)
def goal_facing(state: State, robot: Robot) -> np.ndarray:
    """Cosine of the heading error."""
    return np.cos(_goal(state).heading_error)


@term(goal=True)
def path_deviation(state: State, robot: Robot, most: float = 1.5) -> np.ndarray:
    """Distance from the straight path to the waypoint, at most `most` [m]."""
    return np.minimum(_goal(state).deviation, most)


def stance(phase: np.ndarray, share: float, foot_phase: Sequence[float] = (0.0, 0.5)) -> np.ndarray:
    """Decide whether feet should stand at phases of the gait clock.

    Args:
        phase: of the clock, 0 .. 1.
        share: of the stride for which a foot stands.
        foot_phase: by which each foot is behind the first, `(F,)`; of a biped, left and right.

    Returns:
        True where a foot should stand, `(n, F)`.
    """
    return (phase[:, None] + np.array(foot_phase)) % 1.0 < share
