"""Nuisance parameters: small errors that every robot and every log has, which are no causes. They
are fitted in every recording session, each with a normal prior.

Most are parameters of effects of the catalogue at one place, with traces and widths of the effects
themselves. The others are listed here: their names, and the standard deviations of their priors,
all assumed, of the order of the errors of data sheets and drawings. `nuisance_traces` has their
traces.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.placing import ROBOT, driven_motors
from hyperleg_design.gap.effects.sensors.imu_bias import IMU
from hyperleg_design.gap.effects.strength import motor_strength
from hyperleg_design.gap.effects.unlisted.turned_imu import SQUARE
from hyperleg_design.gap.effects.usual import lateness
from hyperleg_design.gap.model.subject import Subject

FORCES_SCALED, OF_FORCES = "contact_scale", 0.005
"""Relative error of the force sensors under a foot, and its deviation [-] (assumed: load cells are
0.1 to 0.5 % off)."""
TURNOVER, SWUNG = "friction_turnover", "friction_in_chatter"
"""Errors of the friction model where a joint reverses. The model's friction follows the speed as
tanh(v / v_s). That of a robot reverses at once, or over the way on which bristles bend, and in a
limit cycle its mean depends on the amplitude. How much of each difference a robot has is
unknown."""
WAYS = (0.0015, 0.006)
"""Half of the ways over which friction reverses [rad]."""
AT_ONCE, OF_WAY = 1.0, 0.3
"""Deviation of the share of the model's friction that reverses at once, and over each way [-]."""
SWINGS, OF_SWING = (0.5, 2.0), 0.7
"""Amplitudes of a limit cycle over the one that the log shows, at which the model's friction is
computed, and the deviation of the share of each difference [-]."""
GEARED, TOLD_LATE, GIVING = "speed_ratio", "speed_told_late", "stiff_belt"
"""Errors between the logged speed of a motor and that of its joints: of the ratio, of the time
between the samples of both sensors, and the compliance of a belt or gear that counts as stiff."""
SPEEDS = (GEARED, TOLD_LATE, GIVING)
OF_SPEED = 0.003
"""Deviation of the ratio [-]: cords run on their own thickness, linkages differ from their
drawing."""
STIFF, GIVES = 60.0, 0.001
"""Resonance of a rotor on a stiff belt [Hz], and angle at the joint by which a stiff gear yields
under its largest torque [rad]; the larger compliance of both is the deviation."""
SOLE, SOLE_GIVES = "sole_height", "sole_gives"
"""Height at which the ground's force acts under a pad: as soles wear, and as they yield under
load."""
SOLES = 0.004
"""Deviation of both [m]."""
FORCES_LATE, TORQUES_LATE = "contact_told_late", "torque_told_late"
"""Delay of logged contact forces and of logged torques, with the deviation `lateness` [s]."""
STEPPED, OF_STEPPED = "friction_stepped", 0.5
"""Friction as simulators integrate it (damping f(v) / v at the speed before a step, times the speed
after it) less friction at the speed itself, and the deviation of its share [-]."""
FILTERED, OF_FILTER = "speed_filtered", 0.005
"""Delay of the speed that a controller's damping acts on, and its deviation [s]: drives filter
speeds at 30-200 Hz, or difference positions (assumed)."""
TARGETS_AGED, OF_STEP = "target_age", 0.29
"""Age of targets at the moment when a row's positions and torques are measured, where they are kept
from row to row, beyond half a step; and its deviation over the step [-] (derived: anywhere within
the step, as a program may log before it sends a target, or after)."""
TARGETS_LATE = "target_delay"
"""Delay of targets alone on their way to controllers that know their joints' state at once; its
deviation is `lateness` [s]."""
BACK_EMF, OF_ROTOR = "back_emf", 0.7
"""Torque that a current loop gives up to the changing back-EMF of its motor: short of the command
by an inertia times the acceleration, K_t^2 / (R w) for a loop of bandwidth w, which is the rotor's
over the product of w and the motor's mechanical time constant. 0.7 is the deviation of the ratio
[-]: time constants of 1 to 3 ms and loops of 100 Hz to 1 kHz give 0.05 to 1.6 (assumed)."""
IMU_TURNED = "imu_turned"
"""Small turns of the IMU about its own axes; their deviation is `turned_imu.SQUARE` [rad]."""
TORQUE_ZERO = "torque_zero"
"""Zero of a torque sensor between gear and link, in each log (`zeros`)."""
UNLISTED = (
    *SPEEDS,
    SOLE,
    SOLE_GIVES,
    FORCES_LATE,
    FORCES_SCALED,
    TORQUES_LATE,
    STEPPED,
    FILTERED,
    TARGETS_AGED,
    TARGETS_LATE,
    BACK_EMF,
    IMU_TURNED,
    TORQUE_ZERO,
)
"""Nuisance parameters that belong to no effect of the catalogue, one of each name at a place."""


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
    def steady(self) -> bool:
        """Whether it is the same in all sessions: masses, rotors, settings of drives, and gains of
        force sensors are.
        """
        return self.inertial or self.known or self.effect in (FILTERED, BACK_EMF, IMU_TURNED)

    @property
    def known(self) -> bool:
        """Whether no scale of a channel enlarges its deviation: forces that count for nothing, and
        links without mass, would leave no residual, in which no load could show.
        """
        return self.effect == FORCES_SCALED

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
    """List the nuisance parameters of a robot.

    Args:
        subject: the robot.
        step: of its logs [s].
        calibrated: whether there are reference logs, which show friction that the model lacks, so
            that spreads are those between sessions.
        rubbing: the robot with the dry and viscous friction that its logs show, where the model has
            none.
    """
    usual = _Usual(rubbing or subject, step, calibrated)
    parameters: list[NuisanceParameter] = []
    for j, joint in enumerate(subject.joints):
        if subject.coulomb[j] > 0:
            parameters += [
                NuisanceParameter(TURNOVER, joint, i, OF_WAY if i else AT_ONCE)
                for i in range(1 + len(WAYS))
            ]
            parameters += [NuisanceParameter(SWUNG, joint, i, OF_SWING) for i in range(len(SWINGS))]
        elif calibrated:  # what is calibrated turns over at once already
            parameters += [
                NuisanceParameter(TURNOVER, joint, 1 + i, OF_WAY) for i in range(len(WAYS))
            ]
        parameters += usual.at("joint", joint)
    late, driven = lateness(step), set(driven_motors(subject))
    parameters += usual.of("robot")
    parameters += [
        NuisanceParameter(effect, ROBOT, 0, late)
        for effect in (TORQUES_LATE, FORCES_LATE, TARGETS_LATE)
    ]
    parameters += [
        NuisanceParameter(STEPPED, ROBOT, 0, OF_STEPPED),
        NuisanceParameter(FILTERED, ROBOT, 0, OF_FILTER),
        NuisanceParameter(TARGETS_AGED, ROBOT, 0, OF_STEP * step),
    ]
    parameters += [
        NuisanceParameter(IMU_TURNED, IMU, axis, SQUARE)
        for axis in (range(3) if subject.floating else ())
    ]
    parameters += [
        NuisanceParameter(effect, foot, 0, SOLES)
        for foot in subject.feet
        for effect in (SOLE, SOLE_GIVES)
    ]
    parameters += [NuisanceParameter(FORCES_SCALED, foot, 0, OF_FORCES) for foot in subject.feet]
    for m, motor in enumerate(subject.motors):
        parameters += usual.at("motor", motor)
        parameters.append(
            NuisanceParameter(BACK_EMF, motor, 0, OF_ROTOR * float(subject.rotor_inertia[m]))
        )
        if motor in driven:
            parameters += [
                NuisanceParameter(GEARED, motor, 0, OF_SPEED),
                NuisanceParameter(TOLD_LATE, motor, 0, late),
                NuisanceParameter(GIVING, motor, 0, _give(subject, m)),
            ]
    parameters += usual.of("link") + usual.of("sensor") + usual.of("foot")
    return [parameter for parameter in parameters if parameter.spread > 0]


class _Usual:
    """Nuisance parameters that are parameters of effects, by kind and place."""

    def __init__(self, subject: Subject, step: float, calibrated: bool) -> None:
        self.by_kind: dict[str, list[tuple[str, Mapping[str, np.ndarray]]]] = {}
        for effect in sorted(EFFECTS.values(), key=lambda effect: effect.nuisance_rank):
            own = self.by_kind.setdefault(effect.kind, [])
            spreads = effect.session_spreads if calibrated else effect.nuisance_spreads
            own.append((effect.identifier, spreads(subject, step)))

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
    """Compliance of a belt or gear that counts as stiff, on the motor's side [rad/Nm]."""
    inertia = float(subject.rotor_inertia[motor])
    of_belt = 1 / (inertia * (2 * np.pi * STIFF) ** 2) if inertia > 0 else 0.0
    of_gear = (
        GIVES
        * float(np.abs(subject.joint_from_motor[:, motor]).max())
        / motor_strength(subject, motor)
    )
    return max(of_belt, of_gear)
