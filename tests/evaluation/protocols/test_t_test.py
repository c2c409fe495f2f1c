"""The T-test on runs whose path is known, and in simulation."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation import measures, rollout
from hyperleg_design.evaluation.evaluate import evaluate
from hyperleg_design.evaluation.policy import standing
from hyperleg_design.evaluation.protocol import TTestProtocol
from hyperleg_design.evaluation.protocols.t_test import measure_t_test, t_test_task
from hyperleg_design.simulation.tasks import load_task

SPEED = 2.4
PROTOCOL = TTestProtocol()


@pytest.fixture(scope="module")
def run(planned_trial):
    """A pelvis that goes along the course at `SPEED`, `aside` of it; legs as in the planned
    walk.
    """

    def made(aside=0.0, outcome=rollout.ARRIVED, share=1.0):
        course = PROTOCOL.course
        ends = np.r_[0, np.cumsum(np.linalg.norm(np.diff(course, axis=0), axis=1))]
        way = np.arange(0, share * (ends[-1] - PROTOCOL.arrival), SPEED * 0.005)
        place = np.column_stack([np.interp(way, ends, course[:, k]) for k in (0, 1)])
        place[1:] += [0.0, aside]
        found = {name: getattr(planned_trial, name) for name in rollout.SIGNALS}
        cut = {name: values[: len(way)] for name, values in found.items() if values is not None}
        cut["base_position"] = np.column_stack([place, cut["base_position"][:, 2]])
        cut["base_velocity"] = np.gradient(cut["base_position"], 0.005, axis=0)
        return dataclasses.replace(planned_trial, outcome=outcome, end_time=len(way) * 0.005, **cut)

    return made


def test_a_run_on_the_course(run):
    found, use = measure_t_test(run(), PROTOCOL)
    assert found["time"] == pytest.approx((36.56 - 0.5) / SPEED, abs=0.01)
    assert found["mean_speed"] == pytest.approx(SPEED, rel=3e-3)
    assert found["peak_speed"] == pytest.approx(SPEED, rel=1e-2)
    assert found["mean_deviation"] == pytest.approx(0, abs=1e-9)
    assert 0.4 < found["peak_leg_deviation"] <= 0.5
    assert found["waypoints_reached"] == 5
    legs = np.cumsum([9.14, 4.57, 9.14, 4.57, 9.14])
    for i, way in enumerate(legs, 1):
        assert found[f"waypoint_{i}"] == pytest.approx((way - 0.5) / SPEED, abs=0.025), i
    assert found["power"] > 0
    assert use.rms_torque.shape == (14,)


def test_a_run_beside_the_course_deviates(run):
    found, _ = measure_t_test(run(aside=0.3), PROTOCOL)
    assert found["peak_deviation"] == pytest.approx(0.3)
    assert 0.1 < found["mean_deviation"] < 0.3  # legs across are run a little further, not aside


def test_a_fall_on_the_way_keeps_what_was_run(run):
    found, _ = measure_t_test(run(outcome=rollout.FELL, share=0.5), PROTOCOL)
    assert np.isnan([found["time"], found["mean_speed"], found["waypoint_5"]]).all()
    assert found["fell"] == 1
    assert found["waypoints_reached"] == 2
    assert found["peak_speed"] == pytest.approx(SPEED, rel=1e-2)


def test_every_measure_is_described_and_none_besides(run):
    names = [*measures.T_TEST, *(f"waypoint_{i}" for i in range(1, 6))]
    found, _ = measure_t_test(run(), PROTOCOL)
    assert list(found) == names
    absent = {name for name, value in found.items() if np.isnan(value)}
    assert absent == {"stop_absorbed_power", "stop_returned_power"}  # of stops nobody recorded
    found, use = measure_t_test(run(outcome=rollout.DIVERGED), PROTOCOL)
    assert list(found) == names
    assert use is None
    assert found["diverged"] == 1
    assert np.isnan(found["peak_speed"])


def test_standing_does_not_reach_a_waypoint(design):
    found = evaluate(
        standing(14),
        PROTOCOL.changed(trials=3, time_limit=15),
        design=design,
        task=load_task("goal"),
    )
    assert found.outcomes == ["fell"] * 3
    assert found.values("waypoints_reached").tolist() == [0] * 3
    assert np.isnan(found.values("time")).all()


def test_the_course_is_the_protocols(design):
    protocol = PROTOCOL.changed(
        points={"S": (1.0, 1.0), "G": (4.0, 1.0)}, order=("S", "G"), arrival=0.3
    )
    task = t_test_task(load_task("goal"), protocol)
    assert task.commands.courses == (((3.0, 0.0),),)
    assert (task.commands.course_share, task.commands.arrival) == (1.0, 0.3)


def test_simulation_and_measures_agree_on_arrivals(design):
    """A waypoint so near that a falling robot reaches it: judged by the simulation and found in the
    record alike.
    """
    protocol = PROTOCOL.changed(
        trials=6,
        points={"A": (0.0, 0.0), "B": (0.5, 0.0), "C": (3.0, 0.0)},
        order=("A", "B", "C"),
        arrival=0.4,
    )
    found = evaluate(standing(14), protocol, design=design, task=load_task("goal"))
    times = found.values("waypoint_1")
    assert np.isfinite(times).any()
    for trial, time in zip(found.trials, times, strict=True):
        away = np.linalg.norm(trial.base_position[:, :2] - trial.base_position[0, :2], axis=-1)
        if np.isfinite(time):
            assert away[round(time / trial.time_step)] > 0.09
            assert time / 0.02 == pytest.approx(round(time / 0.02))


@pytest.mark.parametrize("protocol", ["t_test", PROTOCOL])
def test_a_task_without_waypoints_is_refused(design, protocol):
    with pytest.raises(InputError, match="expects waypoints"):
        evaluate(standing(14), protocol, design=design, task=load_task("walk"))
