"""Animations of recorded trials in three dimensions."""

from __future__ import annotations

import io
import os
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.protocol import TTestProtocol
from hyperleg_design.report.pictures.picture import Solid, drawn
from hyperleg_design.report.pictures.posing import Moving, level, posed, travel

_MARGIN = np.array([2.5, 0.7, 0.0])
_FLOOR, _GRID, _COURSE = "#eceef2", "#bcc2cc", "#c8602a"


@dataclass(frozen=True, eq=False)
class Motion:
    """What an animation shows; f frames, n moving solids."""

    solids: tuple[Solid, ...]
    """Their places are those of `rotations` and `positions`, `(n,)`."""
    rotations: np.ndarray
    """Rotations of the bodies in each frame, `(f, n, 3, 3)`."""
    positions: np.ndarray
    """Positions of the bodies in each frame [m], `(f, n, 3)`."""
    focus: np.ndarray
    """What the camera looks at [m], `(f, 3)`."""
    eye: np.ndarray
    """Camera from there [m], `(3,)`."""
    still: tuple[Solid, ...] = ()
    """What does not move."""
    lines: tuple[tuple[np.ndarray, np.ndarray, str, float], ...] = ()
    """Lines: start and end [m], colour, width [px]."""
    labels: tuple[tuple[np.ndarray, str, str], ...] = ()
    """Place [m], text, colour."""
    height: float = 1.3
    """What the picture's height spans [m]."""
    size: tuple[int, int] = (480, 360)
    """Width and height of a frame [px]."""
    font: int = 18
    frame_time: float = 0.04
    """Time between two frames as shown [s]."""


def drawn_frames(motion: Motion, path: str | os.PathLike[str]) -> np.ndarray:
    """Draw the frames of a motion.

    Args:
        motion: what to draw.
        path: for messages.

    Returns:
        Bytes, `(frames, height, width, 3)`.

    Raises:
        HyperlegError: this machine cannot draw.
    """
    return np.asarray(np.load(io.BytesIO(drawn(motion, path))))


def walk_motion(
    trial: Moving,
    *,
    begin: float = 5.0,
    duration: float = 3.0,
    frames_per_second: float = 20.0,
    size: tuple[int, int] = (480, 400),
) -> Motion:
    """Prepare the animation of a walk from the right side, with the camera beside the robot.

    Args:
        trial: the walk.
        begin: first time shown, or as much earlier as the trial is short [s].
        duration: shown [s].
        frames_per_second: of the animation, at true speed.
        size: of a frame [px].

    Returns:
        The motion to draw.

    Raises:
        InputError: a trial without samples.
    """
    samples = _samples(trial, begin, duration, frames_per_second)
    place, turn = level(trial, samples, travel(trial, samples))
    still, lines = _track(place)
    solids, rotations, positions = posed(trial, samples, turn, place)
    middle = _smooth(np.stack([place[:, 0], place[:, 1], np.full(len(place), 0.46)], -1), 21)
    return Motion(
        solids,
        rotations,
        positions,
        middle,
        np.array([0.8, -3.0, 0.5]),
        still,
        lines,
        (),
        1.25,
        size,
        16,
        1 / frames_per_second,
    )


def t_test_motion(
    trial: Moving,
    protocol: TTestProtocol,
    *,
    frames_per_second: float = 8.0,
    most_frames: int = 150,
    size: tuple[int, int] = (480, 360),
) -> Motion:
    """Prepare the animation of a run over a course, seen from above and aside; the camera follows.

    A long run is shown faster than it was.

    Args:
        trial: the run.
        protocol: gives the course.
        frames_per_second: of the animation.
        most_frames: of the animation.
        size: of a frame [px].

    Returns:
        The motion to draw.

    Raises:
        InputError: a trial without samples.
    """
    duration = trial.samples * trial.time_step
    rate = min(frames_per_second, most_frames / max(duration, 1e-9))
    samples = _samples(trial, 0.0, duration, rate)
    place, turn = level(trial, samples)
    solids, rotations, positions = posed(trial, samples, turn, place)
    course = protocol.course
    low, high = course.min(0) - 2.0, course.max(0) + 2.0
    floor = Solid(
        "box",
        (*map(float, high - low), 0.01),
        np.eye(3),
        np.array([*(low + high) / 2, -0.008]),
        _FLOOR,
    )
    grid = [
        (np.array([x, low[1], 0.0]), np.array([x, high[1], 0.0]), _GRID, 1.0)
        for x in np.arange(np.ceil(low[0]), high[0] + 1e-9)
    ]
    grid += [
        (np.array([low[0], y, 0.0]), np.array([high[0], y, 0.0]), _GRID, 1.0)
        for y in np.arange(np.ceil(low[1]), high[1] + 1e-9)
    ]
    legs = [
        (np.array([*a, 0.004]), np.array([*b, 0.004]), _COURSE, 3.0) for a, b in pairwise(course)
    ]
    posts = [
        Solid(
            "cylinder", (0.05, 0.3), np.eye(3), np.array([*_point(protocol, name), 0.15]), _COURSE
        )
        for name in protocol.points
    ]
    labels = tuple(
        (np.array([*_point(protocol, name), 0.42]), name, "#1d2129") for name in protocol.points
    )
    middle = np.stack([place[:, 0], place[:, 1], np.full(len(place), 0.4)], -1)
    return Motion(
        solids,
        rotations,
        positions,
        _smooth(middle),
        np.array([-3.2, -3.4, 2.6]),
        (floor, *posts),
        (*grid, *legs),
        labels,
        2.5,
        size,
        18,
        1 / frames_per_second,
    )


def _samples(trial: Moving, begin: float, duration: float, rate: float) -> np.ndarray:
    """Samples of the frames."""
    if not trial.samples:
        raise InputError("animation", "", None, "the trial has no samples")
    end = trial.samples * trial.time_step
    first = max(0.0, min(begin, end - duration))
    times = np.arange(first, min(first + duration, end), 1 / rate)
    return np.minimum((times / trial.time_step).round().astype(int), trial.samples - 1)


def _track(
    place: np.ndarray,
) -> tuple[tuple[Solid, ...], tuple[tuple[np.ndarray, np.ndarray, str, float], ...]]:
    """A strip of floor along a way `(f, 3)` [m], with a line every half metre."""
    (low, left, _), (high, right, _) = place.min(0) - _MARGIN, place.max(0) + _MARGIN
    floor = Solid(
        "box",
        (high - low, right - left, 0.01),
        np.eye(3),
        np.array([(low + high) / 2, (left + right) / 2, -0.008]),
        _FLOOR,
    )
    lines = tuple(
        (np.array([at, left, 0.0]), np.array([at, right, 0.0]), _GRID, 2.0)
        for at in np.arange(np.ceil(low * 2) / 2, high, 0.5)
    )
    return (floor,), lines


def _point(protocol: TTestProtocol, name: str) -> tuple[float, float]:
    start = protocol.points[protocol.order[0]]
    x, y = protocol.points[name]
    return x - start[0], y - start[1]


def _smooth(path: np.ndarray, width: int = 7) -> np.ndarray:
    """Moving mean, so that the camera does not shake, `(f, 3)`."""
    if len(path) < width:
        return path
    padded = np.concatenate(
        [np.repeat(path[:1], width // 2, 0), path, np.repeat(path[-1:], width // 2, 0)]
    )
    window = np.ones(width) / width
    return np.stack([np.convolve(padded[:, k], window, "valid") for k in range(path.shape[1])], -1)
