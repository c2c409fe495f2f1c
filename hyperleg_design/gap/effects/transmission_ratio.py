"""Transmissions whose ratio is not the model's."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from hyperleg_design.gap.effects.effect import Effect, Parameter
from hyperleg_design.gap.effects.placing import at_motor, driven_motors
from hyperleg_design.simulation.alteration import Alteration, Machine

if TYPE_CHECKING:
    from hyperleg_design.gap.signals import Signals
    from hyperleg_design.gap.subject import Subject


class TransmissionRatio(Effect):
    """A motor turns `scale` times as fast over its joints as the model says, and pulls on them `scale` times as hard.

    Positions are the joints' own. Trace: (1 - scale) tau + (scale^2 - 1) J M^T q_ddot on the motor's side, the second part as
    the rotor turns faster too. Apart from it, this looks like a torque constant.
    """

    identifier: ClassVar[str] = "transmission_ratio"
    kind: ClassVar[str] = "motor"
    summary: ClassVar[str] = "a transmission's ratio differs from the model's"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("scale", "", 1.0, 0.5, 2.0, 0.03, "linkages off their design point, one tooth of 40 on a pulley (assumed)"),
    )

    def locations(self, subject: Subject) -> tuple[str, ...]:
        """Motors."""
        return driven_motors(subject)

    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        """See `Effect.trace`."""
        subject = signals.subject
        motor = subject.motors.index(location)
        scale = np.atleast_2d(np.asarray(values, float))[:, :1]
        rotor = subject.rotor_inertia[motor] * (signals.acceleration @ subject.joint_from_motor[:, motor])
        return at_motor(signals, motor, (1.0 - scale) * signals.believed[:, motor] + (scale**2 - 1.0) * rotor)

    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        """See `Effect.alteration`; the controller keeps computing with the model's."""
        return ScaledRatio(location, np.asarray(values, float)[..., 0])


@dataclass(frozen=True, eq=False)
class ScaledRatio(Alteration):
    """A motor's column of M over that of the machine."""

    motor: str
    scale: Any
    """`()` or `(n,)` [-]."""

    def machine(self, machine: Machine) -> Machine:
        """With the other M."""
        scale = np.asarray(self.scale, float)[..., None]
        old = np.asarray(machine.joint_from_motor)
        place = machine.motor(self.motor)
        column = old[..., place] * scale
        matrix = np.array(np.broadcast_to(old, (*column.shape[:-1], *old.shape[-2:])))
        matrix[..., place] = column
        return dataclasses.replace(machine, joint_from_motor=matrix)
