"""What terms of rewards, observations and terminations see of all simulations after a policy
step.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Self

import numpy as np


@dataclass(slots=True, eq=False)
class Rows:
    """Arrays with a row a simulation."""

    def put(self, ids: np.ndarray, other: Self) -> None:
        """Overwrite the rows of some simulations with rows of another state.

        Args:
            ids: indices of the simulations to overwrite, `(k,)`.
            other: the new rows, `(k, ...)` each.
        """
        for field in fields(self):
            getattr(self, field.name)[ids] = getattr(other, field.name)


@dataclass(slots=True, eq=False)
class Motion(Rows):
    """Where the robots are and how they move; `(n, ...)`. Yaw frame: the pelvis's, turned
    upright.
    """

    position: np.ndarray
    """Position of the pelvis in the world [m], `(n, 3)`."""
    rotation: np.ndarray
    """Pelvis to world, `(n, 3, 3)`."""
    velocity: np.ndarray
    """Velocity of the pelvis in the world [m/s], `(n, 3)`."""
    angular_velocity: np.ndarray
    """Angular velocity of the pelvis in its own frame [rad/s], `(n, 3)`."""
    heading: np.ndarray
    """Cosine and sine of the yaw angle, `(n, 2)`."""
    joint_position: np.ndarray
    """Joint angles [rad], `(n, J)`."""
    joint_velocity: np.ndarray
    """Joint speeds [rad/s], `(n, J)`."""

    @property
    def gravity(self) -> np.ndarray:
        """Unit vector of gravity in the pelvis's frame, `(n, 3)`; (0, 0, -1) upright."""
        return -self.rotation[:, 2]

    @property
    def local_velocity(self) -> np.ndarray:
        """Velocity in the pelvis's frame [m/s], `(n, 3)`."""
        return np.matmul(self.velocity[:, None], self.rotation)[:, 0]

    @property
    def walking_velocity(self) -> np.ndarray:
        """Horizontal velocity in the yaw frame [m/s], `(n, 2)`."""
        return to_yaw_frame(self.heading, self.velocity[:, :2])

    @property
    def yaw_rate(self) -> np.ndarray:
        """Angular velocity about the vertical [rad/s], `(n,)`."""
        return np.einsum("ni,ni->n", self.rotation[:, 2], self.angular_velocity)


@dataclass(slots=True, eq=False)
class Goal(Rows):
    """The waypoint of each simulation, as the step found it."""

    offset: np.ndarray
    """Vector from the pelvis to the waypoint in the yaw frame [m], `(n, 2)`."""
    distance: np.ndarray
    """Distance to the waypoint [m], `(n,)`."""
    heading_error: np.ndarray
    """Angle from the heading to the waypoint, counterclockwise [rad], `(n,)`."""
    following: np.ndarray
    """Vector from the pelvis to the waypoint after that, in the yaw frame [m], `(n, 2)`."""
    speed_cap: np.ndarray
    """Speed up to which speed toward the waypoint is asked for [m/s], `(n,)`."""
    progress: np.ndarray
    """How much closer this step came than any before, max(d* - d, 0) [m], `(n,)`."""
    arrived: np.ndarray
    """Whether this step reached it, `(n,)`."""
    to_path: np.ndarray
    """Vector from the pelvis to the nearest point of the straight line between the last waypoint
    and this one, in the yaw frame [m], `(n, 2)`."""
    deviation: np.ndarray
    """Length of that vector [m], `(n,)`."""
    finished: np.ndarray
    """Whether this step reached the last waypoint of a course, `(n,)`."""


@dataclass(slots=True, eq=False)
class Sensed:
    """What the robot's own sensors tell, where that is not the truth."""

    angular_velocity: np.ndarray
    """Angular velocity of the pelvis in its own frame [rad/s], `(n, 3)`."""
    gravity: np.ndarray
    """Unit vector of gravity in the pelvis's frame, `(n, 3)`."""
    joint_position: np.ndarray
    """Joint angles [rad], `(n, J)`."""
    joint_velocity: np.ndarray
    """Joint speeds [rad/s], `(n, J)`."""


