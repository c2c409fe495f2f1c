"""Starting states: robots on the floor near their default posture, standing or in mid-stride."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.simulation import human_gait
from hyperleg_design.simulation.layout import Layout
from hyperleg_design.simulation.stepping.streams import RowStreams
from hyperleg_design.simulation.tasks import Task

if TYPE_CHECKING:
    import mujoco


@dataclass(frozen=True, eq=False)
class Start:
    """States in which some simulations start."""

    position: np.ndarray
    """MuJoCo's `(n, 7 + J)`."""
    velocity: np.ndarray
    """MuJoCo's `(n, 6 + J)`."""
    phase: np.ndarray
    """Phase of the gait clock, `(n,)`."""
    smoothed: np.ndarray
    """Smoothed actions that hold the joints there, `(n, J)`."""


class Starter:
    """Draws starting states, and finds with MuJoCo how high each robot stands on the floor.

    Args:
        task: states how far the states are spread.
        layout: of all simulations.
        models: one for all simulations, or one each.
        batch: a batch of these models that is used for nothing else.
    """

    def __init__(
        self, task: Task, layout: Layout, models: Sequence[mujoco.MjModel], batch: Any
    ) -> None:
        self.task, self.layout, self._batch = task, layout, batch
        # What is bound is copied out after each of the batch's steps.
        self._places, self._tried = batch.bind("geom_xpos"), batch.bind("qpos")
        self.pads = [models[0].geom(pad).id for pad in layout.pads]
        """MuJoCo's numbers of the pads."""
        self.pad_radius = np.array([m.geom_size[self.pads[0], 0] for m in models])
        """`(1,)` or one for each simulation [m]."""
        start, joints = task.start, len(layout.joints)
        self._spread = np.r_[
            [start.joint_position] * joints,
            [start.joint_velocity] * joints,
            [start.linear_velocity] * 2,
            [start.tilt] * 2,
            start.yaw,
        ]

    def draw(self, ids: np.ndarray, position: np.ndarray, rng: RowStreams) -> Start:
        """Draw the states of some simulations.

        Args:
            ids: the simulations, `(n,)`.
            position: MuJoCo's default positions of these, `(n, 7 + J)`, which are changed.
            rng: random numbers of all simulations.

        Returns:
            The states, in the order of `ids`.
        """
        layout, count, joints = self.layout.take(ids), len(ids), len(self.layout.joints)
        drawn = rng.of(ids).uniform(-1.0, 1.0, (count, len(self._spread) + 1))
        offset = drawn[:, :-1] * self._spread
        velocity = np.zeros((count, 6 + joints))
        position[:, 7:] = np.minimum(
            np.maximum(position[:, 7:] + offset[:, :joints], layout.lower), layout.upper
        )
        position[:, 3:7] = _quaternion(*offset[:, -3:].T)
        velocity[:, 6:], velocity[:, :2] = (
            offset[:, joints : 2 * joints],
            offset[:, 2 * joints : 2 * joints + 2],
        )
        phase = 0.5 + 0.5 * drawn[:, -1]
        smoothed = self._stride(ids, position, velocity, phase, offset[:, -1], rng)
        self._tried[ids] = position
        self._batch.forward(ids, 1)
        radius = self.pad_radius[ids] if len(self.pad_radius) > 1 else self.pad_radius
        position[:, 2] -= self._places[ids][:, self.pads, 2].min(-1) - radius
        return Start(position, velocity, phase, smoothed)

    def _stride(
        self,
        ids: np.ndarray,
        position: np.ndarray,
        velocity: np.ndarray,
        clock: np.ndarray,
        yaw: np.ndarray,
        rng: RowStreams,
    ) -> np.ndarray:
        """Put some of the starting robots in mid-stride, in place, and their clock at that phase;
        the smoothed actions that hold them there, `(n, J)`, zero for those that stand.
        """
        smoothed = np.zeros((len(ids), len(self.layout.joints)))
        share = self.task.start.stride_share
        if not share:
            return smoothed
        drawn = rng.of(ids).uniform(size=(len(ids), 3))
        rows, layout = np.flatnonzero(drawn[:, 0] < share), self.layout.take(ids)
        places, angle, rate, speed, phase = human_gait.stride(layout.joints, drawn[rows, 1:])
        clock[rows] = phase
        lower, upper, default = (
            np.broadcast_to(limit, smoothed.shape)[np.ix_(rows, places)]
            for limit in (layout.lower, layout.upper, layout.default)
        )
        angle = np.clip(angle, lower, upper)
        position[np.ix_(rows, 7 + places)], velocity[np.ix_(rows, 6 + places)] = angle, rate
        velocity[rows, 0], velocity[rows, 1] = speed * np.cos(yaw[rows]), speed * np.sin(yaw[rows])
        smoothed[np.ix_(rows, places)] = (angle - default) / self.task.control.scale
        return smoothed


def _quaternion(roll: np.ndarray, pitch: np.ndarray, yaw: np.ndarray) -> np.ndarray:
    """Unit quaternions w x y z of yaw, then pitch, then roll, `(n, 4)`."""
    (cr, sr), (cp, sp), (cy, sy) = ((np.cos(a / 2), np.sin(a / 2)) for a in (roll, pitch, yaw))
    return np.stack(
        [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ],
        -1,
    )
