"""What a trial holds: how many cases of each kind, on which plants and robots, with which effects;
all drawn from one seed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.validation.blind.recorder import Recorder
from hyperleg_design.validation.blind.wrong import CATALOGUE, ODDITIES, WALKING_ONLY

KINDS = {"single": 0.55, "null": 0.15, "compound": 0.13, "outside": 0.17}
"""Share of each kind of case."""
PLANTS = {"rig": 0.5, "other": 0.35, "walking": 0.15}
"""Share of each plant; `rig` and `other` hold the base, `walking` does not."""
RIG_ROBOTS = {"leg": 0.4, "arm": 0.35, "servo": 0.15, "hyperleg": 0.1}
"""Share of each robot on the rigs."""
TORQUES = {"motor_current": 0.5, "motor_torque": 0.2, "motor_torque_command": 0.15, "none": 0.15}
"""What rigs log of their torques."""
MULTIPLES = (1.0, 5.0)
"""Range of an effect's share over the residual of a clean log."""
ROTORS = 0.5
"""Share of rigs that log the speeds of their rotors."""
REFERENCES = 0.5
"""Share of cases with logs of the healthy robot from another day."""
ONE_JOINT_CANNOT = ("link_mass", "link_com", "cross_coupling", "tilted_gravity")
"""Effects that are another one's double on a single pendulum; they go to the arm."""
NEED_DRIVES = ("thermal_derating", "voltage_sag")
"""Effects whose cause, a temperature or a voltage, is then logged."""
WALKING_ONES = (
    "coulomb_friction",
    "viscous_friction",
    "torque_constant",
    "command_delay",
    "encoder_offset",
    "controller_gain",
    "payload",
    "link_mass",
    "imu_bias",
    "ground_friction",
    "ground_compliance",
    "joint_spring",
)
"""Effects that walking logs are drawn with."""
WALKING_ODD = ("tilted_gravity", "periodic_push", "packet_loss", "sensor_drift")
"""Oddities that walking logs are drawn with."""


@dataclass(frozen=True)
class Plan:
    """One case before anything is simulated."""

    index: int
    kind: str
    """One of `KINDS`."""
    plant: str
    """One of `PLANTS`."""
    robot: str
    """A robot of `chain.ROBOTS`."""
    effects: tuple[str, ...]
    multiples: tuple[float, ...]
    """Wanted, an effect each."""
    references: bool
    """Whether logs of the healthy robot go along."""
    recorder: Recorder
    duration: float
    """Of each log [s]."""
    seed: tuple[int, int]
    """Of everything else in the case."""


def plan_cases(
    count: int,
    seed: int,
    *,
    plants: Sequence[str] = tuple(PLANTS),
    duration: tuple[float, float] = (10.0, 14.0),
) -> list[Plan]:
    """Draw a trial's cases; the same seed gives the same cases, whatever else is made beside them.

    Effects go round the catalogue, so that each comes about equally often.

    Args:
        count: cases.
        seed: of the trial.
        plants: to use, of `PLANTS`.
        duration: range of the logs' lengths [s].

    Raises:
        InputError: an unknown plant, none, or fewer than one case.
    """
    unknown = [p for p in plants if p not in PLANTS]
    if unknown or not plants:
        known = ", ".join(PLANTS)
        raise InputError("blind", "plants", unknown or None, f"choose of {known}")
    if count < 1:
        raise InputError("blind", "cases", count, "expects at least 1")
    rng = np.random.default_rng([seed, 0])
    kinds = _apportioned(KINDS, count, rng)
    share = {p: PLANTS[p] for p in plants}
    where = _apportioned(share, count, rng)
    rounds = {
        "rig": _Round([e for e in CATALOGUE if e not in WALKING_ONLY], rng),
        "odd": _Round(ODDITIES, rng),
        "walking": _Round(WALKING_ONES, rng),
        "walking odd": _Round(WALKING_ODD, rng),
    }
    plans = []
    for index, (kind, plant) in enumerate(zip(kinds, where, strict=True)):
        walking = plant == "walking"
        own = np.random.default_rng([seed, 1, index])
        robot = "hyperleg" if walking else _one(RIG_ROBOTS, own)
        source = rounds[
            ("walking" if walking else "rig")
            if kind != "outside"
            else ("walking odd" if walking else "odd")
        ]
        effects = tuple(source.take({"null": 0, "compound": 2}.get(kind, 1)))
        if plant != "walking" and robot == "servo" and any(e in ONE_JOINT_CANNOT for e in effects):
            robot = "arm"
        if plant != "walking" and "voltage_sag" in effects:
            robot = "servo"
            effects = tuple("payload" if e in ONE_JOINT_CANNOT else e for e in effects)
        low, high = MULTIPLES if kind == "single" else (2.0, MULTIPLES[1])
        plan = Plan(
            index=index,
            kind=kind,
            plant=plant,
            robot=robot,
            effects=effects,
            multiples=tuple(float(own.uniform(low, high)) for _ in effects),
            references=bool(own.random() < REFERENCES),
            recorder=Recorder(
                rate=200.0
                if walking
                else float(own.choice([200.0, 250.0, 100.0], p=[0.6, 0.25, 0.15])),
                jitter=float(own.uniform(0.05e-3, 0.4e-3)),
                dropped=float(own.choice([0.0, 0.002, 0.01], p=[0.4, 0.4, 0.2])),
                torque=_one(TORQUES, own) if not walking else "motor_torque",
                velocity=bool(own.random() < 0.8),
                drives=bool(own.random() < 0.6) or bool(set(effects) & set(NEED_DRIVES)),
            ),
            duration=round(float(own.uniform(*duration)), 1),
            seed=(seed, index),
        )
        plans.append(
            plan
            if walking
            else replace(plan, recorder=replace(plan.recorder, rotors=bool(own.random() < ROTORS)))
        )
    return plans


class _Round:
    """Effects in shuffled rounds, each once a round."""

    def __init__(self, names: Sequence[str], rng: np.random.Generator) -> None:
        self.names, self.rng = list(names), rng
        self.left: list[str] = []

    def take(self, count: int) -> list[str]:
        taken: list[str] = []
        while len(taken) < count:
            if not self.left:
                self.left = list(self.rng.permutation(self.names))
            taken.append(str(self.left.pop()))
            if len(set(taken)) < len(taken):
                taken.pop()
        return taken


def _one(shares: dict[str, float], rng: np.random.Generator) -> str:
    names, weights = list(shares), np.array(list(shares.values()))
    return str(rng.choice(names, p=weights / weights.sum()))


def _apportioned(shares: dict[str, float], count: int, rng: np.random.Generator) -> list[str]:
    """Names as often as their shares ask for (largest remainders), shuffled."""
    names, weights = list(shares), np.array(list(shares.values()))
    wanted = weights / weights.sum() * count
    number = np.floor(wanted).astype(int)
    for place in np.argsort(number - wanted, kind="stable")[: count - number.sum()]:
        number[place] += 1
    return [str(n) for n in rng.permutation(np.repeat(names, number))]
