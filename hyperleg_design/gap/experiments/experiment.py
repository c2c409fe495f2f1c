"""Experiments that tell look-alikes apart, and the cheapest one that separates two causes.

What each experiment separates is physics, which each effect states in `Effect.told_apart`. How well
a planned trajectory of one robot separates two causes follows from its Fisher information; see
`excite.design_experiment`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from hyperleg_design.gap.effects import EFFECTS

Cause = tuple[str, str]
"""Effect and location of a cause."""


@dataclass(frozen=True)
class Experiment:
    """Something that a person can do with the robot."""

    name: str
    do: str
    """What to do, one sentence."""
    minutes: float
    """Time that it takes, assumed."""

    def separates(self, effect: str, other: str) -> bool:
        """Decide whether this experiment tells two effects apart, by what either of them declares
        in `told_apart`.

        Args:
            effect: identifier of an effect.
            other: identifier of another effect.

        Returns:
            True if it does.
        """
        return self._declares(effect, other) or self._declares(other, effect)

    def _declares(self, effect: str, other: str) -> bool:
        return effect in EFFECTS and other in EFFECTS[effect].told_apart.get(self.name, ())


EXPERIMENTS: tuple[Experiment, ...] = (
    Experiment(
        "log torque or current",
        "repeat the motion with motor torques or currents logged beside the targets",
        3,
    ),
    Experiment("several amplitudes", "repeat one motion at a quarter, half and full amplitude", 3),
    Experiment(
        "slow ramp",
        "move the joint to and fro at several constant speeds, the slowest below 0.05 rad/s",
        3,
    ),
    Experiment("chirp past 8 Hz", "sweep the joint from 0.2 to 15 Hz at small amplitude", 2),
    Experiment(
        "several postures",
        "hold, and move slowly between, a dozen postures spread over the range of motion",
        5,
    ),
    Experiment(
        "preload",
        "hang a weight on the joint, or lean it on a spring, so that its torque does not change "
        "sign, and repeat the motion",
        5,
    ),
    Experiment(
        "torque-off swing",
        "switch the drive off, move the joint by hand or let it swing, and log its positions",
        6,
    ),
    Experiment(
        "known payload",
        "hang a known mass on the last link, declare it as payload in the metadata, and repeat "
        "the motion",
        5,
    ),
    Experiment(
        "cold and warm",
        "log motor temperature, and repeat the motion cold and after ten minutes of hard work",
        15,
    ),
    Experiment(
        "stiff supply",
        "log the battery's voltage, and repeat the motion on a laboratory supply",
        10,
    ),
    Experiment(
        "known angle",
        "turn the output by hand through a known angle and compare with the encoder at the motor",
        5,
    ),
    Experiment(
        "log rotor speeds",
        "where drives know their rotors' speed, repeat the motion with motor_velocity logged "
        "beside the joints'",
        6,
    ),
    Experiment(
        "rest level", "let the robot stand or lie still on a level table for ten seconds", 1
    ),
    Experiment(
        "push on the ground",
        "press each foot on the ground by a known weight, and pull it sideways until it slides",
        5,
    ),
)
"""Experiments, of which the cheapest that separates two effects is recommended; minutes are
assumed."""
ALONE = Experiment(
    "one joint at a time",
    "move each of the places alone, the others held, by a chirp and a slow ramp",
    6,
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
    """Write an experiment as `diagnosis.json` holds it.

    Args:
        experiment: the experiment.
        causes: look-alikes, the first of which it separates from others.

    Returns:
        Name, instruction, time, and the causes that it separates.
    """
    first = causes[0]
    separated = [
        c for c in causes[1:] if experiment is ALONE or experiment.separates(first[0], c[0])
    ]
    return {
        "name": experiment.name,
        "do": experiment.do,
        "minutes": experiment.minutes,
        "separates": [" at ".join(c) for c in (first, *separated)],
    }
