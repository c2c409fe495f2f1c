"""Rotors heavier or lighter than the model's."""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import Need
from hyperleg_design.gap.effects.families import INERTIAL
from hyperleg_design.gap.effects.kinds import MotorTorque
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.strength import joint_inertia, motor_strength
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration
from hyperleg_design.simulation.drives.machine import Machine

SHARE = 0.3
"""Usual error over the rotor's inertia, or, where the model has none, over what is usual
(assumed)."""
ACCELERATION = 300.0
"""Acceleration that a drive's torque gives its own rotor, where the model has none [rad/s^2];
assumed: 30 to 300 of hobby servos and industrial arms, thousands of legs."""
OF_ITS_JOINT = 0.03
"""Inertia of a rotor over that of its joint, likewise and at least (assumed)."""
CONTENT = 1.0
"""Content of the motion from which a rotor's inertia shows [Hz]."""
LEAST_ACCELERATION = 2.0
"""Acceleration from which it shows in slower motion, too [rad/s^2] (assumed)."""
OF_ROTOR, OF_JOINT = 0.06, 0.01
"""Usual error over the rotor's inertia and over that of its joint."""
SOURCE = "0.03-0.1 kg m^2 reflected on leg joints; `usual` knows the motor's side"


class RotorInertia(MotorTorque):
    """Inertia of a rotor and what turns with it, beyond the model's, on the motor's side of the
    transmission.

    Trace: inertia times the motor's acceleration M^T q_ddot.
    """

    identifier: ClassVar[str] = "rotor_inertia"
    inertial: ClassVar[bool] = True
    nuisance_rank: ClassVar[int] = 1
    described: ClassVar[bool] = True
    summary: ClassVar[str] = "a rotor (and its gear) has more or less inertia than the model"
    built: ClassVar[bool] = True
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("inertia", "kg m^2", 0.0, -1e3, 1e3, 0.05, SOURCE),
    )
    linear: ClassVar[bool] = True
    needs: ClassVar[Need] = Need(
        lambda motion: (
            motion.reversing
            & ((motion.content > CONTENT) | (motion.acceleration > LEAST_ACCELERATION))
        ),
        "motion accelerates",
        "hardly any acceleration",
    )
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "chirp past 8 Hz": {"controller_gain", "torque_constant", "transmission_ratio"},
        "several postures": INERTIAL,
    }
    look_alikes: ClassVar[Mapping[str, str]] = {"link_mass": "several postures"}

    @override
    def nuisance_spreads(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """A share of the rotor, and of its joint."""
        inertia, spreads = joint_inertia(subject), {}
        for location in self.locations(subject):
            motor = subject.motors.index(location)
            column = np.abs(subject.joint_from_motor[:, motor])
            main = int(np.argmax(column))
            of_joint = OF_JOINT * inertia[main] / max(float(column[main]), 1e-9) ** 2
            spreads[location] = np.array([OF_ROTOR * subject.rotor_inertia[motor] + of_joint])
        return spreads

    def _torque(self, signals: Signals, motor: int, inertia: np.ndarray) -> np.ndarray:
        return inertia * (signals.acceleration @ signals.subject.joint_from_motor[:, motor])

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        """What is taken away never exceeds the model's."""
        own = subject.rotor_inertia[subject.motors.index(location)]
        return AddedRotor(location, np.maximum(np.asarray(values, float)[..., 0], -own))

    @override
    def usual(self, location: str, subject: Subject) -> np.ndarray:
        """A share of the rotor's own inertia. Where the model has none, of what the motor's torque
        accelerates: next to the rotors of a small arm, the links of its wrist are nothing.
        """
        motor = subject.motors.index(location)
        own = float(subject.rotor_inertia[motor])
        column = subject.joint_from_motor[:, motor]
        main = subject.main_joint(motor)
        least = OF_ITS_JOINT * float(joint_inertia(subject)[main]) / column[main] ** 2
        if own <= 0:
            own = motor_strength(subject, motor) / ACCELERATION
        return np.array([SHARE * max(own, least)])

    @override
    def bounds(self, location: str, subject: Subject) -> np.ndarray:
        """Usual bounds, but no less inertia than takes all of the model's rotor away."""
        bounds = super().bounds(location, subject)
        bounds[0] = -subject.rotor_inertia[subject.motors.index(location)]
        return bounds


@dataclass(frozen=True, eq=False)
class AddedRotor(Alteration):
    """Inertia added to a rotor."""

    motor: str
    inertia: Any
    """`()` or `(n,)` [kg m^2]."""

    @override
    def machine(self, machine: Machine) -> Machine:
        """With the heavier rotor."""
        return machine.changed(
            "rotor_inertia", machine.motor(self.motor), lambda own: own + self.inertia
        )
