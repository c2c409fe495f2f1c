"""Where a recorded robot and its solids are at some samples of a motion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from hyperleg_design.evaluation.motion.bearing import headings
from hyperleg_design.report.pictures.picture import Solid
from hyperleg_design.report.pictures.solids import robot_solids
from hyperleg_design.robot.kinematics.tree import build_tree


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
        """Orientation of the base in the world, unit quaternions w x y z, `(t, 4)`."""

    @property
    def joint_position(self) -> np.ndarray:
        """Positions of the joints [rad], `(t, J)`."""


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


def level(
    trial: Moving, samples: np.ndarray, ahead: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Compute where the pelvis is, seen from the start, with x in a direction.

    Args:
        trial: the motion.
        samples: f indices.
        ahead: cosine and sine of the direction; by default that of the robot at the start.

    Returns:
        Places [m] and rotations, `(f, 3)` and `(f, 3, 3)`.
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


def posed(
    trial: Moving, samples: np.ndarray, turn: np.ndarray, place: np.ndarray
) -> tuple[tuple[Solid, ...], np.ndarray, np.ndarray]:
    """Compute where the solids of the robot are at some samples.

    Args:
        trial: the motion.
        samples: f indices.
        turn: rotation of the pelvis, `(f, 3, 3)`.
        place: of the pelvis [m], `(f, 3)`.

    Returns:
        The k solids, their rotations `(f, k, 3, 3)`, and their positions [m], `(f, k, 3)`.
    """
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
