"""Torques of joints on which a design counts: the `derate` of what their motors give together."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.robot import transmission
from hyperleg_design.sizing import zonotope

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign


@dataclass(frozen=True, eq=False)
class DeratedTorques:
    """Limits of the joints whose motors are not counted on in full."""

    rows: np.ndarray
    """Numbers of the joints, `(k,)`."""
    names: tuple[str, ...]
    """Names of the joints."""
    lower: np.ndarray
    """Least joint torques [Nm], `(k,)`."""
    upper: np.ndarray
    """Largest joint torques [Nm], `(k,)`."""

    def reached(self, joint_torque: np.ndarray, share: float) -> tuple[str, ...]:
        """Find the joints that are at a limit.

        Args:
            joint_torque: of all joints of the limb [Nm], `(joints,)`.
            share: distance to a limit, over the range between the two, that counts as there [-].

        Returns:
            Their names.
        """
        torque = joint_torque[self.rows]
        rest = np.minimum(self.upper - torque, torque - self.lower)
        near = rest < share * (self.upper - self.lower)
        return tuple(name for name, at_limit in zip(self.names, near, strict=True) if at_limit)


def derated_torques(design: RobotDesign, lower: np.ndarray, upper: np.ndarray) -> DeratedTorques:
    """Compute what a design counts on at its derated joints, in the posture of its reductions.

    At standstill these torques are plus and minus `transmission.max_joint_torque` in that posture.
    A torque with which motors brake in any case, past their no-load speed, is not derated.

    Args:
        design: one robot.
        lower: least motor torques [Nm], `(motors,)`.
        upper: largest motor torques [Nm], `(motors,)`.

    Returns:
        Limits of the joints whose `derate` is below 1.
    """
    derate = transmission.derate(design)
    rows = np.flatnonzero(derate < 1)
    low, high = zonotope.box(transmission.joint_from_motor(design)[rows], lower, upper)
    joints = transmission.joint_names(design)
    return DeratedTorques(
        rows,
        tuple(joints[row] for row in rows),
        np.where(low < 0, derate[rows] * low, low),
        np.where(high > 0, derate[rows] * high, high),
    )
