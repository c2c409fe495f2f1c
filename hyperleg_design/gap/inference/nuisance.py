"""The usual small nuisance parameters, which are no causes: priors of each, fitted anew for every
recording session.

Most are parameters of effects of the catalogue at one place, so that their traces and widths are
the effects' own; the rest are listed here. Widths are assumed, of the order that data sheets and
drawings are wrong by.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.placing import ROBOT, driven_motors, motor_strength
from hyperleg_design.gap.effects.usual import lateness
from hyperleg_design.gap.model.subject import Subject

FORCES_SCALED, OF_FORCES = "contact_scale", 0.01
"""Share by which the forces under a foot are told too large or too small (assumed: load cells in
feet)."""
TURNOVER, SWUNG = "friction_turnover", "friction_in_chatter"
"""Friction of models turns over with speed, as tanh(v / v_s); that of robots at once, or over a way
on which bristles bend. By how much of these differences, nobody knows: no effect of the catalogue,
and no nuisance parameter that is small."""
GEARED, TOLD_LATE, GIVING = "speed_ratio", "speed_told_late", "stiff_belt"
"""Of motors whose speed is logged beside that of their joints, which shows what no other residual
does: a share of it, the time between both sensors' samples, and belts and gears as stiff as they
are, which give a little."""
SPEEDS = (GEARED, TOLD_LATE, GIVING)
OF_SPEED = 0.003
"""Of the joints' speed: cords run on their own thickness, linkages off their drawing (assumed)."""
STIFF, GIVES = 60.0, 0.001
"""Frequency of a rotor on a belt that nobody calls soft [Hz], and angle at a joint by which one
gives under all of its torque [rad]; the softer of both is usual."""
SOLE, SOLE_GIVES = "sole_height", "sole_gives"
"""Where under a pad the ground's force acts, as soles wear, and give under load."""
FORCES_LATE, TORQUES_LATE = "contact_told_late", "torque_told_late"
"""How late forces and torques are told, or early."""
STEPPED, OF_STEPPED = "friction_stepped", 0.5
"""Friction as simulators step it, the damping f(v) / v of a tick's speed times the next one's, less
friction as it is; a share of it."""
FILTERED, OF_FILTER = "speed_filtered", 0.0015
"""How late controllers take speeds for their damping [s]: drives filter them at 50-200 Hz, or
difference positions (assumed)."""
SOLES = 0.004
"""[m] (assumed)."""
UNLISTED = (*SPEEDS, SOLE, SOLE_GIVES, FORCES_LATE, FORCES_SCALED, TORQUES_LATE, STEPPED, FILTERED)
"""Usual errors that are no effects of the catalogue, each with one parameter."""
WAYS = (0.0015, 0.006)
"""On which it turns over, half of each [rad]; assumed, beside that of `effects.joints.friction`."""
SWINGS, OF_SWING = (0.5, 2.0), 0.7
"""Other amplitudes of chatter over those that a log shows at its rate; share of the difference in
friction (assumed)."""
AT_ONCE, OF_WAY = 1.0, 0.3
"""Share of the model's friction that turns over at once, and on each of these ways."""


@dataclass(frozen=True)
class NuisanceParameter:
    """One nuisance parameter."""

    effect: str
    location: str
    parameter: int
    spread: float
    """Standard deviation from the null, in the parameter's unit."""

    @property
    def inertial(self) -> bool:
        """Whether it is of masses or rotors, see `Effect.inertial`."""
        return self.effect in EFFECTS and EFFECTS[self.effect].inertial

    @property
    def name(self) -> str:
        """Parameter and place in words, for reports."""
        if self.effect in UNLISTED:
            return f"{self.effect} at {self.location}"
        parameter = (
            "share"
            if self.effect in (TURNOVER, SWUNG)
            else EFFECTS[self.effect].parameters[self.parameter].name
        )
        return f"{self.effect} at {self.location}: {parameter}"


