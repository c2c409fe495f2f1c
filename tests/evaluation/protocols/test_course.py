"""Courses: distances against brute force, arrivals and times on paths that are known."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.evaluation.protocol import TTestProtocol
from hyperleg_design.evaluation.protocols import course
from hyperleg_design.simulation.waypoint_commands import to_segment

T = TTestProtocol().course


def run_along(points, speed=2.0, step=0.02):
    """Path along a polyline at a speed."""
    legs = np.linalg.norm(np.diff(points, axis=0), axis=1)
    ends = np.r_[0, np.cumsum(legs)]
    way = np.arange(0, ends[-1] + 1e-9, speed * step)
    return np.column_stack([np.interp(way, ends, points[:, k]) for k in (0, 1)])


def test_the_t_test_is_the_human_one():
    assert course.course_length(T) == pytest.approx(2 * 9.14 + 4.57 + 9.14 + 4.57)
    assert T[0].tolist() == [0, 0]


def test_running_on_the_course_does_not_deviate():
    path = run_along(T)
    assert np.max(course.course_deviation(path, T)) < 1e-12
    assert course.path_length(path) == pytest.approx(
        course.course_length(T), abs=0.1
    )  # corners lie between samples


@given(st.integers(0, 2**31))
@settings(max_examples=20)
def test_distances_equal_brute_force_and_the_simulations(seed):
    rng = np.random.default_rng(seed)
    points, waypoints = rng.uniform(-5, 5, (6, 2)), rng.uniform(-5, 5, (4, 2))
    found = course.segment_distances(points, waypoints)
    share = np.linspace(0, 1, 4001)[:, None]
    for k in range(3):
        line = waypoints[k] + share * (waypoints[k + 1] - waypoints[k])
        brute = np.linalg.norm(points[:, None] - line, axis=-1).min(1)
        assert found[:, k] == pytest.approx(brute, abs=2e-3)
        ends = (np.broadcast_to(w, points.shape) for w in (waypoints[k], waypoints[k + 1]))
        assert found[:, k] == pytest.approx(np.linalg.norm(to_segment(points, *ends), axis=1))
    assert course.course_deviation(points, waypoints) == pytest.approx(found.min(1))


def test_a_parallel_path_deviates_by_its_offset():
    path = run_along(T[:2]) + np.array([0.0, 0.3])
    assert course.course_deviation(path, T[:2]) == pytest.approx(np.full(len(path), 0.3))


def test_waypoints_are_reached_in_order_when_the_radius_is_met():
    path = run_along(T)
    reached = course.arrivals(path, T, 0.5)
    step = 2.0 * 0.02
    ways = np.cumsum(np.linalg.norm(np.diff(T, axis=0), axis=1)) - 0.5
    assert np.all(reached * step > ways)
    assert np.all((reached - 1) * step <= ways + 1e-9)
    leg = course.legs_run(reached, len(path))
    assert leg[0] == 0
    assert leg[-1] == 4
    assert np.array_equal(np.flatnonzero(np.diff(leg)) + 1, reached[:-1])


def test_an_unreached_waypoint_stops_the_count():
    path = run_along(T[:3])
    reached = course.arrivals(path, T, 0.5)
    assert (reached >= 0).tolist() == [True, True, False, False, False]
    assert course.legs_run(reached, len(path))[-1] == 2


def test_passing_a_later_waypoint_early_does_not_count():
    square = np.array([[0, 0], [4, 0], [4, 4], [0, 4]], float)
    path = run_along(np.array([[0, 0], [0, 4], [4, 4]], float))
    assert course.arrivals(path, square, 0.5).tolist() == [-1, -1, -1]


def test_leg_deviation_follows_the_leg():
    path = run_along(T)
    reached = course.arrivals(path, T, 0.5)
    beside = course.leg_deviation(path, T, course.legs_run(reached, len(path)))
    assert (
        0.4 < beside.max() <= 0.5
    )  # within the radius of a waypoint the next leg is half a metre away
    assert np.median(beside) < 1e-9


def test_crossing_lies_between_samples():
    distance = np.array([0.0, 1.0, 2.0, 4.0, 4.0])
    assert course.crossing_time(distance, 3.0, 0.1) == pytest.approx(0.25)
    assert np.isnan(course.crossing_time(distance, 5.0, 0.1))
    assert course.crossing_time(distance, 0.0, 0.1) == 0


def test_start_frame_undoes_place_and_heading():
    angle, start = 2.2, np.array([3.0, -1.0])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    points = np.random.default_rng(0).uniform(-3, 3, (7, 2))
    world = points @ turn.T + start
    assert course.in_start_frame(world, start, [np.cos(angle), np.sin(angle)]) == pytest.approx(
        points
    )
