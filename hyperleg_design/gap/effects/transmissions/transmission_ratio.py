"""Transmissions whose ratio is not the model's."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Set
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import Need
from hyperleg_design.gap.effects.families import (
    BESIDE_TRANSMISSIONS,
    SCALING,
    WITH_LOAD,
    WITHOUT_DRIVE,
)
from hyperleg_design.gap.effects.kinds import GearEffect
from hyperleg_design.gap.effects.needed import as_logged, needed
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placing import SIDES, at_motor, given, motor_velocity
from hyperleg_design.gap.model import friction
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.transmission import turned
from hyperleg_design.memoized import memoized
from hyperleg_design.simulation.alteration import Alteration, Live
from hyperleg_design.simulation.drives.machine import Machine

SCALE_SOURCE = "linkages off their design point, one tooth of 40 on a pulley (assumed)"


class TransmissionRatio(GearEffect):
    """A motor turns `scale` times as fast over its joints as the model says, and pulls on them
    `scale` times as hard.

    Where positions are the joints' own (`side` 0), the trace on the motor's side is

        (1 - scale) tau + (scale^2 - 1) J M^T q_ddot.

    The second part is there because the rotor turns faster, too. Without it, and without a logged
    speed of the rotor, the effect looks like a torque constant. Where positions are computed from
    the rotors with the model's ratio (`side` 1), the joints stand elsewhere, at q + (1 / scale - 1)
    P M^T q, with the motor's row P of the inverse of M. The trace is (1 - scale) (tau - J M^T
    q_ddot) and what that motion needs beyond the logged one, friction included: of coupled joints,
    one may stand still while its encoders say that it turns.
    """

    identifier: ClassVar[str] = "transmission_ratio"
    scales: ClassVar[str] = "motor"
    rare: ClassVar[float] = -0.5
    """Assumed: belts have the ratio of their teeth."""
    unseen: ClassVar[float] = -6.0
    """Assumed: through torques alone it fits whatever scales them, such as all of a joint's
    friction on another day."""
    summary: ClassVar[str] = "a transmission's ratio differs from the model's"
    built: ClassVar[bool] = True
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("scale", "", 1.0, 0.7, 1.4, 0.03, SCALE_SOURCE),
        Parameter("side", "", 0.0, 0.0, 1.0, 1.0, "a choice", shape=True, choices=SIDES),
    )
    needs: ClassVar[Need] = Need(
        lambda motion: motion.swinging,
        "through the torques only: it looks like controller_gain",
        "no motor speeds, and joints hardly move",
        speeds=True,
    )
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "chirp past 8 Hz": {"torque_constant"},
        "torque-off swing": WITHOUT_DRIVE,
        "known payload": WITH_LOAD,
        "known angle": SCALING | {"rotor_inertia"},
        "log rotor speeds": BESIDE_TRANSMISSIONS | {"transmission_elasticity", "backlash"},
    }

    @override
    def driven(self, signals: Signals) -> bool:
        """Whether speeds of motors show it."""
        return "transmission" in signals.residual

    @override
    def _left(self, signals: Signals, motor: int, *values: Any) -> dict[str, np.ndarray]:
        subject = signals.subject
        scale, side = (value[:, None] for value in values)
        rotor = subject.rotor_inertia[motor] * (
            signals.acceleration @ subject.joint_from_motor[:, motor]
        )
        turning = (1 - side) * (scale**2 - 1.0) + side * (scale - 1.0)
        trace = at_motor(signals, motor, (1.0 - scale) * given(signals, motor) + turning * rotor)
        trace |= turned(signals, motor, (1 - side) * (scale - 1.0) * motor_velocity(signals, motor))
        if not side.any():
            return trace
        trace["motion"] = trace["motion"] + _other_friction(signals, motor, side * (1 / scale - 1))
        farther = (1 / scale - 1)[:, 0]
        powers = side * np.stack([farther, farther**2], -1)
        for residual_name, parts in _displacement_derivatives(signals, motor).items():
            more = np.tensordot(powers, parts, 1)
            trace[residual_name] = trace[residual_name] + more if residual_name in trace else more
        return trace

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        """The controller keeps computing with the model's."""
        values = np.asarray(values, float)
        return ScaledRatio(location, values[..., 0], values[..., 1])

    @override
    def starts(self, signals: Signals, location: str) -> np.ndarray:
        """Longer and shorter, with encoders on either side."""
        return np.array([[1.05, 0.0], [0.95, 0.0], [1.05, 1.0], [0.95, 1.0]])


