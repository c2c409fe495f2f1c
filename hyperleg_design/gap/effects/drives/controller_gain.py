"""Controllers with other gains than declared."""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.effect import STEERED
from hyperleg_design.gap.effects.excitation import SWINGING, Need
from hyperleg_design.gap.effects.families import BEYOND_COMMANDS, FRICTION, WITH_LOAD, WITHOUT_DRIVE
from hyperleg_design.gap.effects.kinds import JointEffect
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placing import (
    before_measurement,
    commanded,
    driven_motors,
    is_commanded,
    is_logged,
    limited,
)
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration
from hyperleg_design.simulation.drives.machine import Machine

STIFFNESS_SCALE_SOURCE = (
    "servos' registers are nominal: 20 % off (assumed; XL330 and STS3215 fits in BAM)"
)


class ControllerGain(JointEffect):
    """A joint's controller is stiffer or more damped than its declared gains.

    Its torque K (target - q) - D q_dot changes by ((scale_K - 1) K (target - q) - (scale_D - 1) D
    q_dot), and with it those of the motors. Trace, by the rule of `placing`: what that changes
    within the nominal limits. Of motors whose commands are logged, and so known to be what the
    controller asked for, it shows in the residual of the control instead.
    """

    identifier: ClassVar[str] = "controller_gain"
    scales: ClassVar[str] = "joint"
    scales_measured: ClassVar[bool] = False
    nuisance_rank: ClassVar[int] = 6
    nuisance_torque: ClassVar[str] = STEERED
    summary: ClassVar[str] = "a joint controller is stiffer or more damped than declared"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("stiffness_scale", "", 1.0, 0.1, 5.0, 0.2, STIFFNESS_SCALE_SOURCE, spread=0.015),
        Parameter("damping_scale", "", 1.0, 0.0, 5.0, 0.2, "as the stiffness", spread=0.015),
    )
    needs: ClassVar[Need] = replace(
        SWINGING, good="targets, gains and motion", asked=True, steered=True
    )
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "log torque or current": BEYOND_COMMANDS,
        "several amplitudes": FRICTION - {"viscous_friction"} | {"backlash", "torque_saturation"},
        "torque-off swing": WITHOUT_DRIVE,
        "known payload": WITH_LOAD,
    }
    look_alikes: ClassVar[Mapping[str, str]] = {"torque_saturation": "several amplitudes"}

    @override
    def locations(self, subject: Subject) -> tuple[str, ...]:
        """Joints with known gains."""
        known = np.isfinite(subject.gains).all(1) & (subject.gains != 0).any(1) & ~subject.passive
        return tuple(name for name, here in zip(subject.joints, known, strict=True) if here)

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        subject = signals.subject
        joint = subject.joints.index(location)
        if signals.target is None or not np.isfinite(signals.target[:, joint]).any():
            return {}
        scale = np.atleast_2d(np.asarray(values, float))[..., None] - 1.0
        stiffness, damping = subject.gains[joint]
        error = signals.target[:, joint] - signals.position[:, joint]
        spring = scale[:, 0] * (stiffness * error)
        damper = scale[:, 1] * (damping * signals.sensed[:, joint])
        changes, control = {}, {}
        for motor in np.flatnonzero(subject.motor_from_joint[:, joint]).tolist():
            if subject.motors[motor] not in driven_motors(subject) or not is_commanded(
                signals, motor
            ):
                continue
            share = subject.motor_from_joint[motor, joint] * (
                signals.supplied[:, motor] * spring - damper
            )
            if is_logged(signals, motor):
                control[motor] = share
                continue
            asked = commanded(signals, motor)
            changes[motor] = limited(signals, motor, asked + share) - limited(signals, motor, asked)
        return before_measurement(signals, changes, control)

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        values = np.asarray(values, float)
        return ScaledGains(location, values[..., 0], values[..., 1])

    @override
    def starts(self, signals: Signals, location: str) -> np.ndarray:
        """Softer and stiffer, with and without the damping."""
        return np.array(
            [[0.8, 0.8], [1.25, 1.25], [0.8, 1.0], [1.25, 1.0], [1.0, 0.8], [1.0, 1.25]]
        )


@dataclass(frozen=True, eq=False)
class ScaledGains(Alteration):
    """Gains of a joint's controller over those of the machine."""

    joint: str
    stiffness: Any
    damping: Any
    """`()` or `(n,)` each [-]."""

    @override
    def machine(self, machine: Machine) -> Machine:
        """With the other gains."""
        place = machine.joint(self.joint)
        machine = machine.changed("stiffness", place, lambda own: own * self.stiffness)
        return machine.changed("damping", place, lambda own: own * self.damping)
