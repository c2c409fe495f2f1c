"""Play between a motor and its joints."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Set
from typing import Any, ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import REVERSING, Need
from hyperleg_design.gap.effects.families import BESIDE_TRANSMISSIONS, FRICTION, LATE
from hyperleg_design.gap.effects.kinds import GearEffect
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placing import SIDES
from hyperleg_design.gap.effects.transmissions import belt, slack
from hyperleg_design.gap.model import machine
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration
from hyperleg_design.simulation.drives.two_mass import STIFFEST, Belt

COASTING = ("a rotor that the load carries over", "a rotor that crosses by itself")


class Backlash(GearEffect):
    """A motor turns freely through a small angle before its joints follow; see `belt`.

    The angle is the whole width of the dead zone, at the joint that the motor moves most. While the
    teeth cross it the belt gives no torque and the rotor is caught up with; with encoders at the
    rotors (`side` 1) the joint lags by half the angle.
    """

    identifier: ClassVar[str] = "backlash"
    stretched: ClassVar[bool] = True
    rough: ClassVar[Mapping[str, float]] = {"angle": 0.15}
    """How rotors move on belts that give was 10 to 25 % off in development."""
    summary: ClassVar[str] = "a motor turns freely through a small angle before its joint follows"
    built: ClassVar[bool] = True
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            "angle", "rad", 0.0, 0.0, 0.1, 0.006, "0.1-1 deg at the joint (engineering estimate)"
        ),
        Parameter("side", "", 0.0, 0.0, 1.0, 1.0, "a choice", shape=True, choices=SIDES),
        Parameter("coasting", "", 1.0, 0.0, 1.0, 1.0, "a choice", shape=True, choices=COASTING),
        Parameter("behind", "", 0.0, 0.0, 1.0, 1.0, "a choice", shape=True, choices=belt.RUBBING),
    )
    needs: ClassVar[Need] = dataclasses.replace(REVERSING, speeds=True)
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "preload": FRICTION | LATE | {"cogging", "transmission_elasticity"},
        "log rotor speeds": BESIDE_TRANSMISSIONS,
    }

    @override
    def _left(self, signals: Signals, motor: int, *values: Any) -> dict[str, np.ndarray]:
        angle, side, coasting, behind = values
        moved = slack.slack(
            signals, motor, angle * signals.subject.motor_over_joint(motor), side, coasting, behind
        )
        return belt.trace(signals, motor, moved, side, behind=behind)

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        """Its ends are as hard as simulations resolve, and damped to bounce as in the trace."""
        motor = subject.motors.index(location)
        bounce = np.log(slack.RESTITUTION)
        ratio = abs(bounce) / np.hypot(np.pi, bounce)
        damping = 2 * ratio * machine.rotor(subject, motor) * 2 * np.pi * STIFFEST
        angle, side, *_ = np.moveaxis(np.asarray(values, float), -1, 0)
        play = angle * subject.motor_over_joint(motor)
        return Belt(location, play=play, damping=float(damping), side=side)

    @override
    def fixed(self, values: np.ndarray) -> np.ndarray:
        """Where encoders sit; on the rotors, joints always move by themselves, and rub or do
        not.
        """
        at_rotors = values[1] >= belt.CHOSEN
        return np.array([False, True, at_rotors, at_rotors])

    @override
    def starts(self, signals: Signals, location: str) -> np.ndarray:
        """Small and large angles, with encoders on either side, or carried over; where ends are met
        depends on the angle.
        """
        rotors = [
            [angle, 0.0, 1.0, behind] for angle in (0.003, 0.01, 0.03) for behind in (0.0, 0.5, 1.0)
        ]
        joints = [
            [angle, 1.0, 1.0, 0.0]
            for angle in (0.003, 0.006, 0.011, 0.018, 0.026, 0.036, 0.048, 0.062)
        ]
        rubbing = [[angle, 1.0, 1.0, 1.0] for angle in (0.006, 0.015, 0.03, 0.05)]
        return np.array([*rotors, *joints, *rubbing, [0.01, 0.0, 0.0, 0.0], [0.04, 0.0, 0.0, 0.0]])