def _other_friction(signals: Signals, motor: int, farther: np.ndarray) -> np.ndarray:
    """Friction of joints that move otherwise than logged, a motor's share of it larger by some
    shares `(k, 1)`, less the logged `(k, t, n)`.
    """
    subject, velocity = signals.subject, signals.velocity
    own = np.outer(subject.joint_from_motor[:, motor], subject.motor_from_joint[motor])
    swing = None if signals.limit_cycle is None else signals.limit_cycle.speed
    moved = velocity + farther[..., None] * (velocity @ own)
    return np.asarray(
        friction.friction_torque(subject, signals.position, moved, swing)
        - friction.friction_torque(subject, signals.position, velocity, swing)
    )


NODE = 0.1
"""Share by which `_displacement_derivatives` moves joints."""


@memoized
def _displacement_derivatives(signals: Signals, motor: int) -> dict[str, np.ndarray]:
    """Derivatives of the torque that the motion needs by the share by which a motor moves its
    joints farther: coefficients of that share and of its square `(2, t, rows)`, by residual.
    """
    subject = signals.subject
    own = np.outer(subject.joint_from_motor[:, motor], subject.motor_from_joint[motor])
    displaced = []
    for node in (NODE, -NODE):
        moved = (
            values + node * values @ own
            for values in (signals.position, signals.velocity, signals.acceleration)
        )
        displaced.append(needed(signals, *moved, rotors=False))
        displaced[-1]["motion"] = (
            displaced[-1]["motion"] + node * (signals.position @ own) * subject.spring
        )
    derivatives = {}
    for residual_name, now in as_logged(signals).items():
        more, less = displaced[0][residual_name] - now, displaced[1][residual_name] - now
        derivatives[residual_name] = np.stack(
            [(more - less) / (2 * NODE), (more + less) / (2 * NODE**2)]
        )
    return derivatives


@dataclass(frozen=True, eq=False)
class ScaledRatio(Alteration):
    """A motor's column of M over that of the machine."""

    motor: str
    scale: Any
    side: Any = 0.0
    """`()` or `(n,)` each [-]."""

    @override
    def machine(self, machine: Machine) -> Machine:
        """With the other reductions from the motor to its joints."""
        scale = np.asarray(self.scale, float)[..., None]
        old = np.asarray(machine.joint_from_motor)
        place = machine.motor(self.motor)
        column = old[..., place] * scale
        matrix = np.array(np.broadcast_to(old, (*column.shape[:-1], *old.shape[-2:])))
        matrix[..., place] = column
        return dataclasses.replace(machine, joint_from_motor=matrix)


class _Scaled(Live):
    alteration: ScaledRatio

    def prepare(self) -> None:
        alteration, place = self.alteration, self.machine.motor(self.alteration.motor)
        scale = np.asarray(alteration.scale, float)
        # the machine's own M is scaled already
        column = np.asarray(self.machine.joint_from_motor)[..., place] / scale[..., None]
        row = np.asarray(self.machine.motor_from_joint)[..., place, :]
        share = np.asarray(alteration.side) * (scale - 1)
        self.reading_shift = share[..., None, None] * (column[..., :, None] * row[..., None, :])

    def measured(self, position: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return tuple(
            values + (values[..., None, :] @ self.reading_shift)[..., 0, :]
            for values in (position, velocity)
        )


ScaledRatio.live = _Scaled
