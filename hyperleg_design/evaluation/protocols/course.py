"""A course of straight legs between waypoints, and how a path keeps to it."""

from __future__ import annotations

from typing import Any

import numpy as np


def segment_distances(points: Any, course: Any) -> np.ndarray:
    """Distance of points from each leg of a course [m].

    Args:
        points: `(..., 2)` [m].
        course: waypoints, `(k, 2)` [m].

    Returns:
        `(..., k - 1)`
    """
    points, course = np.asarray(points, float), np.asarray(course, float)
    begin, along = course[:-1], np.diff(course, axis=0)
    offset = points[..., None, :] - begin
    square = np.maximum(np.einsum("ki,ki->k", along, along), 1e-18)
    portion = np.clip(np.einsum("...ki,ki->...k", offset, along) / square, 0.0, 1.0)
    return np.asarray(np.linalg.norm(offset - portion[..., None] * along, axis=-1))


def course_deviation(points: Any, course: Any) -> np.ndarray:
    """Compute the distance of points from the nearest leg of a course.

    Args:
        points: `(..., 2)` [m].
        course: waypoints of the course in order, `(k, 2)` [m].

    Returns:
        The distances, `(...)` [m].
    """
    return np.asarray(segment_distances(points, course).min(-1))


def leg_deviation(points: Any, course: Any, leg: Any) -> np.ndarray:
    """Compute the distance of points from the leg of a course that is being run.

    Args:
        points: positions at each sample, `(t, 2)` [m].
        course: waypoints of the course in order, `(k, 2)` [m].
        leg: index of the leg being run at each sample, `(t,)`.

    Returns:
        The distances, `(t,)` [m].
    """
    return np.asarray(
        np.take_along_axis(segment_distances(points, course), np.asarray(leg, int)[:, None], 1)[
            :, 0
        ]
    )


def course_length(course: Any) -> float:
    """Compute the length of a course.

    Args:
        course: waypoints in order, `(k, 2)` [m].

    Returns:
        Sum of the lengths of the legs [m].
    """
    return path_length(course)


def path_length(points: Any) -> float:
    """Compute the length of the straight lines through points.

    Args:
        points: in order, `(t, 2)` [m].

    Returns:
        The length [m].
    """
    return float(np.linalg.norm(np.diff(np.asarray(points, float), axis=0), axis=-1).sum())


def arrivals(points: Any, course: Any, radius: float) -> np.ndarray:
    """First samples within the radius of each waypoint after the start, one after the other; -1
    where never.

    A waypoint counts only from the sample after that at which the one before was reached.

    Args:
        points: `(t, 2)` [m].
        course: waypoints, the first where the run starts, `(k, 2)` [m].
        radius: [m]

    Returns:
        `(k - 1,)`
    """
    points, course = np.asarray(points, float), np.asarray(course, float)
    reached = np.full(len(course) - 1, -1)
    begin = 0
    for i, waypoint in enumerate(course[1:]):
        near = np.flatnonzero(np.linalg.norm(points[begin:] - waypoint, axis=-1) < radius)
        if not len(near):
            break
        reached[i] = begin + near[0]
        begin = reached[i] + 1
    return reached


def legs_run(reached: Any, samples: int) -> np.ndarray:
    """Find the leg that is being run at each sample.

    Args:
        reached: samples at which the waypoints after the start were reached, `(waypoints,)`; -1 for
            never.
        samples: number of samples.

    Returns:
        Index of the leg at each sample, `(samples,)`.
    """
    reached = np.asarray(reached, int)
    changes = reached[:-1][reached[:-1] >= 0]
    return np.searchsorted(changes, np.arange(samples), side="right")


def crossing_time(distance: Any, length: float, time_step: float) -> float:
    """Compute the time at which a distance first reaches a length, linearly between samples.

    Args:
        distance: of each sample, `(t,)` [m].
        length: [m]
        time_step: between samples [s].

    Returns:
        The time [s]; NaN where the length is never reached.
    """
    distance = np.asarray(distance, float)
    beyond = np.flatnonzero(distance >= length)
    if not len(beyond):
        return np.nan
    i = int(beyond[0])
    if i == 0:
        return 0.0
    return float((i - 1 + (length - distance[i - 1]) / (distance[i] - distance[i - 1])) * time_step)


def in_start_frame(position: Any, start: Any, heading: Any) -> np.ndarray:
    """Transform points of the world into the frame of the start, with x ahead and y to the left.

    Args:
        position: `(..., 2)` [m].
        start: origin, `(2,)` [m].
        heading: cosine and sine of the yaw at the start, `(2,)`.

    Returns:
        The points in the frame of the start, `(..., 2)` [m].
    """
    offset = np.asarray(position, float) - np.asarray(start, float)
    cosine, sine = np.asarray(heading, float)
    return np.stack(
        [
            cosine * offset[..., 0] + sine * offset[..., 1],
            cosine * offset[..., 1] - sine * offset[..., 0],
        ],
        -1,
    )
