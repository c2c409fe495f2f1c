"""The usual small nuisance parameters, which are no causes: priors of each, fitted anew for every
recording session.

Each is one parameter of an effect of the catalogue at one place, so that its trace is the effect's
own. Widths are assumed, of the order that data sheets and drawings are wrong by.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.placing import (
    ROBOT,
    driven_motors,
    joint_inertia,
    joint_strength,
    motor_strength,
)

if TYPE_CHECKING:
    from hyperleg_design.gap.model.subject import Subject

TORQUE_CONSTANT = 0.03
COULOMB, COULOMB_LEAST = 0.08, 0.0008
"""Of the model's friction, and of the torque that the joint is made for."""
VISCOUS, VISCOUS_LEAST = 0.12, 0.0007
BREAKAWAY = 0.08
"""Of the model's Coulomb friction."""
LOAD_FRICTION = 0.006
OFFSET = 0.003
"""[rad]"""
MASS, CENTRE, SHORTEST = 0.03, 0.03, 0.03
"""Of the link's mass; of the distance of its centre of mass from its joint, at least of so many
metres."""
ROTOR, OWN_INERTIA = 0.06, 0.01
"""Of the rotor's inertia and of that of its joint."""
TORQUE_OFFSET, SPRING = 0.002, 0.002
"""Of the torque that the joint is made for, and that a radian."""
LATE, LATE_TICKS = 0.001, 0.15
"""[s] and ticks of the log, of all drives; a lag of one of them is half."""
READING = 1
"""Parameter of a torque constant by which currents are read wrongly."""
CURRENT = 0.005
"""Of the torque that a drive says that it gives, apart from its motor's."""
GAIN = 0.015
GYRO, ACCELEROMETER = 0.003, 0.05
"""[rad/s], [m/s^2]"""
GROUND, BEARING = 0.1, 0.5
"""Of the ground's friction; of how it gives and damps, which no simulator has from a
measurement."""
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
"""On which it turns over, half of each [rad]; assumed, beside that of `effects.friction`."""
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
    def name(self) -> str:
        """For people."""
        if self.effect in UNLISTED:
            return f"{self.effect} at {self.location}"
        parameter = (
            "share"
            if self.effect in (TURNOVER, SWUNG)
            else EFFECTS[self.effect].parameters[self.parameter].name
        )
        return f"{self.effect} at {self.location}: {parameter}"


def nuisance_parameters(
    subject: Subject, step: float, calibrated: bool = False
) -> list[NuisanceParameter]:
    """Nuisance parameters of a robot.

    Args:
        subject: the robot.
        step: of its logs [s].
        calibrated: whether reference logs tell of friction that the model does not have, which
            turns over as the model's does.
    """
    strength, inertia = joint_strength(subject), joint_inertia(subject)
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
        coulomb = COULOMB * subject.coulomb[j] + COULOMB_LEAST * strength[j]
        found += [
            NuisanceParameter("coulomb_friction", joint, 0, coulomb),
            NuisanceParameter(
                "viscous_friction",
                joint,
                0,
                VISCOUS * subject.viscous[j] + VISCOUS_LEAST * strength[j],
            ),
            NuisanceParameter(
                "stribeck_friction",
                joint,
                0,
                BREAKAWAY * subject.coulomb[j] + 0.3 * COULOMB_LEAST * strength[j],
            ),
            NuisanceParameter("load_dependent_friction", joint, 0, LOAD_FRICTION),
            NuisanceParameter("encoder_offset", joint, 0, OFFSET),
            NuisanceParameter("joint_spring", joint, 0, SPRING * strength[j]),
            NuisanceParameter("joint_spring", joint, 1, TORQUE_OFFSET * strength[j]),
            NuisanceParameter("controller_gain", joint, 0, GAIN),
            NuisanceParameter("controller_gain", joint, 1, GAIN),
        ]
    late, driven = LATE + LATE_TICKS * step, set(driven_motors(subject))
    found += [
        NuisanceParameter(effect, "robot", 0, late)
        for effect in ("command_delay", TORQUES_LATE, FORCES_LATE)
    ]
    found += [
        NuisanceParameter(STEPPED, "robot", 0, OF_STEPPED),
        NuisanceParameter(FILTERED, "robot", 0, OF_FILTER),
    ]
    found += [
        NuisanceParameter(effect, foot, 0, SOLES)
        for foot in subject.feet
        for effect in (SOLE, SOLE_GIVES)
    ]
    found += [NuisanceParameter(FORCES_SCALED, foot, 0, OF_FORCES) for foot in subject.feet]
    for m, motor in enumerate(subject.motors):
        column = np.abs(subject.joint_from_motor[:, m])
        main = int(np.argmax(column))
        rotor = (
            ROTOR * subject.rotor_inertia[m]
            + OWN_INERTIA * inertia[main] / max(float(column[main]), 1e-9) ** 2
        )
        found += [
            NuisanceParameter("torque_constant", motor, 0, TORQUE_CONSTANT),
            NuisanceParameter("torque_constant", motor, READING, CURRENT),
            NuisanceParameter("rotor_inertia", motor, 0, rotor),
            NuisanceParameter("actuator_bandwidth", motor, 0, 0.5 * late),
            NuisanceParameter(GEARED, motor, 0, OF_SPEED),
            NuisanceParameter(TOLD_LATE, motor, 0, late),
        ]
        if motor in driven:
            found.append(NuisanceParameter(GIVING, motor, 0, _give(subject, m)))
    for link in EFFECTS["link_mass"].locations(subject):
        own = subject.tree.link_inertial[subject.tree.link(link)]
        arm = max(float(np.linalg.norm(own[1:4] / own[0])), SHORTEST)
        found.append(NuisanceParameter("link_mass", link, 0, MASS * own[0]))
        found += [NuisanceParameter("link_com", link, axis, CENTRE * arm) for axis in range(3)]
    if subject.floating:
        found += [
            NuisanceParameter("imu_bias", "imu", i, GYRO if i < 3 else ACCELEROMETER)
            for i in range(6)
        ]
        for foot in subject.feet:
            found += [
                NuisanceParameter("ground_friction", foot, 0, GROUND),
                NuisanceParameter("ground_compliance", foot, 0, BEARING),
            ]
            found.append(NuisanceParameter("ground_compliance", foot, 1, BEARING))
    places = {name: set(one.locations(subject)) for name, one in EFFECTS.items()}
    places |= {name: set(subject.feet) for name in (SOLE, SOLE_GIVES, FORCES_SCALED)}
    places |= {name: {ROBOT} for name in (FORCES_LATE, TORQUES_LATE, STEPPED, FILTERED)}
    places |= {name: set(subject.joints) for name in (TURNOVER, SWUNG)} | dict.fromkeys(
        SPEEDS, driven
    )
    return [one for one in found if one.location in places[one.effect] and one.spread > 0]


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


def turning(subject: Subject) -> np.ndarray:
    """Friction whose turning over is a nuisance parameter `(n,)` [Nm]: the model's, or a usual
    error where it has none.
    """
    return np.where(subject.coulomb > 0, subject.coulomb, COULOMB_LEAST * joint_strength(subject))
