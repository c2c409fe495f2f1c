"""Recorded trials in three dimensions: a strip of snapshots over a gait cycle, and
animations.
"""

from __future__ import annotations

import io
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.bearing import headings
from hyperleg_design.evaluation.gait import strides
from hyperleg_design.evaluation.protocol import TTestProtocol
from hyperleg_design.evaluation.steps import measured_steps
from hyperleg_design.report.pictures.picture import Scene, Solid, drawn
from hyperleg_design.report.pictures.solids import PAD, robot_solids
from hyperleg_design.robot.tree import build_tree

if TYPE_CHECKING:
    from hyperleg_design.evaluation.rollout import Trial

SNAPSHOTS = 8
"""Number of snapshots of a strip, over one gait cycle from touchdown to touchdown of the right
foot."""
FORCE_LENGTH = 0.3
"""Length of an arrow for a force of one body weight [m]."""
_MARGIN = np.array([2.5, 0.7, 0.0])
_FLOOR, _GRID, _COURSE, _FORCE = "#eceef2", "#bcc2cc", "#c8602a", "#2c7a4b"


class Moving(Protocol):
    """What is animated: an evaluation's trial, or a recording."""

    @property
    def design(self) -> Any:
        """The robot that moves."""

    @property
    def joints(self) -> Sequence[str]:
        """Names of the joints."""

    @property
    def samples(self) -> int:
        """The number of samples in each signal."""

    @property
    def time_step(self) -> float:
        """The time between samples [s]."""

    @property
    def base_position(self) -> np.ndarray:
        """Positions of the base in the world [m], `(t, 3)`."""

    @property
    def base_orientation(self) -> np.ndarray:
        """W x y z, `(t, 4)`."""

    @property
    def joint_position(self) -> np.ndarray:
        """Positions of the joints [rad], `(t, J)`."""


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
    place, turn = _level(trial, samples, travel(trial, samples))
    still, lines = _track(place)
    solids, rotations, positions = _posed(trial, samples, turn, place)
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
    place, turn = _level(trial, samples)
    solids, rotations, positions = _posed(trial, samples, turn, place)
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


def strip_scene(walks: Mapping[str, tuple[Trial, Any]], snapshots: int = SNAPSHOTS) -> Scene:
    """Draw snapshots of one gait cycle from the right side, with the floor's force on each foot and
    one row for each walk.

    Args:
        walks: by label: a walk and the `Events` by which its steps are told.
        snapshots: in a row, equal shares of the cycle apart, both ends among them.

    Returns:
        The scene.

    Raises:
        InputError: a walk without two strides of the right foot.
    """
    gap, row_height = 0.72, 1.24
    solids: list[Solid] = []
    labels, arrows, lines = [], [], []
    for row, (name, (trial, events)) in enumerate(walks.items()):
        begins, ends = strides(measured_steps(trial, events), 1)
        if len(begins) < 2:
            raise InputError(
                "strip", "strides", len(begins), f"{name} has too few strides to show one"
            )
        middle = len(begins) // 2
        samples = np.linspace(begins[middle], ends[middle], snapshots).round().astype(int)
        samples = np.minimum(samples, trial.samples - 1)
        place, turn = _level(trial, samples, travel(trial, samples))
        shift = np.stack(
            [gap * np.arange(snapshots), np.zeros(snapshots), place[:, 2] - row * row_height], -1
        )
        height = -row * row_height
        kinds, rotations, positions = _posed(trial, samples, turn, shift)
        for i in range(snapshots):
            for solid, rotation, position in zip(kinds, rotations[i], positions[i], strict=True):
                solids.append(
                    Solid(solid.kind, solid.size, rotation, position, solid.colour, solid.opacity)
                )
            arrows += _force_arrows(
                trial, int(samples[i]), kinds, positions[i], travel(trial, samples), height
            )
            labels.append(
                (
                    np.array([gap * i - 0.05, -0.5, height - 0.07]),
                    f"{round(100 * i / (snapshots - 1))} %",
                    "#555555",
                )
            )
        lines.append(
            (
                np.array([-0.45, 0, height]),
                np.array([gap * (snapshots - 1) + 0.42, 0, height]),
                "#8b93a1",
                2.0,
            )
        )
        labels.append((np.array([-0.45, -0.5, height + 1.04]), name, "#1d2129"))
    width, count = gap * (snapshots - 1) + 0.95, len(walks)
    total = row_height * count + 0.06
    focus = (gap * (snapshots - 1) / 2 - 0.01, 0.0, row_height - total / 2 - 0.13 + 0.03)
    return Scene(
        tuple(solids),
        tuple(lines),
        tuple(labels),
        tuple(arrows),
        camera=((focus[0], -4.0, focus[2]), focus),
        height=total,
        size=(1500, int(1500 * total / width)),
        font=20,
    )


