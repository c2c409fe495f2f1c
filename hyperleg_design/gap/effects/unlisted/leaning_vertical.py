"""A base that is not level, gravity that is declared wrongly, or an orientation that is off."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.errors import InputError
from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.effects.excitation import Excitation, Motion
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placing import ROBOT
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.rigid import inverse_dynamics
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration

LEVEL = 0.0035
"""Usual angle of a base against the vertical [rad]: a fifth of a degree (assumed)."""
PARALLEL = 1e-6
"""Sine of the angle up to which axes count as parallel [-]."""


class LeaningVertical(Effect):
    """Gravity acts in another direction than declared: by `east` and `north` along two directions
    across it.

    Trace: of a fixed base, the torque that the robot at rest needs against the part of gravity that
    is across the declared one; of a floating one, what the accelerometer feels of that part more
    than the logged orientation says. The catalogue does not have it, as its cause is none of the
    robot.
    """

    identifier: ClassVar[str] = "leaning_vertical"
    kind: ClassVar[str] = "robot"
    listed: ClassVar[bool] = False
    summary: ClassVar[str] = "a base is not level, or gravity or its orientation are off"
    rare: ClassVar[float] = -3.0
    """Assumed: stands are levelled, while zeros of encoders slip."""
    linear: ClassVar[bool] = True
    parameters: ClassVar[tuple[Parameter, ...]] = tuple(
        Parameter(axis, "rad", 0.0, -0.5, 0.5, 0.02, "a degree: desks and stands (assumed)")
        for axis in ("east", "north")
    )

    @override
    def locations(self, subject: Subject) -> tuple[str, ...]:
        """The robot, if there is gravity. Where all axes of a fixed base are parallel, a vertical
        that leans is the same as another zero of the first joint.
        """
        tree = subject.tree
        if not subject.gravity.any():
            return ()
        if tree.floating:
            return (ROBOT,)
        frames: list[np.ndarray] = []
        for parent, rotation in zip(tree.parent, tree.rotation, strict=True):
            frames.append((frames[parent] if parent >= 0 else np.eye(3)) @ rotation)
        across = np.cross([frame[:, 2] for frame in frames], frames[0][:, 2])
        return () if tree.hinge.all() and np.abs(across).max() < PARALLEL else (ROBOT,)

    @override
    def excited(self, log: Log, motion: Motion) -> Excitation:
        return Excitation(self.identifier, True, (), "gravity acts on the links")

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        across = _across(signals.subject.gravity)
        if signals.subject.floating:
            assert signals.base is not None
            turned = signals.base.rotation @ signals.subject.imu_rotation
            felt = -np.einsum("tji,kj->kti", turned, across)
            return {"accelerometer": np.tensordot(np.atleast_2d(values), felt, 1)}
        rest = np.zeros_like(signals.position)
        motion = signals.position, rest, rest
        leaning = (replace(signals.subject, gravity=g) for g in across)
        needed = np.stack([inverse_dynamics(s, *motion, rotors=False) for s in leaning])
        return {"motion": np.tensordot(np.atleast_2d(values), needed, 1)}

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        remedy = "is added to no simulation: level the base, or declare the logs' `gravity`"
        raise InputError(self.identifier, "location", location, remedy)

    @override
    def usual_errors(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """An angle in each of both directions."""
        return dict.fromkeys(self.locations(subject), np.full(len(self.parameters), LEVEL))

    @override
    def describe(self, values: np.ndarray) -> str:
        return (
            f"feels a vertical that leans by {float(np.hypot(*values)):.2g} rad against the "
            f"declared gravity: its base is not level, or gravity or its orientation are off"
        )


def _across(gravity: np.ndarray) -> np.ndarray:
    """Two vectors across gravity and each other, as long as it `(2, 3)` [m/s^2]."""
    strength = float(np.linalg.norm(gravity))
    down = gravity / strength
    east = np.cross(down, np.eye(3)[int(np.argmin(np.abs(down)))])
    east /= np.linalg.norm(east)
    return strength * np.stack([east, np.cross(east, down)])
