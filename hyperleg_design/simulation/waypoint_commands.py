"""Commands to reach waypoints one after the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.parameters.fields import number
from hyperleg_design.robot.parameters.values import Checked
from hyperleg_design.simulation.state import Goal, Motion, to_world, to_yaw_frame
from hyperleg_design.simulation.stepping.streams import Random, of_rows

SIGHT = 3.0
"""Length to which the observed offset of a waypoint is clipped [m]; assumed."""


@dataclass(frozen=True, eq=False, kw_only=True)
class WaypointCommands(Checked):
    """Waypoints drawn ahead of the robot without end, or the points of a course."""

    near: Any = number("m", 0.5, 100, default=2.0)
    """Least distance of a drawn waypoint from the last [m]."""
    far: Any = number("m", 0.5, 100, default=9.0)
    """Largest distance of a drawn waypoint from the last [m]."""
    bearing: Any = number("rad", 0, 3.1416, default=3.1416)
    """Largest turn at a drawn waypoint, either way [rad]."""
    arrival: Any = number("m", 0.01, 5, default=0.5)
    """Distance that counts as reached, sigma_arr [m]; the paper does not print it."""
    speed_cap: Any = number("m/s", 0.1, 10, default=3.4)
    """Largest speed that is asked for [m/s]."""
    slower: Any = number("m/s", 0, 10, default=0.0)
    """How much slower the speed may be that an episode asks for, drawn evenly [m/s]. A policy that
    only ever saw one speed fails at any other."""
    course_share: Any = number("", 0, 1, default=0.0)
    """Fraction of episodes that run a course [-]."""
    courses: tuple[tuple[tuple[float, float], ...], ...] = ()
    """Courses: points [m] in a frame at the start, x ahead."""

    def __post_init__(self) -> None:
        # Qualified, because a dataclass of its own cannot reach its base by `super()` before it is
        # made.
        Checked.__post_init__(self)
        for course in self.courses:
            points = np.asarray(course, float)
            if (
                points.ndim != 2
                or points.shape[1] != 2
                or not len(points)
                or not np.all(np.isfinite(points))
            ):
                raise InputError("waypoints", "courses", course, "expects points [x, y] in metres")
            legs = np.linalg.norm(np.diff(points, axis=0, prepend=np.zeros((1, 2))), axis=1)
            if np.any(legs <= self.arrival):
                raise InputError(
                    "waypoints",
                    "courses",
                    course,
                    f"has a leg no longer than the arrival radius, {self.arrival} m",
                )
        if np.any(np.asarray(self.slower) >= self.speed_cap):
            raise InputError(
                "waypoints", "slower", self.slower, f"expects less than speed_cap, {self.speed_cap}"
            )
        if self.course_share and not self.courses:
            raise InputError("waypoints", "course_share", self.course_share, "needs courses")


class WaypointCommander:
    """Commands that lead each robot through waypoints in the world."""

    turns = True

    def __init__(self, settings: WaypointCommands, count: int) -> None:
        self.settings = settings
        self.last, self.target, self.following = (
            np.zeros((count, 2)),
            np.zeros((count, 2)),
            np.zeros((count, 2)),
        )
        self.best = np.zeros(count)
        """Least distance to the waypoint so far, d* [m]."""
        self.reached = np.zeros(count, int)
        """Waypoints reached in the episode."""
        self.course = np.full(count, -1)
        """Course that each simulation runs; -1 for none."""
        self.slower = np.zeros(count)
        """How much less than the largest speed each simulation is asked for [m/s]."""
        self._origin, self._heading = np.zeros((count, 2)), np.zeros((count, 2))

    def reset(self, ids: np.ndarray, motion: Motion, rng: Random) -> Goal:
        """Give first waypoints, ahead of where the robots stand.

        Args:
            ids: indices of the simulations.
            motion: of these simulations, in the same order.
            rng: random numbers.

        Returns:
            Where they stand to their waypoints.
        """
        count, s = len(ids), self.settings
        here = motion.position[:, :2]
        self._origin[ids], self._heading[ids], self.last[ids], self.reached[ids] = (
            here,
            motion.heading,
            here,
            0,
        )
        on_course = rng.uniform(size=count) < s.course_share
        self.course[ids] = np.where(on_course, rng.integers(max(len(s.courses), 1), size=count), -1)
        self.target[ids] = self._drawn(here, motion.heading, rng)
        self.following[ids] = self._drawn(self.target[ids], _unit(self.target[ids] - here), rng)
        self._from_course(ids)
        self.slower[ids] = s.slower * rng.uniform(size=count) if s.slower else 0.0
        goal = self._seen(ids, here, motion.heading)
        self.best[ids] = goal.distance
        return goal

    def judge(self, motion: Motion) -> Goal:
        """Compute distances, progress and arrivals, and bring the best distance up to date.

        Args:
            motion: of all simulations.

        Returns:
            Where they stand to their waypoints.
        """
        goal = self._seen(slice(None), motion.position[:, :2], motion.heading)
        goal.progress = np.maximum(self.best - goal.distance, 0.0)
        goal.arrived = goal.distance < self.settings.arrival
        goal.finished = goal.arrived & (self.reached + 1 == self._course_length())
        self.best = np.minimum(self.best, goal.distance)
        return goal

    def advance(self, motion: Motion, goal: Goal | None, duration: float, rng: Random) -> None:
        """Give the next waypoint to those that arrived; a finished course keeps its last.

        Args:
            motion: of all simulations.
            goal: as judged; rows that get a new waypoint then describe that.
            duration: of the policy step [s].
            rng: random numbers.
        """
        assert goal is not None
        ids = np.flatnonzero(goal.arrived & ~goal.finished)
        if not len(ids):
            return
        rng = of_rows(rng, ids)
        self.reached[ids] += 1
        self.last[ids], self.target[ids] = self.target[ids], self.following[ids]
        self.following[ids] = self._drawn(
            self.target[ids], _unit(self.target[ids] - self.last[ids]), rng
        )
        self._from_course(ids)
        here = motion.position[ids, :2]
        self.best[ids] = np.linalg.norm(self.target[ids] - here, axis=1)
        goal.put(ids, self._seen(ids, here, motion.heading[ids]))

    def vector(self, goal: Goal | None, ids: np.ndarray | None = None) -> np.ndarray:
        """Compute the offset to the waypoint, clipped to `SIGHT`, and the heading error.

        Args:
            goal: of the simulations `ids`, or of all.
            ids: indices of the simulations; all by default.

        Returns:
            Offset in the yaw frame [m] and heading error [rad], `(n, 3)`.
        """
        assert goal is not None
        return np.column_stack([clipped(goal.offset), goal.heading_error])

    def wanted(self, goal: Goal | None) -> np.ndarray:
        """Go ahead at the speed cap where the waypoint lies ahead, slower where it lies aside, and
        not at all where it lies behind.

        Args:
            goal: of all simulations.

        Returns:
            Speed [m/s], `(n,)`.
        """
        assert goal is not None
        return goal.speed_cap * np.maximum(np.cos(goal.heading_error), 0.0)

    def _seen(self, ids: Any, here: np.ndarray, heading: np.ndarray) -> Goal:
        offset = to_yaw_frame(heading, self.target[ids] - here)
        to_path = to_yaw_frame(heading, to_segment(here, self.last[ids], self.target[ids]))
        none = np.zeros(len(here), bool)
        return Goal(
            offset=offset,
            distance=np.hypot(offset[:, 0], offset[:, 1]),
            heading_error=np.arctan2(offset[:, 1], offset[:, 0]),
            following=to_yaw_frame(heading, self.following[ids] - here),
            speed_cap=self.settings.speed_cap - self.slower[ids],
            progress=np.zeros(len(here)),
            arrived=none,
            to_path=to_path,
            deviation=np.hypot(to_path[:, 0], to_path[:, 1]),
            finished=none.copy(),
        )

    def _drawn(self, start: np.ndarray, direction: np.ndarray, rng: Random) -> np.ndarray:
        s, count = self.settings, len(start)
        distance, turn = (
            rng.uniform(s.near, s.far, count),
            rng.uniform(-s.bearing, s.bearing, count),
        )
        return start + distance[:, None] * to_world(
            direction, np.column_stack([np.cos(turn), np.sin(turn)])
        )

    def _course_length(self) -> np.ndarray:
        lengths = np.array([len(c) for c in self.settings.courses] + [0])
        return np.asarray(lengths[self.course])

    def _from_course(self, ids: np.ndarray) -> None:
        """Target and the one after it from the course, where there is one; the last point follows
        itself.
        """
        for which, points in enumerate(self.settings.courses):
            chosen = ids[self.course[ids] == which]
            for array, ahead in ((self.target, 0), (self.following, 1)):
                index = np.minimum(self.reached[chosen] + ahead, len(points) - 1)
                array[chosen] = self._origin[chosen] + to_world(
                    self._heading[chosen], np.asarray(points, float)[index]
                )


def clipped(offset: np.ndarray) -> np.ndarray:
    """Shorten offsets to `SIGHT` where they are longer.

    Args:
        offset: `(n, 2)` [m].

    Returns:
        The shortened offsets, `(n, 2)` [m].
    """
    length = np.hypot(offset[:, 0], offset[:, 1])
    return offset * np.minimum(1.0, SIGHT / np.maximum(length, 1e-9))[:, None]


def to_segment(point: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Compute the vectors from points to the nearest points of straight segments.

    Args:
        point: `(n, 2)` [m].
        start: of each segment, `(n, 2)` [m].
        end: of each segment, `(n, 2)` [m].

    Returns:
        The vectors, `(n, 2)` [m].
    """
    along = end - start
    length = np.maximum(np.einsum("ni,ni->n", along, along), 1e-12)
    share = np.clip(np.einsum("ni,ni->n", point - start, along) / length, 0.0, 1.0)
    return np.asarray(start + share[:, None] * along - point)


def _unit(vector: np.ndarray) -> np.ndarray:
    return np.asarray(vector / np.maximum(np.linalg.norm(vector, axis=1), 1e-9)[:, None])
