"""Experiments that tell look-alikes apart: the cheapest one that separates two causes, and what a
planned motion is worth for it.

What each experiment separates is physics, stated below; how well a planned trajectory of this robot
does, Fisher information says (`worth`, from `information.distinction` on the trajectory's
conditioned log).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from hyperleg_design.gap.effects.friction import FRICTION

if TYPE_CHECKING:
    from hyperleg_design.gap.signals.signals import Signals

Cause = tuple[str, str]
"""Effect and location."""
INERTIAL = frozenset({"payload", "link_mass", "link_com"})
LATE = frozenset({"command_delay", "actuator_bandwidth"})
SCALING = frozenset(
    {"torque_constant", "transmission_ratio", "thermal_derating", "controller_gain", "voltage_sag"}
)


@dataclass(frozen=True)
class Experiment:
    """Something that a person can do with the robot."""

    name: str
    do: str
    """What to do, one sentence."""
    minutes: float
    """Time that it takes, assumed."""
    between: tuple[tuple[frozenset[str], frozenset[str]], ...]
    """Effects of one side against those of the other that it separates."""

    def separates(self, one: str, other: str) -> bool:
        """Whether it tells two effects apart."""
        return any((one in a and other in b) or (one in b and other in a) for a, b in self.between)


def _set(*names: str) -> frozenset[str]:
    return frozenset(names)


EXPERIMENTS: tuple[Experiment, ...] = (
    Experiment(
        "log torque or current",
        "repeat the motion with motor torques or currents logged beside the targets",
        3,
        (
            (
                _set(
                    "controller_gain",
                    "command_delay",
                    "actuator_bandwidth",
                    "torque_saturation",
                    "voltage_sag",
                ),
                FRICTION
                | INERTIAL
                | _set(
                    "torque_constant",
                    "transmission_ratio",
                    "rotor_inertia",
                    "joint_spring",
                    "encoder_offset",
                    "thermal_derating",
                    "backlash",
                    "transmission_elasticity",
                    "cogging",
                ),
            ),
        ),
    ),
    Experiment(
        "several amplitudes",
        "repeat one motion at a quarter, half and full amplitude",
        3,
        (
            (_set("controller_gain"), _set("torque_saturation", "backlash")),
            (
                FRICTION - {"viscous_friction"},
                _set(
                    "viscous_friction",
                    "controller_gain",
                    "torque_constant",
                    "transmission_elasticity",
                ),
            ),
            (_set("transmission_elasticity"), _set("backlash")),
            (_set("joint_spring"), _set("coulomb_friction", "backlash")),
            (_set("voltage_sag"), _set("controller_gain", "torque_constant", "torque_saturation")),
        ),
    ),
    Experiment(
        "slow ramp",
        "move the joint to and fro at several constant speeds, the slowest below 0.05 rad/s",
        3,
        (
            (
                _set("coulomb_friction"),
                _set(
                    "viscous_friction",
                    "stribeck_friction",
                    "load_dependent_friction",
                    "joint_spring",
                    "cogging",
                ),
            ),
            (
                _set("stribeck_friction"),
                _set("viscous_friction", "load_dependent_friction", "backlash", "cogging"),
            ),
            (
                _set("viscous_friction"),
                _set("controller_gain", "command_delay", "actuator_bandwidth"),
            ),
            (_set("cogging"), FRICTION | _set("joint_spring", "encoder_offset")),
        ),
    ),
    Experiment(
        "chirp past 8 Hz",
        "sweep the joint from 0.2 to 15 Hz at small amplitude",
        2,
        (
            (
                _set("transmission_elasticity"),
                LATE | _set("rotor_inertia", "viscous_friction", "controller_gain"),
            ),
            (
                _set("command_delay"),
                _set("actuator_bandwidth", "controller_gain", "viscous_friction"),
            ),
            (
                _set("actuator_bandwidth"),
                _set("controller_gain", "viscous_friction", "rotor_inertia"),
            ),
            (
                _set("rotor_inertia"),
                _set("torque_constant", "transmission_ratio", "controller_gain"),
            ),
            (_set("transmission_ratio"), _set("torque_constant")),
        ),
    ),
    Experiment(
        "several postures",
        "hold, and move slowly between, a dozen postures spread over the range of motion",
        5,
        (
            (
                _set("encoder_offset"),
                INERTIAL | _set("joint_spring", "torque_constant", "imu_bias"),
            ),
            (_set("rotor_inertia"), INERTIAL),
            (_set("joint_spring"), INERTIAL),
            (_set("link_com"), _set("link_mass", "payload")),
            (_set("link_mass"), _set("payload")),
        ),
    ),
    Experiment(
        "preload",
        "hang a weight on the joint, or lean it on a spring, so that its torque does not change "
        "sign, and repeat the motion",
        5,
        (
            (_set("backlash"), FRICTION | LATE | _set("transmission_elasticity", "cogging")),
            (_set("load_dependent_friction"), FRICTION - {"load_dependent_friction"}),
        ),
    ),
    Experiment(
        "torque-off swing",
        "switch the drive off, move the joint by hand or let it swing, and log its positions",
        6,
        (
            (
                _set("viscous_friction", "coulomb_friction", "joint_spring"),
                _set("controller_gain", "torque_constant", "transmission_ratio", "voltage_sag"),
            ),
            (
                INERTIAL | _set("rotor_inertia"),
                _set("controller_gain", "torque_constant", "voltage_sag", "transmission_ratio"),
            ),
        ),
    ),
    Experiment(
        "known payload",
        "hang a known mass on the last link, declare it as payload in the metadata, and repeat the "
        "motion",
        5,
        (
            (
                _set(
                    "torque_constant", "transmission_ratio", "thermal_derating", "controller_gain"
                ),
                INERTIAL | _set("encoder_offset", "joint_spring", "load_dependent_friction"),
            ),
            (_set("load_dependent_friction"), FRICTION - {"load_dependent_friction"}),
        ),
    ),
    Experiment(
        "cold and warm",
        "log motor temperature, and repeat the motion cold and after ten minutes of hard work",
        15,
        (
            (
                _set("thermal_derating"),
                _set(
                    "torque_constant",
                    "transmission_ratio",
                    "controller_gain",
                    "voltage_sag",
                    "load_dependent_friction",
                ),
            ),
            (_set("viscous_friction"), _set("torque_constant")),
        ),
    ),
    Experiment(
        "stiff supply",
        "log the battery's voltage, and repeat the motion on a laboratory supply",
        10,
        (
            (
                _set("voltage_sag"),
                SCALING
                | _set(
                    "torque_saturation", "actuator_bandwidth", "command_delay", "thermal_derating"
                ),
            ),
        ),
    ),
    Experiment(
        "known angle",
        "turn the output by hand through a known angle and compare with the encoder at the motor",
        5,
        ((_set("transmission_ratio"), SCALING | _set("rotor_inertia")),),
    ),
    Experiment(
        "log rotor speeds",
        "where drives know their rotors' speed, repeat the motion with motor_velocity logged "
        "beside the joints'",
        6,
        (
            (
                _set("transmission_ratio", "transmission_elasticity", "backlash"),
                FRICTION
                | INERTIAL
                | LATE
                | _set(
                    "torque_constant",
                    "thermal_derating",
                    "voltage_sag",
                    "torque_saturation",
                    "controller_gain",
                    "rotor_inertia",
                    "encoder_offset",
                    "joint_spring",
                    "cogging",
                ),
            ),
            (_set("transmission_ratio"), _set("transmission_elasticity", "backlash")),
        ),
    ),
    Experiment(
        "rest level",
        "let the robot stand or lie still on a level table for ten seconds",
        1,
        ((_set("imu_bias"), INERTIAL | _set("encoder_offset", "joint_spring")),),
    ),
    Experiment(
        "push on the ground",
        "press each foot on the ground by a known weight, and pull it sideways until it slides",
        5,
        (
            (
                _set("ground_friction", "ground_compliance"),
                _set("ground_friction", "ground_compliance") | INERTIAL | FRICTION,
            ),
        ),
    ),
)
"""From the page of look-alikes; minutes are assumed."""
ALONE = Experiment(
    "one joint at a time",
    "move each of the places alone, the others held, by a chirp and a slow ramp",
    6,
    (),
)


def separating(causes: Sequence[Cause]) -> Experiment | None:
    """The cheapest experiment that separates the first of some causes from the most of the others.

    Args:
        causes: that data cannot tell apart, the most likely first.

    Returns:
        None for fewer than two.
    """
    if len(causes) < 2:
        return None
    first = causes[0][0]
    others = [effect for effect, _ in causes[1:] if effect != first]
    if not others:
        return ALONE
    best = max(
        EXPERIMENTS, key=lambda e: (sum(e.separates(first, other) for other in others), -e.minutes)
    )
    return best if any(best.separates(first, other) for other in others) else ALONE


def as_mapping(experiment: Experiment, causes: Sequence[Cause]) -> dict[str, Any]:
    """As `diagnosis.json` holds it."""
    first = causes[0]
    told = [c for c in causes[1:] if experiment is ALONE or experiment.separates(first[0], c[0])]
    return {
        "name": experiment.name,
        "do": experiment.do,
        "minutes": experiment.minutes,
        "separates": [" at ".join(c) for c in (first, *told)],
    }


def worth(motions: Mapping[str, Signals], pair: tuple[Cause, Cause]) -> dict[str, float]:
    """How many standard deviations tell two causes of usual size apart on each planned motion.

    Args:
        motions: conditioned logs of planned trajectories, by name.
        pair: two causes.
    """
    from hyperleg_design.gap.experiments.information import blocks_of, distinction, information

    found = {}
    for name, signals in motions.items():
        blocks = blocks_of(signals.subject, _effects(pair))
        gram = information(signals, blocks)
        found[name] = distinction(gram, blocks, pair[0], [pair[1]])
    return found


def _effects(pair: Iterable[Cause]) -> list[str]:
    return sorted({effect for effect, _ in pair})
