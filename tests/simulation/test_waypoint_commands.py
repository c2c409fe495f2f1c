import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.simulation.commands import commander
from hyperleg_design.simulation.state import read_motion
from hyperleg_design.simulation.waypoint_commands import (
    SIGHT,
    WaypointCommands,
    clipped,
    to_segment,
)

T_TEST = ((9.14, 0.0), (9.14, 4.57), (9.14, -4.57), (9.14, 0.0), (0.0, 0.0))


def at(places, yaw=0.0):
    places = np.atleast_2d(places)
    qpos = np.zeros((len(places), 21))
    qpos[:, :2], qpos[:, 3], qpos[:, 6] = places, np.cos(yaw / 2), np.sin(yaw / 2)
    return read_motion(qpos, np.zeros((len(places), 20)))


def test_waypoints_are_drawn_within_range_and_bearing():
    keeper, rng = (
        commander(WaypointCommands(near=2, far=5, bearing=0.5), 2000),
        np.random.default_rng(0),
    )
    keeper.reset(np.arange(2000), at(np.full((2000, 2), 3.0), yaw=1.0), rng)
    goal = keeper.judge(at(np.full((2000, 2), 3.0), yaw=1.0))
    assert goal.distance.min() > 2
    assert goal.distance.max() < 5
    assert np.abs(goal.heading_error).max() <= 0.5 + 1e-9
    assert np.abs(goal.heading_error).max() > 0.48
    np.testing.assert_allclose(goal.progress, 0)
    assert np.all(np.linalg.norm(keeper.vector(goal)[:, :2], axis=1) <= SIGHT + 1e-9)


def test_a_course_is_run_in_order_from_where_and_how_the_robot_stands():
    start, yaw = np.array([1.0, -2.0]), 0.7
    keeper, rng = (
        commander(WaypointCommands(course_share=1.0, courses=(T_TEST,)), 1),
        np.random.default_rng(0),
    )
    keeper.reset(np.array([0]), at(start, yaw), rng)
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    places = [start + turn @ p for p in T_TEST]
    for index, place in enumerate(places):
        goal = keeper.judge(at(place - turn @ [0.6, 0.0], yaw))
        assert not goal.arrived[0]
        goal = keeper.judge(at(place - turn @ [0.4, 0.0], yaw))
        assert goal.arrived[0]
        assert goal.finished[0] == (index == 4)
        keeper.advance(at(place, yaw), goal, 0.02, rng)
        if index < 4:
            np.testing.assert_allclose(keeper.target[0], places[index + 1])
            np.testing.assert_allclose(keeper.last[0], place)
            assert not goal.finished[0]
            np.testing.assert_allclose(goal.distance, np.linalg.norm(places[index + 1] - place))
    np.testing.assert_allclose(
        np.linalg.norm(np.diff(np.array([[0, 0], *T_TEST]), axis=0), axis=1).sum(), 36.56
    )


@pytest.mark.parametrize(("yaw", "share"), [(0.0, 1.0), (np.pi / 3, 0.5), (np.pi, 0.0)])
def test_an_assist_goes_ahead_only_where_the_waypoint_lies_ahead(yaw, share):
    keeper = commander(WaypointCommands(course_share=1.0, courses=(T_TEST,), speed_cap=3.0), 1)
    keeper.reset(np.array([0]), at([0.0, 0.0]), np.random.default_rng(0))
    goal = keeper.judge(at([0.0, 0.0], yaw))
    np.testing.assert_allclose(keeper.wanted(goal), 3.0 * share, atol=1e-9)


def test_each_episode_asks_for_a_speed_of_its_own():
    keeper = commander(WaypointCommands(speed_cap=3.8, slower=0.8), 1000)
    everyone, rng = np.arange(1000), np.random.default_rng(0)
    keeper.reset(everyone, at(np.zeros((1000, 2))), rng)
    caps = keeper.judge(at(np.zeros((1000, 2)))).speed_cap
    assert 3.0 <= caps.min() < 3.01 < 3.79 < caps.max() <= 3.8
    np.testing.assert_array_equal(keeper.judge(at(np.zeros((1000, 2)))).speed_cap, caps)
    keeper.reset(everyone[:500], at(np.zeros((500, 2))), rng)
    again = keeper.judge(at(np.zeros((1000, 2)))).speed_cap
    assert np.all(again[:500] != caps[:500])
    np.testing.assert_array_equal(again[500:], caps[500:])
    with pytest.raises(InputError, match="less than speed_cap"):
        WaypointCommands(speed_cap=3.0, slower=3.0)


def test_progress_is_counted_once():
    keeper, rng = (
        commander(WaypointCommands(course_share=1.0, courses=(((5.0, 0.0),),)), 1),
        np.random.default_rng(0),
    )
    keeper.reset(np.array([0]), at([0.0, 0.0]), rng)
    progress = [keeper.judge(at([x, 0.0])).progress[0] for x in (1.0, 0.5, 1.5, 1.5)]
    np.testing.assert_allclose(progress, [1.0, 0.0, 0.5, 0.0])


def test_unreachable_or_senseless_courses_are_refused():
    with pytest.raises(InputError, match="arrival radius"):
        WaypointCommands(courses=(((0.1, 0.0),),))
    with pytest.raises(InputError, match="needs courses"):
        WaypointCommands(course_share=0.5)
    with pytest.raises(InputError, match="points"):
        WaypointCommands(courses=(((np.nan, 0.0),),))


def test_vectors_to_a_segment():
    points = np.array([[1.0, 1.0], [-3.0, 4.0], [5.0, 0.0], [2.0, -0.5]])
    start, end = np.zeros((4, 2)), np.tile([4.0, 0.0], (4, 1))
    np.testing.assert_allclose(
        to_segment(points, start, end), [[0.0, -1.0], [3.0, -4.0], [-1.0, 0.0], [0.0, 0.5]]
    )
    np.testing.assert_allclose(to_segment(points, start, start), -points)


def test_the_path_is_seen_from_the_robot():
    """A robot that faces along y stands 1 m to the right of a path along x: the path is ahead."""
    keeper, rng = (
        commander(WaypointCommands(course_share=1.0, courses=(T_TEST,)), 1),
        np.random.default_rng(0),
    )
    keeper.reset(np.array([0]), at([0.0, 0.0]), rng)
    goal = keeper.judge(at([3.0, -1.0], yaw=np.pi / 2))
    np.testing.assert_allclose(goal.to_path, [[1.0, 0.0]], atol=1e-12)
    np.testing.assert_allclose(goal.deviation, [1.0])


def test_clipping_keeps_the_direction():
    offset = np.array([[6.0, 8.0], [0.3, 0.4], [0.0, 0.0]])
    np.testing.assert_allclose(clipped(offset), [[1.8, 2.4], [0.3, 0.4], [0.0, 0.0]])
