"""An IMU that is mounted at another angle than declared, and tells the orientation, too."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

import numpy as np
from scipy.spatial.transform import Rotation
from typing_extensions import override

from hyperleg_design.gap.effects.needed import needed
from hyperleg_design.gap.effects.unlisted.turned_imu import TurnedImu
from hyperleg_design.gap.model.base import BaseMotion
from hyperleg_design.gap.signals.signals import Signals

SMALL = 0.01
"""Angle at which the trace is computed [rad]; traces are linear in small angles."""


class TurnedFrame(TurnedImu):
    """All that is known of how a floating base moves is told in a frame that is turned by a small
    angle about each of its axes.

    Most robots have one IMU, and their orientation is the IMU's. The sensors then agree with each
    other, but gravity and the forces of the ground come from a wrong direction. Trace: the torques
    that joints and base need in the declared frame, less those in the turned one.
    """

    identifier: ClassVar[str] = "turned_frame"
    summary: ClassVar[str] = "the IMU, whose orientation is logged, is mounted at another angle"

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        base = signals.base
        if base is None:
            return {}
        declared = needed(signals, signals.position, rotors=False)
        rows: dict[str, list[np.ndarray]] = {residual_name: [] for residual_name in declared}
        for axis in SMALL * np.eye(3):
            meant = replace(signals, base=_turned(base, Rotation.from_rotvec(axis).as_matrix()))
            for residual_name, torque in needed(meant, signals.position, rotors=False).items():
                rows[residual_name].append((torque - declared[residual_name]) / SMALL)
        turns = np.atleast_2d(np.asarray(values, float))
        return {name: np.tensordot(turns, np.stack(own), 1) for name, own in rows.items()}

    @override
    def describe(self, values: np.ndarray) -> str:
        return (
            f"is told in a frame that is turned by {float(np.linalg.norm(values)):.2g} rad against "
            f"the axes that the robot's file states: an IMU that is mounted at an angle"
        )


def _turned(base: BaseMotion, turn: np.ndarray) -> BaseMotion:
    """The motion of a base in axes of its own, of which the logged ones are turned `(3, 3)`."""
    return BaseMotion(
        base.position,
        base.rotation @ turn.T,
        *(
            values @ turn.T
            for values in (
                base.linear_velocity,
                base.angular_velocity,
                base.specific_force,
                base.angular_acceleration,
            )
        ),
    )