@dataclass(slots=True, eq=False)
class State:
    """All that a policy step left; substeps s lead in what was recorded within it."""

    motion: Motion
    action: np.ndarray
    """Newest action, `(n, J)`."""
    previous_action: np.ndarray
    """The one before it, `(n, J)`."""
    command: np.ndarray
    """Forward, sideways [m/s] and turning [rad/s] speed; or offset to the waypoint (clipped) and
    heading error, `(n, 3)`."""
    motor_torque: np.ndarray
    """Motor torques [Nm], `(s, n, K)`."""
    motor_velocity: np.ndarray
    """Motor speeds [rad/s], `(s, n, K)`."""
    pad_load: np.ndarray
    """Vertical force on each sole pad [N], `(s, n, P)`."""
    foot_load: np.ndarray
    """Vertical force on each foot [N], `(s, n, F)`; of a biped left and right."""
    pad_slip: np.ndarray
    """Sliding speed of each touching pad, in the last substep [m/s], `(n, P)`."""
    power: np.ndarray
    """Joule heat plus signed mechanical power of all motors, mean over the substeps [W], `(n,)`."""
    thermal_excess: np.ndarray
    """Sum over motors of [-(dh/dt + h / T)]+ [1/s], `(n,)`."""
    phase: np.ndarray
    """Phase of the gait clock, 0 to 1, `(n,)`."""
    terminated: np.ndarray
    """Whether the robot has fallen, `(n,)`."""
    goal: Goal | None
    """Goals of tasks with waypoints; None in other tasks."""
    sensed: Sensed | None = None
    """What sensors tell of `motion`, where alterations make a difference."""


def read_motion(qpos: np.ndarray, qvel: np.ndarray) -> Motion:
    """Compute the motion of robots from MuJoCo's coordinates.

    Args:
        qpos: `(n, 7 + J)`.
        qvel: `(n, 6 + J)`.

    Returns:
        The motion; its arrays are copies.
    """
    w, x, y, z = np.ascontiguousarray(qpos[:, 3:7].T)
    rows = np.empty((3, 3, len(qpos)))  # simulations last, so that each entry is written in one run
    xx, yy, zz = 2 * x * x, 2 * y * y, 2 * z * z
    xy, xz, yz = 2 * x * y, 2 * x * z, 2 * y * z
    wx, wy, wz = 2 * w * x, 2 * w * y, 2 * w * z
    rows[0, 0], rows[0, 1], rows[0, 2] = 1 - yy - zz, xy - wz, xz + wy
    rows[1, 0], rows[1, 1], rows[1, 2] = xy + wz, 1 - xx - zz, yz - wx
    rows[2, 0], rows[2, 1], rows[2, 2] = xz - wy, yz + wx, 1 - xx - yy
    rotation = rows.transpose(2, 0, 1)
    forward = rotation[:, :2, 0]
    heading = forward / np.sqrt(np.maximum(np.einsum("ni,ni->n", forward, forward), 1e-18))[:, None]
    return Motion(
        qpos[:, :3].copy(),
        rotation,
        qvel[:, :3].copy(),
        qvel[:, 3:6].copy(),
        heading,
        qpos[:, 7:].copy(),
        qvel[:, 6:].copy(),
    )


def to_yaw_frame(heading: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Rotate horizontal vectors from the world into the yaw frame.

    Args:
        heading: cosine and sine of the yaw, `(n, 2)`.
        vector: in the world, `(n, 2)`.

    Returns:
        `(n, 2)`.
    """
    cosine, sine = heading[:, 0], heading[:, 1]
    turned = np.empty_like(vector)
    turned[:, 0] = cosine * vector[:, 0] + sine * vector[:, 1]
    turned[:, 1] = cosine * vector[:, 1] - sine * vector[:, 0]
    return turned


def to_world(heading: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Rotate horizontal vectors from the yaw frame into the world.

    Args:
        heading: cosine and sine of the yaw, `(n, 2)`.
        vector: in the yaw frame, `(n, 2)`.

    Returns:
        `(n, 2)`.
    """
    cosine, sine = heading[:, 0], heading[:, 1]
    turned = np.empty_like(vector)
    turned[:, 0] = cosine * vector[:, 0] - sine * vector[:, 1]
    turned[:, 1] = sine * vector[:, 0] + cosine * vector[:, 1]
    return turned