def nuisance_parameters(
    subject: Subject, step: float, calibrated: bool = False, rubbing: Subject | None = None
) -> list[NuisanceParameter]:
    """Nuisance parameters of a robot.

    Args:
        subject: the robot.
        step: of its logs [s].
        calibrated: whether reference logs tell of friction that the model does not have, which
            turns over as the model's does.
        rubbing: the robot with the dry friction that it has, where that is not the model's.
    """
    usual = _Usual(rubbing or subject, step)
    found: list[NuisanceParameter] = []
    for j, joint in enumerate(subject.joints):
        if subject.coulomb[j] > 0:
            found += [
                NuisanceParameter(TURNOVER, joint, i, OF_WAY if i else AT_ONCE)
                for i in range(1 + len(WAYS))
            ]
            found += [NuisanceParameter(SWUNG, joint, i, OF_SWING) for i in range(len(SWINGS))]
        elif calibrated:  # what is calibrated turns over at once already
            found += [NuisanceParameter(TURNOVER, joint, 1 + i, OF_WAY) for i in range(len(WAYS))]
        found += usual.at("joint", joint)
    late, driven = lateness(step), set(driven_motors(subject))
    found += usual.of("robot")
    found += [NuisanceParameter(effect, ROBOT, 0, late) for effect in (TORQUES_LATE, FORCES_LATE)]
    found += [
        NuisanceParameter(STEPPED, ROBOT, 0, OF_STEPPED),
        NuisanceParameter(FILTERED, ROBOT, 0, OF_FILTER),
    ]
    found += [
        NuisanceParameter(effect, foot, 0, SOLES)
        for foot in subject.feet
        for effect in (SOLE, SOLE_GIVES)
    ]
    found += [NuisanceParameter(FORCES_SCALED, foot, 0, OF_FORCES) for foot in subject.feet]
    for m, motor in enumerate(subject.motors):
        found += usual.at("motor", motor)
        if motor in driven:
            found += [
                NuisanceParameter(GEARED, motor, 0, OF_SPEED),
                NuisanceParameter(TOLD_LATE, motor, 0, late),
                NuisanceParameter(GIVING, motor, 0, _give(subject, m)),
            ]
    found += usual.of("link") + usual.of("sensor") + usual.of("foot")
    return [one for one in found if one.spread > 0]


class _Usual:
    """Nuisance parameters that are parameters of effects, by kind and place."""

    def __init__(self, subject: Subject, step: float) -> None:
        self.by_kind: dict[str, list[tuple[str, Mapping[str, np.ndarray]]]] = {}
        for effect in sorted(EFFECTS.values(), key=lambda effect: effect.nuisance_rank):
            own = self.by_kind.setdefault(effect.kind, [])
            own.append((effect.identifier, effect.nuisance_spreads(subject, step)))

    def of(self, kind: str) -> list[NuisanceParameter]:
        """List those of all places of a kind, place by place.

        Args:
            kind: one of `KINDS` of effects.

        Returns:
            The parameters.
        """
        places = dict.fromkeys(place for _, by_place in self.by_kind[kind] for place in by_place)
        return [parameter for place in places for parameter in self.at(kind, place)]

    def at(self, kind: str, place: str) -> list[NuisanceParameter]:
        """List those of one place, in the order of the effects' ranks.

        Args:
            kind: one of `KINDS` of effects.
            place: the location.

        Returns:
            The parameters.
        """
        return [
            NuisanceParameter(effect, place, parameter, float(spread))
            for effect, by_place in self.by_kind[kind]
            if place in by_place
            for parameter, spread in enumerate(by_place[place].tolist())
        ]


def _give(subject: Subject, motor: int) -> float:
    """Compliance of a belt or gear as they are, on the motor's side [rad/Nm]."""
    inertia = float(subject.rotor_inertia[motor])
    of_belt = 1 / (inertia * (2 * np.pi * STIFF) ** 2) if inertia > 0 else 0.0
    of_gear = (
        GIVES
        * float(np.abs(subject.joint_from_motor[:, motor]).max())
        / motor_strength(subject, motor)
    )
    return max(of_belt, of_gear)
