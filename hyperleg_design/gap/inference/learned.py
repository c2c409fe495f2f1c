"""What a healthy robot shows already: effects named on reference logs, which are then part of the
model and no news.

Drives of servos and small arms reach limits in ordinary use, follow their voltage, or have other
gains than their sheets say. Left out, the first log that moves otherwise than the references looks
like a fault. So reference logs are diagnosed first, by the same rules, and what is named there is
held to be true of the robot for life, as well as those logs tell it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.friction import FRICTION
from hyperleg_design.gap.inference.nuisance import NuisanceParameter
from hyperleg_design.gap.inference.screen import linearise

if TYPE_CHECKING:
    from hyperleg_design.gap.inference.model import Model
    from hyperleg_design.gap.inference.samples import Samples
    from hyperleg_design.gap.model.subject import Subject

ANOTHER_DAY = 0.05
"""Of a learned parameter, its change from one day to the next (assumed)."""


@dataclass(frozen=True, eq=False)
class Learned:
    """An effect that the healthy robot has."""

    effect: str
    location: str
    values: np.ndarray
    usual: np.ndarray
    """`(k,)`"""
    deviation: np.ndarray
    """Of the values, as the reference logs tell it, and from day to day `(k,)`."""

    @property
    def says(self) -> str:
        """For people."""
        found = ", ".join(
            f"{p.name} {v:.3g} {p.unit}".strip()
            for p, v in zip(EFFECTS[self.effect].parameters, self.values, strict=True)
        )
        return (
            f"reference logs show {self.effect} at {self.location} ({found}); taken for the "
            f"robot's own"
        )

    def errors(self) -> list[NuisanceParameter]:
        """What is left open of it, as nuisance parameters."""
        return [
            NuisanceParameter(self.effect, self.location, i, float(max(d, 1e-9 * u)))
            for i, (d, u) in enumerate(zip(self.deviation, self.usual, strict=True))
        ]

    def columns(self, samples: Samples) -> tuple[np.ndarray, np.ndarray] | None:
        """Its trace `(S,)`, and that of its errors at their deviation `(k, S)`, in other logs; None
        where these do not show it.
        """
        cause = linearise(samples, EFFECTS[self.effect], self.location, self.values)
        if cause is None:
            return None
        return cause.trace(cause.phi), cause.columns * (self.deviation / self.usual)[:, None]


def unsaid(subject: Subject) -> list[tuple[str, str]]:
    """Effects and places of which a model says nothing, though every machine has them: friction of
    joints that have none in it, rotors.
    """
    driven = subject.one_to_one & ~subject.passive
    free = [
        joint
        for joint, own, has in zip(subject.joints, subject.coulomb, driven, strict=True)
        if has and not own
    ]
    places = EFFECTS["rotor_inertia"].locations(subject)
    rotors = [
        motor
        for motor, own in zip(subject.motors, subject.rotor_inertia, strict=True)
        if motor in places and not own
    ]
    return [(effect, joint) for effect in sorted(FRICTION) for joint in free] + [
        ("rotor_inertia", motor) for motor in rotors
    ]


def learned(model: Model) -> tuple[Learned, ...]:
    """The causes that were named on reference logs.

    Args:
        model: of them.
    """
    found = []
    for place, cause in enumerate(model.causes):
        values = model.values(place)
        deviation = np.hypot(model.deviation(place), ANOTHER_DAY * np.abs(values - cause.nulls))
        found.append(Learned(cause.effect, cause.location, values, cause.usual, deviation))
    return tuple(found)
