"""Joint encoders with a wrong zero."""

from __future__ import annotations

from collections.abc import Mapping, Set
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import SWINGING, Need
from hyperleg_design.gap.effects.families import INERTIAL
from hyperleg_design.gap.effects.kinds import JointEffect
from hyperleg_design.gap.effects.needed import as_logged, needed
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placed import JointHooks
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.memoized import memoized

NODES = 5
"""Positions at which the torque is computed: it is a trigonometric polynomial of second degree in
one joint's angle."""

Basis = dict[str, tuple[np.ndarray, np.ndarray]]
SOURCE = "up to 0.1 rad on calibrated legs (PACE, arXiv 2509.06342)"


class _Shifted(JointHooks):
    """What controller, policy and log are told of a joint's position is off."""

    offset: np.ndarray

    def measured(self, position: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        position[:, self.place] += self.offset
        return position, velocity


class EncoderOffset(JointEffect):
    """A joint stands at the logged position minus `offset`; controller and log read the same wrong
    angle.

    Targets are absolute and torques follow from readings, so all that the offset leaves is the
    torque that another posture
    needs: gravity, inertia, springs and the levers of contact forces. Trace: needed(q - offset) -
        needed(q), exact.
    """

    identifier: ClassVar[str] = "encoder_offset"
    of_zeros: ClassVar[bool] = True
    nuisance_rank: ClassVar[int] = 4
    summary: ClassVar[str] = "a joint's encoder reads a constant angle too much"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("offset", "rad", 0.0, -0.3, 0.3, 0.03, SOURCE, spread=0.003),
    )
    hooks: ClassVar[type[JointHooks]] = _Shifted
    needs: ClassVar[Need] = Need(
        lambda motion: motion.swinging & motion.posture,
        SWINGING.good,
        f"{SWINGING.lacking} that changes torques",
    )
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "several postures": INERTIAL | {"imu_bias", "joint_spring", "torque_constant"}
    }
    look_alikes: ClassVar[Mapping[str, str]] = {"link_com": "several postures"}

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        joint = signals.subject.joints.index(location)
        offset = np.atleast_2d(np.asarray(values, float))[:, 0]
        turns = signals.subject.tree.hinge[joint]
        powers = _waves(offset) if turns else np.stack([offset, offset**2], -1)
        trace = {}
        for residual_name, (rows, parts) in _basis(signals, joint).items():
            count = len(signals.subject.joints) if residual_name == "motion" else 6
            trace[residual_name] = np.zeros((len(offset), len(signals.time), count))
            trace[residual_name][..., rows] = np.tensordot(powers, parts, 1)
        trace["motion"][..., joint] -= signals.subject.spring[joint] * offset[:, None]
        return trace


def _waves(offset: np.ndarray) -> np.ndarray:
    """Functions of an offset that vanish at 0 `(k, 4)`."""
    return np.stack(
        [np.cos(offset) - 1, np.sin(offset), np.cos(2 * offset) - 1, np.sin(2 * offset)], -1
    )


@memoized
def _basis(signals: Signals, joint: int) -> Basis:
    """By residual: the rows that an offset changes, and their coefficients of the functions of the
    offset `(functions, t, rows)`.
    """
    hinge = bool(signals.subject.tree.hinge[joint])
    nodes = 2 * np.pi / NODES * np.arange(1, NODES) if hinge else np.array([-0.1, 0.1])
    matrix = np.linalg.inv(_waves(nodes) if hinge else np.stack([nodes, nodes**2], -1))
    logged = as_logged(signals)
    shifts = []
    for node in nodes:
        position = signals.position.copy()
        position[:, joint] -= node
        shifted = needed(signals, position, rotors=False)
        shifts.append(
            {
                residual_name: shifted[residual_name] - logged[residual_name]
                for residual_name in logged
            }
        )
    basis = {}
    for residual_name in logged:
        differences = np.stack([shift[residual_name] for shift in shifts])
        rows = np.flatnonzero(np.nanmax(np.abs(differences), (0, 1)) > 1e-12)
        basis[residual_name] = (rows, np.tensordot(matrix, differences[..., rows], 1))
    return basis
