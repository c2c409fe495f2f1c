"""The Robot T-test: runs over a course of waypoints, and what is measured on them."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation import rollout
from hyperleg_design.evaluation.measures import T_TEST
from hyperleg_design.evaluation.motion import bearing
from hyperleg_design.evaluation.motion.loads import load_measures
from hyperleg_design.evaluation.motion.motor_use import MotorUse, motor_use
from hyperleg_design.evaluation.motion.power import flows, ledger
from hyperleg_design.evaluation.motion.steps import (
    impact_measures,
    measured_steps,
    step_measures,
)
from hyperleg_design.evaluation.protocol import TTestProtocol
from hyperleg_design.evaluation.protocols import course
from hyperleg_design.evaluation.rollout import ProtocolRun
from hyperleg_design.simulation.waypoint_commands import WaypointCommands
from hyperleg_design.sizing.energy import cost_of_transport

if TYPE_CHECKING:
    from hyperleg_design.evaluation.rollout import Trial
    from hyperleg_design.simulation.tasks import Task


def t_test_run(task: Task, protocol: TTestProtocol) -> ProtocolRun:
    """Say how a task is run and measured under the T-test protocol.

    Args:
        task: the policy's task.
        protocol: the course, and what counts as an arrival on it.

    Returns:
        The task on the course, and the measures of `measure_t_test`.

    Raises:
        InputError: a task without waypoints.
    """
    return ProtocolRun(
        t_test_task(task, protocol), lambda trial: (*measure_t_test(trial, protocol), None)
    )


def t_test_task(task: Task, protocol: TTestProtocol) -> Task:
    """Put a policy's task on the protocol's course.

    Args:
        task: the policy's task, whose commands are waypoints.
        protocol: gives the course, the distance at which a waypoint counts as reached, the speed
            cap, and the deviation from the course at which a trial is lost.

    Returns:
        The task with the course as its only one, from the protocol's starting states.

    Raises:
        InputError: a task without waypoints.
    """
    if not isinstance(task.commands, WaypointCommands):
        raise InputError(
            task.name,
            "commands.kind",
            "velocity",
            "expects waypoints; this policy walks at a speed",
        )
    commands = dataclasses.replace(
        task.commands,
        arrival=protocol.arrival,
        speed_cap=protocol.speed_cap,
        slower=0.0,
        courses=(tuple((float(x), float(y)) for x, y in protocol.course[1:]),),
        course_share=1.0,
    )
    timed = rollout.under_protocol(task, protocol)
    return timed.changed(
        commands=commands, limits=dataclasses.replace(timed.limits, deviation=protocol.lost)
    )


def measure_t_test(
    trial: Trial, protocol: TTestProtocol
) -> tuple[dict[str, float], MotorUse | None]:
    """Compute the measures of one run and the use of its motors.

    `time`, `mean_speed` and `waypoint_*` come from arrivals. Deviations, peak speed and power come
    from all that was run, so a run that ends in a fall has them up to the fall.

    Args:
        trial: the record of the run.
        protocol: under which it was run.

    Returns:
        The measures by name (see `measures.T_TEST`), and the use of the motors. A measure that the
        trial cannot give is NaN. A diverged trial gives NaN for all of them, and None for the use.
    """
    waypoints = tuple(f"waypoint_{i}" for i in range(1, len(protocol.order)))
    measures = dict.fromkeys((*T_TEST, *waypoints), np.nan) | {
        "arrived": float(trial.outcome == rollout.ARRIVED),
        **rollout.outcome_measures(trial),
    }
    if trial.outcome == rollout.DIVERGED or trial.samples < 2:
        return measures, None
    heading = bearing.headings(trial.base_orientation)
    place = course.in_start_frame(
        trial.base_position[:, :2], trial.base_position[0, :2], heading[0]
    )
    reached = reached_samples(trial, place, protocol)
    leg = course.legs_run(reached, trial.samples)
    beside, aside = (
        course.course_deviation(place, protocol.course),
        course.leg_deviation(place, protocol.course, leg),
    )
    speed = np.linalg.norm(trial.base_velocity[:, :2], axis=-1)
    arrived = trial.outcome == rollout.ARRIVED
    way = course.path_length(place)
    duration = trial.samples * trial.time_step
    power = flows(ledger(trial))
    times = [s * trial.time_step if s >= 0 else np.nan for s in reached]
    if arrived:
        times[-1] = trial.end_time
    steps = measured_steps(trial, protocol.events)
    use = motor_use(trial)
    stepped = step_measures(trial, steps, (0, trial.samples), protocol.events)
    measures |= {
        "time": trial.end_time if arrived else np.nan,
        "waypoints_reached": float(np.sum(np.isfinite(times))),
        "distance": way,
        "mean_speed": way / duration if arrived else np.nan,
        "peak_speed": float(speed.max()),
        "mean_deviation": float(beside.mean()),
        "peak_deviation": float(beside.max()),
        "mean_leg_deviation": float(aside.mean()),
        "peak_leg_deviation": float(aside.max()),
        "turned": bearing.turned(heading),
        "power": power["motor_side"],
        "joule_power": power["joule"],
        "mechanical_power": power["mechanical"],
        "positive_power": power["mechanical_positive"],
        "negative_power": power["mechanical_negative"],
        "battery_power": power["battery"],
        "energy": power["motor_side"] * duration,
        "cost_of_transport": float(
            cost_of_transport(power["motor_side"] * duration, trial.mass, way)
        )
        if way > 1.0
        else np.nan,
        **impact_measures(trial, steps, protocol.impact),
        **{name: value for name, value in stepped.items() if name in T_TEST},
        "largest_tilt": float(bearing.tilt(trial.base_orientation).max()),
        **load_measures(trial, use),
        **dict(zip(waypoints, times, strict=True)),
    }
    return measures, use


def reached_samples(trial: Trial, place: np.ndarray, protocol: TTestProtocol) -> np.ndarray:
    """Samples at which the waypoints were reached, as the simulation judges it: at the ends of
    policy steps; -1 where never.

    Args:
        trial: the run.
        place: of the pelvis in the frame of the start at each sample, `(t, 2)` [m].
        protocol: the course.

    Returns:
        `(waypoints,)`; the last one ends the trial and lies one sample past it.
    """
    reached = course.arrivals(place[:: trial.substeps], protocol.course, protocol.arrival)
    reached = np.where(reached >= 0, reached * trial.substeps, -1)
    if trial.outcome == rollout.ARRIVED:
        reached[-1] = trial.samples
    return reached
