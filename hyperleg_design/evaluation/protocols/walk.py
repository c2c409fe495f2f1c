"""The walk protocol: straight walks from standing, and what is measured on them."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation import rollout
from hyperleg_design.evaluation.measures import WALK
from hyperleg_design.evaluation.motion import bearing, gait
from hyperleg_design.evaluation.motion.landmarks import landmark_measures
from hyperleg_design.evaluation.motion.loads import load_measures
from hyperleg_design.evaluation.motion.motor_use import MotorUse, motor_use
from hyperleg_design.evaluation.motion.power import cycle_power, flows, ledger
from hyperleg_design.evaluation.motion.steps import (
    impact_measures,
    measured_steps,
    step_measures,
)
from hyperleg_design.evaluation.protocol import WalkProtocol
from hyperleg_design.evaluation.protocols import course
from hyperleg_design.evaluation.rollout import Measured, ProtocolRun
from hyperleg_design.robot.names import SIDES
from hyperleg_design.simulation.commands import VelocityCommands
from hyperleg_design.sizing.energy import cost_of_transport

if TYPE_CHECKING:
    from hyperleg_design.evaluation.rollout import Trial
    from hyperleg_design.simulation.environment import Environment
    from hyperleg_design.simulation.tasks import Task

NO_NEW_COMMAND = 10_000.0
"""Time between commands that no trial lasts for [s]."""
STRIDES = 2
"""Whole strides that a steady part needs at least."""


def walk_run(task: Task, protocol: WalkProtocol) -> ProtocolRun:
    """Say how a task is run and measured under the walk protocol.

    Args:
        task: the policy's task.
        protocol: gives command, distance and what counts as steady.

    Returns:
        The task under the protocol's command, the arrival at its distance in any direction, and
        the measures of `measure_walk`.

    Raises:
        InputError: a task without velocity commands, or `heading_gain` for a policy that never had
            to turn.
    """
    return ProtocolRun(
        walk_task(task, protocol),
        lambda trial: measure_walk(trial, protocol),
        arrived=lambda first, now: (
            np.linalg.norm(now[:, :2] - first[:, :2], axis=-1) >= protocol.distance
        ),
        before_step=_heading_keeper(protocol.heading_gain) if protocol.heading_gain else None,
    )


def walk_task(task: Task, protocol: WalkProtocol) -> Task:
    """Put a policy's task under the protocol's command, starting states and time.

    Args:
        task: the policy's task, whose commands are velocities.
        protocol: gives speed, heading control, starting states and time limit.

    Returns:
        The task with the one command of the protocol for the whole trial.

    Raises:
        InputError: a task without velocity commands, or `heading_gain` for a policy that never had
            to turn.
    """
    if not isinstance(task.commands, VelocityCommands):
        raise InputError(
            task.name,
            "commands.kind",
            "waypoints",
            "expects velocity commands; this policy runs the T-test",
        )
    if protocol.heading_gain and not task.commands.turning:
        raise InputError(
            protocol.name,
            "heading_gain",
            protocol.heading_gain,
            f"must be 0: the task {task.name} was trained without turning",
        )
    commands = dataclasses.replace(
        task.commands,
        test_share=1.0,
        standing_share=0.0,
        test_speed=protocol.speed,
        interval=NO_NEW_COMMAND,
    )
    return rollout.under_protocol(task, protocol).changed(commands=commands)


def measure_walk(trial: Trial, protocol: WalkProtocol) -> Measured:
    """Compute the measures of one walk, the use of its motors in steady state, and the power of its
    right leg over the gait cycle.

    A measure that a trial cannot give is NaN: all of a diverged trial; those of the steady state
    where it fell or has fewer than `STRIDES` whole strides; those of heel, ankle or right leg where
    the robot has none.

    Args:
        trial: the record of the walk.
        protocol: under which it was run.

    Returns:
        Measures by name, see `measures.WALK`; use of the motors and right-leg power, None without a
        steady state, the power also without a left and a right leg.
    """
    measures = dict.fromkeys(WALK, np.nan) | {
        "arrived": float(trial.outcome == rollout.ARRIVED),
        **rollout.outcome_measures(trial),
    }
    if trial.outcome == rollout.DIVERGED or not trial.samples:
        return measures, None, None
    away = np.linalg.norm(trial.base_position[:, :2] - trial.base_position[0, :2], axis=-1)
    measures |= _run_measures(trial, away, protocol)
    window = steady_window(trial, away, protocol)
    if window is None:
        return measures, None, None
    use = motor_use(trial, *window)
    steady, steps = _steady_measures(trial, window, use, protocol)
    measures |= steady
    if trial.layout.limbs != SIDES:
        return measures, use, None
    cycle = cycle_power(trial, steps)
    measures |= {f"right_{name}_power": value for name, value in cycle.means.items()}
    return measures, use, cycle


def steady_window(trial: Trial, away: np.ndarray, protocol: WalkProtocol) -> tuple[int, int] | None:
    """Find the whole strides of the left foot in the steady part of a walk.

    Args:
        trial: the walk.
        away: distance from the start at each sample [m], `(t,)`.
        protocol: gives the distances at which the steady part begins and ends.

    Returns:
        The first and the last sample; None for a fall or with fewer than `STRIDES` whole strides.
    """
    beyond = np.flatnonzero(away >= protocol.steady.begin)
    if trial.outcome == rollout.FELL or not len(beyond):
        return None
    past = np.flatnonzero(away >= protocol.steady_end)
    steps = measured_steps(trial, protocol.events)
    window = gait.whole_strides(steps, int(beyond[0]), int(past[0]) if len(past) else trial.samples)
    if window is None or len(steps.within(*window).foot) < 2 * STRIDES:
        return None
    return window


def _run_measures(trial: Trial, away: np.ndarray, protocol: WalkProtocol) -> dict[str, float]:
    """Measures from the start to the arrival, the fall or the time limit."""
    time = (
        course.crossing_time(away, protocol.distance, trial.time_step)
        if trial.outcome == rollout.ARRIVED
        else np.nan
    )
    duration = trial.samples * trial.time_step
    power = flows(ledger(trial))
    heading = bearing.headings(trial.base_orientation)
    end = course.in_start_frame(trial.base_position[-1, :2], trial.base_position[0, :2], heading[0])
    way = float(away[-1])
    transport = {}
    for name, flow in (
        ("cost_of_transport", "motor_side"),
        ("battery_cost_of_transport", "battery"),
    ):
        # falling on the spot transports nothing, so it has no cost of transport
        transport[name] = (
            float(cost_of_transport(power[flow] * duration, trial.mass, way))
            if way > 1.0
            else np.nan
        )
    return {
        "time": time,
        "distance": way,
        "path": course.path_length(trial.base_position[:, :2]),
        "mean_speed": protocol.distance / time,
        "sideways": float(end[1]),
        "turned": bearing.turned(heading),
        "power": power["motor_side"],
        "joule_power": power["joule"],
        "mechanical_power": power["mechanical"],
        "positive_power": power["mechanical_positive"],
        "negative_power": power["mechanical_negative"],
        "driver_loss": power["driver_loss"],
        "battery_power": power["battery"],
        "energy": power["motor_side"] * duration,
        "battery_energy": power["battery"] * duration,
        **transport,
        "largest_tilt": float(bearing.tilt(trial.base_orientation).max()),
    }


def _steady_measures(
    trial: Trial, window: tuple[int, int], use: MotorUse, protocol: WalkProtocol
) -> tuple[dict[str, float], gait.Steps]:
    first, last = window
    part = slice(first, last)
    duration = (last - first) * trial.time_step
    power = flows(ledger(trial, first, last))
    way = float(np.linalg.norm(trial.base_position[last, :2] - trial.base_position[first, :2]))
    transport = {
        flow: float(cost_of_transport(power[flow] * duration, trial.mass, way))
        for flow in ("motor_side", "battery")
    }
    steps = measured_steps(trial, protocol.events).within(first, last + 1)
    measures = {
        "steady_speed": way / duration,
        "steady_power": power["motor_side"],
        "steady_joule_power": power["joule"],
        "steady_mechanical_power": power["mechanical"],
        "steady_positive_power": power["mechanical_positive"],
        "steady_negative_power": power["mechanical_negative"],
        "steady_battery_power": power["battery"],
        "steady_cost_of_transport": transport["motor_side"],
        "steady_battery_cost_of_transport": transport["battery"],
        **impact_measures(trial, steps, protocol.impact),
        **step_measures(trial, steps, window, protocol.events),
        **landmark_measures(trial, steps, protocol.events),
        "mean_tilt": float(bearing.tilt(trial.base_orientation[part]).mean()),
        **load_measures(trial, use, part),
    }
    return measures, steps


def _heading_keeper(gain: float) -> Any:
    start: list[np.ndarray] = []

    def keep(environment: Environment) -> None:
        heading = np.concatenate([c.motion.heading for c in environment.chunks])
        if not start:
            start.append(heading)
        cross = heading[:, 0] * start[0][:, 1] - heading[:, 1] * start[0][:, 0]
        turning = environment.task.commands.turning  # type: ignore[union-attr]
        wanted = np.clip(
            gain * np.arctan2(cross, np.einsum("ni,ni->n", heading, start[0])), -turning, turning
        )
        for chunk in environment.chunks:
            chunk.commander.values[:, 2] = wanted[chunk.first : chunk.first + chunk.count]  # type: ignore[union-attr]

    return keep
