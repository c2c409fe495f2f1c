"""A recorded motion as the page plays it: where the robot is, and what acts on it, over time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial.transform import Rotation

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.log import Log, read_log
from hyperleg_design.robot.kinematics.posture import Pose, link_poses, lowest_point
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.models import quaternion_matrix

if TYPE_CHECKING:
    from hyperleg_design.robot.kinematics.kinematic_tree import Tree
    from hyperleg_design.robot.parameters.described import RobotDesign


@dataclass(frozen=True, eq=False)
class RecordedWalk:
    """A log and the robot that it is of."""

    log: Log
    """Positions of all moving joints; the base's pose, motor signals and contact forces where
    known."""
    design: RobotDesign
    """The robot that was recorded."""
    caption: str = ""
    """What is shown, for people."""

    def __post_init__(self) -> None:
        """Check that the log holds the robot's joints.

        Raises:
            InputError: a joint without a known position.
        """
        for joint in self._joints:
            if not self.log.has("position", joint):
                raise InputError(
                    self.log.name,
                    f"position/{joint}",
                    None,
                    f"is missing for {self.design.name}; name the robot that was recorded",
                )

    @property
    def duration(self) -> float:
        """From the first to the last tick [s]."""
        return float(self.log.time[-1] - self.log.time[0])

    def row(self, time: float) -> int:
        """Find the last tick at or before a time.

        Args:
            time: from the start [s].

        Returns:
            Its index.
        """
        at = int(np.searchsorted(self.log.time - self.log.time[0], time, "right")) - 1
        return min(max(at, 0), len(self.log.time) - 1)

    @cached_property
    def _joints(self) -> tuple[str, ...]:
        """Moving joints of the robot, in the tree's order."""
        return tuple(joint.name for joint in build_tree(self.design).moving)

    def angles(self, row: int) -> dict[str, float]:
        """Look up the joint angles at a tick.

        Args:
            row: index of the tick.

        Returns:
            Angles by joint [rad]; zero where the log does not know one.
        """
        values = (self.log.column(f"position/{name}")[row] for name in self._joints)
        return {n: float(np.nan_to_num(v)) for n, v in zip(self._joints, values, strict=True)}

    def base(self, row: int) -> Pose | None:
        """Look up the pose of the base at a tick.

        Args:
            row: index of the tick.

        Returns:
            Rotation and position [m] in the world; None where the log does not know them.
        """
        if not (self.log.has("base_position", "x") and self.log.has("base_orientation", "w")):
            return None
        quaternion = self.log.vector("base_orientation")[row]
        position = self.log.vector("base_position")[row]
        if not np.isfinite([*quaternion, *position]).all():
            return None
        return quaternion_matrix(np.roll(quaternion, -1)), position

    def contacts(
        self, row: int, tree: Tree, poses: Mapping[str, Pose]
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """Compute the contact forces at a tick.

        Forces of the pads of one link are added, at their centre of pressure.

        Args:
            row: tick.
            tree: of the robot.
            poses: of its links in the base's frame.

        Returns:
            Point in the base's frame [m] and force in the world [N] of each contact.
        """
        feet = self.log.feet
        contacts = []
        for link in tree.links:
            places: list[Any] = []
            forces: list[np.ndarray] = []
            for number, pad in enumerate(link.pads):
                name = f"{link.name}_pad_{number}"
                if name in feet:
                    places.append(np.array(pad.position))
                    forces.append(_force(self.log, name, row))
            if not places and link.name in feet:
                places = [
                    np.array([pad.position for pad in link.pads] or [(0.0, 0.0, 0.0)]).mean(0)
                ]
                forces = [_force(self.log, link.name, row)]
            total = np.sum(forces, axis=0) if forces else np.zeros(3)
            if np.linalg.norm(total) < 1.0:
                continue
            weight = np.maximum(np.array(forces)[:, 2], 1e-9)
            rotation, position = poses[link.name]
            place = (np.array(places) * weight[:, None]).sum(0) / weight.sum()
            contacts.append((position + rotation @ place, total))
        return contacts

    def moving(self, rate: float) -> Poses:
        """Sample the motion at even times; a base that the log does not know stands still and
        upright.

        Args:
            rate: samples a second.

        Returns:
            Poses over time.
        """
        rows = [self.row(t) for t in np.arange(0.0, self.duration + 1e-9, 1 / rate)]
        still = np.eye(3), np.array([0.0, 0.0, -lowest_point(*self._first())])
        poses = [self.base(row) or still for row in rows]
        turns = Rotation.from_matrix([turn for turn, _ in poses]).as_quat()
        joints = tuple(self.angles(rows[0]))
        return Poses(
            self.design,
            joints,
            1 / rate,
            np.array([place for _, place in poses]),
            np.asarray(turns)[:, [3, 0, 1, 2]],
            np.array([list(self.angles(row).values()) for row in rows]),
        )

    def _first(self) -> tuple[Tree, dict[str, Pose]]:
        tree = build_tree(self.design)
        return tree, link_poses(tree, self.angles(0))

    def motor_points(self, motor: str) -> tuple[np.ndarray, np.ndarray]:
        """Look up the operating points of a motor.

        Args:
            motor: name of the motor.

        Returns:
            Speeds [rad/s] and torques [Nm] at all ticks, `(t,)` each; NaN where unknown.
        """
        return self.log.column(f"motor_velocity/{motor}"), self.log.column(f"motor_torque/{motor}")


@dataclass(frozen=True, eq=False)
class Poses:
    """A recording at even times, as `pictures.motion` animates it."""

    design: Any
    joints: tuple[str, ...]
    time_step: float
    """Between samples [s]."""
    base_position: np.ndarray
    """[m], `(t, 3)`."""
    base_orientation: np.ndarray
    """w x y z, `(t, 4)`."""
    joint_position: np.ndarray
    """[rad], `(t, J)`."""

    @property
    def samples(self) -> int:
        """The number of samples in each signal."""
        return len(self.base_position)


def _force(log: Log, name: str, row: int) -> np.ndarray:
    columns = [log.column(f"contact_force/{name}_{axis}")[row] for axis in "xyz"]
    return np.nan_to_num(np.array(columns))


def walk_of_file(path: str | Path, design: RobotDesign | None = None) -> RecordedWalk:
    """Read the motion in a Parquet log, such as `hyperleg evaluate --logs` writes.

    Args:
        path: of the log.
        design: the robot that was recorded; what the log names by default.

    Returns:
        The motion.

    Raises:
        InputError: no whole log, no robot, or a robot whose joints the log does not hold.
    """
    log = read_log(path)
    if design is None:
        name = log.metadata.robot
        if not name:
            raise InputError(log.name, "robot", None, "is not named in the log; give a design")
        beside = Path(log.folder or Path(path).parent) / name
        design = load_robot(beside if beside.exists() else name, overrides=log.metadata.overrides)
    return RecordedWalk(log, design, f"recording {Path(path).name}")


def walk_of_policy(
    policy: str | Path, design: Any = None, *, protocol: str | None = None, seed: int | None = None
) -> RecordedWalk:
    """Run one trial of a policy.

    Args:
        policy: ONNX file, or name of a shipped training such as walk_upright-toe-1.
        design: robot to run it on; the policy's own by default.
        protocol: walk, t_test, or a YAML file; what suits the policy's task by default.
        seed: of the starting state; the protocol's by default.

    Returns:
        Its motion.

    Raises:
        InputError: no such policy, or one that does not fit the robot.
    """
    from hyperleg_design.gap.logs.recording import log_of_trial
    from hyperleg_design.report.pictures.replay import replay

    shown = replay(policy, protocol, seed=seed, design=design)
    outcome = shown.outcomes[0].replace("_", " ")
    return RecordedWalk(
        log_of_trial(shown.trials[0], name=str(shown.policy)),
        shown.trials[0].design,
        f"{shown.policy}: {outcome} after {shown.end_times[0]:.2f} s",
    )