def _samples(trial: Moving, begin: float, duration: float, rate: float) -> np.ndarray:
    """Samples of the frames."""
    if not trial.samples:
        raise InputError("animation", "", None, "the trial has no samples")
    end = trial.samples * trial.time_step
    first = max(0.0, min(begin, end - duration))
    times = np.arange(first, min(first + duration, end), 1 / rate)
    return np.minimum((times / trial.time_step).round().astype(int), trial.samples - 1)


def travel(trial: Moving, samples: np.ndarray) -> np.ndarray:
    """Compute the direction of travel between the first and the last of some samples.

    Args:
        trial: the motion.
        samples: their indices.

    Returns:
        Cosine and sine of the direction, `(2,)`; those of the heading at the start if the robot
        stands.
    """
    way = trial.base_position[samples[-1], :2] - trial.base_position[samples[0], :2]
    length = float(np.linalg.norm(way))
    return np.asarray(way / length if length > 0.1 else headings(trial.base_orientation[0]))


def _level(
    trial: Moving, samples: np.ndarray, ahead: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Pelvis places [m] and rotations from the start, x in a direction, by default the robot's at
    the start, `(f, 3)` and `(f, 3, 3)`.
    """
    cosine, sine = headings(trial.base_orientation[0]) if ahead is None else ahead
    back = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    start = np.array([*trial.base_position[0, :2], 0.0])
    return (trial.base_position[samples] - start) @ back.T, back @ _matrices(
        trial.base_orientation[samples]
    )


def _matrices(orientation: np.ndarray) -> np.ndarray:
    """Rotations of quaternions w x y z, `(f, 4)` -> `(f, 3, 3)`."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_quat(orientation[:, [1, 2, 3, 0]]).as_matrix())


def _posed(
    trial: Moving, samples: np.ndarray, turn: np.ndarray, place: np.ndarray
) -> tuple[tuple[Solid, ...], np.ndarray, np.ndarray]:
    """The robot's solids, and where they are in each frame."""
    tree = build_tree(trial.design)
    frames = []
    for i, sample in enumerate(samples):
        angles = dict(zip(trial.joints, map(float, trial.joint_position[sample]), strict=True))
        frames.append(
            robot_solids(trial.design, angles=angles, tree=tree, pelvis=(turn[i], place[i]))
        )
    rotations = np.array([[s.rotation for s in frame] for frame in frames])
    positions = np.array([[s.position for s in frame] for frame in frames])
    return tuple(frames[0]), rotations, positions


def _force_arrows(
    trial: Trial,
    sample: int,
    kinds: Sequence[Solid],
    positions: np.ndarray,
    heading: np.ndarray,
    floor: float,
) -> list[Any]:
    """Force on each foot at its centre of pressure, one body weight `FORCE_LENGTH` long, in the
    plane of the picture.
    """
    pads = [i for i, solid in enumerate(kinds) if solid.kind == "sphere" and solid.colour == PAD]
    if len(pads) != len(trial.layout.pads):
        return []
    arrows = []
    for foot in range(len(trial.layout.feet)):
        mine = trial.layout.pad_foot == foot
        force = trial.pad_force[sample, mine]
        if force[:, 2].sum() < 0.05 * trial.layout.weight:
            continue
        places = positions[np.array(pads)[mine]]
        centre = (places * force[:, 2:]).sum(0) / force[:, 2].sum()
        total = force.sum(0)
        vector = (
            FORCE_LENGTH
            / trial.layout.weight
            * np.array([float(heading @ total[:2]), 0.0, float(total[2])])
        )
        arrows.append((np.array([centre[0], -0.3, floor]), vector, _FORCE))
    return arrows


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
