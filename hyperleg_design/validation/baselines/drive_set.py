"""PACE's parameters (arXiv 2509.06342) and what a fit of them on some logs is: armature, viscous
damping, Coulomb friction and encoder bias of each joint, and one delay of all commands. All are
kept as differences from the nominal model.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.effects.drives.rotor_inertia import OF_JOINT, OF_ROTOR
from hyperleg_design.gap.effects.strength import joint_inertia, joint_strength
from hyperleg_design.gap.effects.usual import lateness
from hyperleg_design.gap.inference.nuisance import nuisance_parameters
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.playback.replay import best_input
from hyperleg_design.gap.signals.signals import Signals

KINDS = ("armature", "damping", "friction", "bias")
"""Of each joint [kg m^2, Nms/rad, Nm, rad], in the order of a vector of values; `delay` [s] comes
last."""
EFFECT = {
    "armature": "rotor_inertia",
    "damping": "viscous_friction",
    "friction": "coulomb_friction",
    "bias": "encoder_offset",
    "delay": "command_delay",
}
"""The effect of the catalogue that each stands for."""
LARGEST_BIAS, LARGEST_DELAY = 0.1, 0.025
"""PACE's bounds [rad, s]: 0.1 rad, 10 steps at 400 Hz."""
ARMATURE, FRICTION, DAMPING = 1.5, 0.25, 0.15
"""Largest difference over the joint's inertia, over its strength, and over its strength a rad/s.
PACE gives absolute numbers for one robot (1 kg m^2, 0.5 Nm, 7 Nms/rad on ANYmal's 89 Nm joints);
these are of that order, or wider, on any."""


@dataclass(frozen=True, eq=False)
class DriveSet:
    """Bounds and scales of the parameters of one robot of n joints, P = 4 n + 1 in all."""

    subject: Subject
    low: np.ndarray
    high: np.ndarray
    """`(P,)` each."""
    spread: np.ndarray
    """Usual nuisance parameter of each, from `nuisance` `(P,)`."""

    @property
    def count(self) -> int:
        """Number of parameters P."""
        return len(self.low)

    def part(self, values: np.ndarray, kind: str) -> np.ndarray:
        """Values of a kind `(..., n)`; of the delay `(...,)`.

        Args:
            values: of all parameters `(..., P)`.
            kind: of parameter.

        Returns:
            The values `(..., n)`, or `(...,)`.
        """
        joints = len(self.subject.joints)
        if kind == "delay":
            return np.asarray(values[..., -1])
        at = KINDS.index(kind) * joints
        return np.asarray(values[..., at : at + joints])

    def place(self, index: int) -> tuple[str, str]:
        """Effect and location of a parameter.

        Args:
            index: of the parameter.

        Returns:
            Effect and location.
        """
        joints = len(self.subject.joints)
        if index == self.count - 1:
            return EFFECT["delay"], "robot"
        return EFFECT[KINDS[index // joints]], self.subject.joints[index % joints]

    def cause(self, values: np.ndarray) -> tuple[str, str, float]:
        """What such a fit would name: effect, location and size of the largest change over the
        spread of its parameter.

        Args:
            values: of all parameters `(P,)`.

        Returns:
            Effect, location and size.
        """
        size = np.abs(values) / self.spread
        at = int(np.argmax(size))
        return (*self.place(at), float(size[at]))


@dataclass(frozen=True, eq=False)
class Fitted:
    """Result of one method on some logs."""

    method: str
    values: np.ndarray
    """`(P,)`"""
    seconds: float
    """Wall time."""
    evaluations: int
    """Simulations of all logs."""
    history: tuple[tuple[float, np.ndarray], ...]
    """Time since the start and best values then, as the method went on."""
    stopped: str
    """Why it ended."""


def drive_set(subject: Subject, step: float) -> DriveSet:
    """Parameters of a robot whose base is fixed and whose logs have a step [s].

    Args:
        subject: the robot.
        step: of the logs [s].

    Returns:
        The parameters.

    Raises:
        InputError: a floating base.
    """
    if subject.floating:
        raise InputError(
            subject.name,
            "base",
            subject.base,
            "expects a fixed base: these methods replay whole logs of a robot in the air",
        )
    inertia = np.maximum(joint_inertia(subject) + np.diag(subject.armature), 1e-9)
    strength, joints = joint_strength(subject), len(subject.joints)
    own = subject.model.dof_armature[subject.model.nv - joints :]
    high = np.concatenate(
        [
            ARMATURE * inertia,
            DAMPING * strength,
            FRICTION * strength,
            np.full(joints, LARGEST_BIAS),
            [LARGEST_DELAY],
        ]
    )
    low = np.concatenate(
        [-0.9 * own, -subject.viscous, -subject.coulomb, np.full(joints, -LARGEST_BIAS), [0.0]]
    )
    return DriveSet(subject, low, high, _spreads(subject, step))


def _spreads(subject: Subject, step: float) -> np.ndarray:
    known: Mapping[tuple[str, str], float] = {
        (u.effect, u.location): u.spread
        for u in nuisance_parameters(subject, step)
        if u.parameter == 0
    }
    inertia = joint_inertia(subject)
    rotors = OF_ROTOR * np.diag(subject.armature) + OF_JOINT * inertia
    joints = [
        [known[effect, j] for j in subject.joints]
        for effect in ("viscous_friction", "coulomb_friction", "encoder_offset")
    ]
    return np.concatenate([rotors, *joints, [lateness(step)]])


def check_logs(signals: Sequence[Signals]) -> None:
    """Refuse logs that these methods cannot replay.

    Args:
        signals: the conditioned logs.

    Raises:
        InputError: no logs, or one without targets and gains.
    """
    if not signals:
        raise InputError("baselines", "logs", 0, "expects at least one log")
    for log_signals in signals:
        if best_input(log_signals) != "target":
            raise InputError(
                log_signals.log.name,
                "position_target",
                None,
                "expects targets and gains of all joints: these methods replay the closed loop",
            )
