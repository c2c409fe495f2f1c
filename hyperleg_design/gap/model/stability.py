"""Modes of a robot's control loops about a posture, linearised: at which frequency, in which shape,
and whether they grow.

With the inertia M(q), rotors on it, the joints' viscous friction V, the transmission tau_joint = B
tau_motor, and controllers that ask the motors for -C (K + s D) q, a motion q e^(s t) by itself
needs

    (M s^2 + V s + B H(s) C (K + s D)) q = 0,    H_m(s) = e^(-s T) / (1 + s tau_m)

T what the commands are late by, tau_m the lag of a drive. A belt that gives adds its stretch to q:
the rotor turns by B^T q + x, on a spring between it and the joints. Roots s are searched by
Newton's method on the smallest singular value. Weight and Coulomb friction are left out: at such
frequencies they hardly matter while a joint slides; where it sticks, bristles make it stiffer.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.model import rigid
from hyperleg_design.gap.model.machine import rotor

if TYPE_CHECKING:
    from hyperleg_design.gap.model.subject import Subject

ROUNDS = 14
"""Of Newton's method."""
LONGEST = 0.15
"""Of its steps, over where it starts."""
SETTLED = 1e-3
"""Last step over the root, up to which it is one."""
DAMPED = 0.02
"""Damping ratio of a rotor on its belt (assumed: cords ring)."""


@dataclass(frozen=True, eq=False)
class Loops:
    """Variants of one robot's control loops: `g` of them, `n` joints, `m` motors."""

    late: np.ndarray
    """Of all commands `(g,)` [s]."""
    slow: np.ndarray
    """Time constants of the drives `(g, m)` [s]."""
    gains: np.ndarray
    """Stiffness and damping at the joints `(g, n, 2)` [Nm/rad, Nms/rad]."""
    belt: int = -1
    """Motor on a belt that gives; -1, none."""
    spring: np.ndarray | None = None
    """Of the belt, on the motor's side `(g,)` [Nm/rad]."""
    on_rotor: bool = False
    """Whether that motor's encoder tells the joints' angles by its rotor's."""


@dataclass(frozen=True, eq=False)
class Modes:
    """One mode of each variant."""

    frequency: np.ndarray
    """`(g,)` [Hz]"""
    growth: np.ndarray
    """Of the amplitude, over that of its phase `(g,)`; above 0 the loop is unstable."""
    shape: np.ndarray
    """What encoders tell of the joints, complex, of length 1 `(g, n)`."""
    stretch: np.ndarray
    """Of the belt, on the motor's side, over the length of that `(g,)` [rad]."""
    found: np.ndarray
    """Whether there is such a mode at all `(g,)` of bool."""


def inertia(subject: Subject, posture: np.ndarray) -> np.ndarray:
    """Inertia matrix with the rotors at a posture `(n,)`, `(n, n)` [kg m^2]."""
    return np.stack(
        [row[0] for row in rigid.accelerating(subject, posture[None], np.eye(len(posture)))], 1
    )


def modes(subject: Subject, mass: np.ndarray, loops: Loops, frequency: float) -> Modes:
    """The mode of each variant that is next to a frequency.

    Args:
        subject: robot with its base fixed.
        mass: of `inertia`.
        loops: variants.
        frequency: from which roots are searched [Hz].
    """
    start = 2j * np.pi * frequency
    system = _System(subject, mass, loops)
    root = np.full(len(loops.late), start)
    longest, step = LONGEST * abs(start), np.zeros(len(root), complex)
    for _ in range(ROUNDS):
        left, value, right, slope = system.smallest(root)
        turn = np.einsum("gj,gjk,gk->g", left.conj(), slope, right)
        far = np.abs(turn) * longest < value
        step = np.where(
            far, longest * np.exp(-1j * np.angle(turn)), value / np.where(turn == 0, 1.0, turn)
        )
        root = root - step
        root = np.clip(root.real, -0.6 * abs(start), 0.6 * abs(start)) + 1j * np.clip(
            root.imag, 0.3 * abs(start), 2.5 * abs(start)
        )
    right = system.smallest(root)[2]
    shape = right @ system.told.T
    size = np.maximum(np.linalg.norm(shape, axis=1), 1e-12)
    stretch = np.abs(right[:, -1]) / size if loops.belt >= 0 else np.zeros(len(root))
    return Modes(
        root.imag / (2 * np.pi),
        root.real / np.abs(root),
        shape / size[:, None],
        stretch,
        np.abs(step) < SETTLED * np.abs(root),
    )


class _System:
    """The matrix whose roots the modes are, and its derivative."""

    def __init__(self, subject: Subject, mass: np.ndarray, loops: Loops) -> None:
        count, motors = subject.joint_from_motor.shape
        size = count + (loops.belt >= 0)
        self.loops = loops
        self.mass, self.drive, self.told = (
            np.zeros((size, size)),
            np.zeros((size, motors)),
            np.eye(count, size),
        )
        self.damping, self.spring = (
            np.zeros((len(loops.late), size, size)),
            np.zeros((len(loops.late), size, size)),
        )
        self.mass[:count, :count], self.drive[:count] = mass, subject.joint_from_motor
        self.damping[:, :count, :count] = np.diag(subject.viscous)
        if loops.belt >= 0 and loops.spring is not None:
            own = rotor(subject, loops.belt)
            self.mass[:count, -1] = self.mass[-1, :count] = (
                own * subject.joint_from_motor[:, loops.belt]
            )
            self.mass[-1, -1], self.drive[-1, loops.belt] = own, 1.0
            self.spring[:, -1, -1], self.damping[:, -1, -1] = (
                loops.spring,
                2 * DAMPED * np.sqrt(loops.spring * own),
            )
            if loops.on_rotor:
                self.told[:, -1] = subject.motor_from_joint[loops.belt]
        self.asked = [
            np.einsum("mn,gn,nd->gmd", subject.motor_from_joint, loops.gains[..., i], self.told)
            for i in (0, 1)
        ]

    def smallest(self, root: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Left vectors, smallest singular values and right vectors, of rows made alike in size, and
        the derivative by the root.
        """
        s = root[:, None, None]
        lag = 1 + root[:, None] * self.loops.slow
        given = np.exp(-root * self.loops.late)[:, None] / lag
        slower = -(self.loops.late[:, None] + self.loops.slow / lag) * given
        asked = self.asked[0] + s * self.asked[1]
        matrix = (
            self.mass * s**2
            + self.damping * s
            + self.spring
            + self.drive @ (given[..., None] * asked)
        )
        slope = (
            2 * self.mass * s
            + self.damping
            + self.drive @ (slower[..., None] * asked + given[..., None] * self.asked[1])
        )
        scale = 1 / np.maximum(np.abs(matrix).max(2, keepdims=True), 1e-300)
        left, values, right = np.linalg.svd(matrix * scale)
        return left[..., -1], values[:, -1], right[:, -1].conj(), slope * scale
