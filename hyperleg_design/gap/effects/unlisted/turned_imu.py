"""An IMU that is mounted at another angle than declared."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.errors import InputError
from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.effects.excitation import Excitation, Motion
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.sensors.imu_bias import IMU, misread
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.inertial import sensed
from hyperleg_design.gap.signals.signals import OF_SENSORS, Signals
from hyperleg_design.simulation.alteration import Alteration

SQUARE = 0.01
"""Usual angle of an IMU against the axes that its robot's file states [rad]: half a degree about
each axis, of brackets and boards (assumed)."""


class TurnedImu(Effect):
    """The IMU of a floating base is turned by a small angle about each of its own axes.

    Trace: what gyro and accelerometer then tell more than the logged orientation and velocity say,
    and the torques that the joints do not need. On a base that hardly turns this is the same as an
    error of the accelerometer. The catalogue does not have it, as it is a matter of the robot's
    file.
    """

    identifier: ClassVar[str] = "turned_imu"
    kind: ClassVar[str] = "sensor"
    listed: ClassVar[bool] = False
    summary: ClassVar[str] = "the IMU is mounted at another angle than declared"
    rare: ClassVar[float] = -1.0
    """Assumed: a sensor is mounted once, and its errors change with every start."""
    linear: ClassVar[bool] = True
    parameters: ClassVar[tuple[Parameter, ...]] = tuple(
        Parameter(axis, "rad", 0.0, -0.5, 0.5, 0.02, "a degree: brackets and glue (assumed)")
        for axis in "xyz"
    )

    @override
    def locations(self, subject: Subject) -> tuple[str, ...]:
        """The sensor, on a floating base."""
        return (IMU,) if subject.floating else ()

    @override
    def excited(self, log: Log, motion: Motion) -> Excitation:
        return Excitation(self.identifier, True, (), "the base turns, and gravity acts on it")

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        if signals.base is None:
            return {}
        turns = np.atleast_2d(np.asarray(values, float))[:, None]
        return misread(signals, *(np.cross(sensed(signals, s)[None], turns) for s in OF_SENSORS))

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        remedy = "is added to no simulation: turn the site of the IMU in the robot's file"
        raise InputError(self.identifier, "location", location, remedy)

    @override
    def usual_errors(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """An angle about each axis."""
        return dict.fromkeys(self.locations(subject), np.full(len(self.parameters), SQUARE))

    @override
    def describe(self, values: np.ndarray) -> str:
        return (
            f"feels what a sensor would that is turned by {float(np.linalg.norm(values)):.2g} rad "
            f"against the axes that the robot's file states"
        )
