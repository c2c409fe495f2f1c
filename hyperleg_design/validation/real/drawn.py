"""Faults that a seed draws and writes into the double pendulum's recordings of the first day.

The motion is the recorded one. What a fault asks of a drive is added to the torques that the log
holds, commanded and measured alike, or the log is scaled, shifted, or told another load. So kind,
joint, size, recordings, references and channels are nobody's choice; each case can be a hard one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from hyperleg_design.validation.benchmark.case import Case, Fault, Material, Recording, Truth
from hyperleg_design.validation.real.a0 import (
    CHANNELS,
    COMMAND,
    DEVELOPMENT,
    FOLDER,
    MEASURED,
    MODEL,
    WEAK,
    read_recording,
)
from hyperleg_design.validation.real.a0_model import JOINTS, LINKS, DoublePendulum, read_model

SEED, COUNT = 1, 50
"""Of the cases, and how many there are; frozen with the version."""
KINDS = (
    *("nothing",) * 3,
    *("torque",) * 2,
    *("encoder",) * 2,
    *("load",) * 3,
    *("pair",) * 2,
    *("coulomb", "viscous", "spring", "delay", "drag", "push"),
)
"""What is drawn, as often as it stands here; `drag` and `push` are not in the catalogue."""
PAIRED = ("torque", "encoder", "load", "coulomb", "viscous")
"""Of which two are drawn for a pair, one at each joint."""
REFERENCED = 0.7
"""Share of the cases with reference logs."""
SIZES = {
    "torque": ((1.15, 1.6), (1.15, 1.6)),
    "encoder": ((0.05, 0.15), (0.05, 0.15)),
    "load": ((0.2, 0.5), (0.2, 0.5)),
    "coulomb": ((0.25, 0.6), (0.15, 0.4)),
    "viscous": ((0.1, 0.24), (0.05, 0.12)),
    "spring": ((1.6, 4.0), (0.8, 2.0)),
    "delay": ((0.010, 0.025), (0.010, 0.025)),
    "drag": ((0.04, 0.1), (0.016, 0.04)),
    "push": ((1.2, 3.0), (0.6, 1.6)),
}
"""From and to, at the shoulder and at the elbow: factor (or its inverse) [-], offset [rad], load
[kg], torque [Nm], [Nms/rad], [Nm/rad], [s], [Nms²/rad²], [Nm]."""
SLOW, PUSHED = 0.05, 0.4
"""Speed at which friction turns over [rad/s], and standard deviation of a push in time [s]."""


@dataclass(frozen=True)
class Draw:
    """One case before anything is read."""

    kinds: tuple[str, ...]
    """Faults, of `SIZES`; empty where nothing is wrong."""
    places: tuple[int, ...]
    """Joint of each fault, 0 or 1."""
    sizes: tuple[float, ...]
    """Of each fault; negative ones are the inverse factor, or as much less."""
    where: float
    """Distance of a load from its link's joint, and middle of a push, over the length [-]."""
    tests: tuple[str, ...]
    references: tuple[str, ...]
    channels: str


def drawn(number: int) -> Draw:
    """Draw a case.

    Args:
        number: of the case, from 0.
    """
    rng = np.random.default_rng([SEED, number])
    kind = str(rng.choice(KINDS))
    places: tuple[int, ...] = (0, 1) if kind == "pair" else (int(rng.integers(2)),)
    kinds = tuple(map(str, rng.choice(PAIRED, 2, False))) if kind == "pair" else (kind,)
    kinds = () if kind == "nothing" else kinds
    sizes = tuple(
        float(rng.uniform(*SIZES[fault][place]) * _sign(fault, rng))
        for fault, place in zip(kinds, places, strict=False)
    )
    order = [str(name) for name in rng.permutation(sorted(DEVELOPMENT))]
    tested, more = int(rng.integers(1, 3)), int(rng.integers(2, 4))
    references = order[tested : tested + more] if rng.random() < REFERENCED else []
    channels = str(rng.choice(["full", "command"] if "delay" in kinds else ["full", *CHANNELS]))
    where = float(rng.uniform(0.4, 1.0))
    return Draw(kinds, places, sizes, where, tuple(order[:tested]), tuple(references), channels)


def _sign(kind: str, rng: np.random.Generator) -> int:
    return int(rng.choice([-1, 1])) if kind in ("torque", "encoder", "load") else 1


def drawn_cases() -> list[Case]:
    """All of them, in the order of their numbers."""
    cases = []
    for number in range(COUNT):
        draw = drawn(number)
        fault = " and ".join(
            f"{kind} {size:.3g} at the {JOINTS[place]}"
            for kind, place, size in zip(draw.kinds, draw.places, draw.sizes, strict=False)
        )
        listed = not {"drag", "push"} & set(draw.kinds)
        kind = ("nothing", "single", "several")[len(draw.kinds)] if listed else "outside"
        cases.append(
            Case(
                f"drawn-{number:02d}-{'-'.join(draw.kinds) or 'nothing'}",
                "drawn",
                "development",
                f"double pendulum A.0, {fault or 'nothing'}, {' and '.join(draw.tests)}, "
                f"{draw.channels} channels, {len(draw.references)} references",
                kind,
                partial(material, number=number),
                needs=FOLDER,
            )
        )
    return cases


def material(data: Path, number: int) -> tuple[Material, Truth]:
    """The files of one case and its truth.

    Args:
        data: folder of the real logs.
        number: of the case.
    """
    draw, folder = drawn(number), data / FOLDER
    model = read_model(folder / MODEL)
    tests = [read_recording(folder, name) for name in draw.tests]
    references = [read_recording(folder, name) for name in draw.references]
    faults = []
    for kind, place, size in zip(draw.kinds, draw.places, draw.sizes, strict=False):
        if kind == "load":
            fault, model, tests, references = _loaded(draw, place, size, model, tests, references)
        else:
            fault, change = CHANGES[kind](place, size, draw.where)
            tests = [change(log) for log in tests]
        faults.append(fault)
    left_out = CHANNELS[draw.channels]
    logs, before = (tuple(log.without(*left_out) for log in group) for group in (tests, references))
    return Material(model.mjcf(), logs, before), Truth(tuple(faults), references=bool(references))


Change = Callable[[Recording], Recording]


def _loaded(
    draw: Draw,
    place: int,
    size: float,
    model: DoublePendulum,
    tests: list[Recording],
    references: list[Recording],
) -> tuple[Fault, DoublePendulum, list[Recording], list[Recording]]:
    """A load that tests are told and do not have; or one that model and tests lack, and references
    are told.
    """
    link = LINKS[place]
    down = draw.where * model.length[place]
    payload = {link: [abs(size), 0.0, 0.0, -down]}
    if size < 0:
        tests = [log.declared(payload=payload) for log in tests]
    else:
        model = model.without_load(place, size, down)
        references = [log.declared(payload=payload) for log in references]
    at = (link, JOINTS[place])
    fault = Fault("payload", at, {"mass": size}, (("link_mass", at), ("link_com", at)))
    return fault, model, tests, references


def _torque(place: int, size: float, where: float) -> tuple[Fault, Change]:
    joint, factor = (JOINTS[place],), size if size > 0 else -1 / size
    fault = Fault("torque_constant", joint, {"scale": 1 / factor}, tuple((e, joint) for e in WEAK))
    return fault, lambda log: log.scaled(factor, *_columns(place))


def _encoder(place: int, size: float, where: float) -> tuple[Fault, Change]:
    fault = Fault("encoder_offset", (JOINTS[place],), {"offset": size})
    return fault, lambda log: log.shifted(size, f"position/{JOINTS[place]}")


def _delay(place: int, size: float, where: float) -> tuple[Fault, Change]:
    return Fault("command_delay", ("robot",), {"delay": size}), lambda log: log.early(size, COMMAND)


def _coulomb(place: int, size: float, where: float) -> tuple[Fault, Change]:
    joint = (JOINTS[place],)
    fault = Fault("coulomb_friction", joint, {"torque": size}, (("stribeck_friction", joint),))
    return fault, _needing(place, lambda log: size * np.tanh(_speed(log, place) / SLOW))


def _viscous(place: int, size: float, where: float) -> tuple[Fault, Change]:
    fault = Fault("viscous_friction", (JOINTS[place],), {"damping": size})
    return fault, _needing(place, lambda log: size * _speed(log, place))


def _spring(place: int, size: float, where: float) -> tuple[Fault, Change]:
    fault = Fault("joint_spring", (JOINTS[place],), {"stiffness": size})
    return fault, _needing(place, lambda log: size * log.signals[f"position/{JOINTS[place]}"])


def _drag(place: int, size: float, where: float) -> tuple[Fault, Change]:
    def torque(log: Recording) -> np.ndarray:
        speed = _speed(log, place)
        return np.asarray(size * speed * np.abs(speed))

    return Fault("drag", (), listed=False), _needing(place, torque)


def _push(place: int, size: float, where: float) -> tuple[Fault, Change]:
    def torque(log: Recording) -> np.ndarray:
        middle = log.time[0] + where * (log.time[-1] - log.time[0])
        return np.asarray(size * np.exp(-0.5 * ((log.time - middle) / PUSHED) ** 2))

    return Fault("push", (), listed=False), _needing(place, torque)


CHANGES: dict[str, Callable[[int, float, float], tuple[Fault, Change]]] = {
    "torque": _torque,
    "encoder": _encoder,
    "delay": _delay,
    "coulomb": _coulomb,
    "viscous": _viscous,
    "spring": _spring,
    "drag": _drag,
    "push": _push,
}
"""By kind: the truth, and what is done to a log, of joint, size and place."""


def _needing(place: int, torque: Callable[[Recording], np.ndarray]) -> Change:
    """What makes a drive give more torque."""

    def change(log: Recording) -> Recording:
        more = torque(log)
        given = {column: log.signals[column] + more for column in _columns(place)}
        return replace(log, signals={**log.signals, **given})

    return change


def _columns(place: int) -> tuple[str, str]:
    return f"{COMMAND}/{JOINTS[place]}", f"{MEASURED}/{JOINTS[place]}"


def _speed(log: Recording, place: int) -> np.ndarray:
    return log.signals[f"velocity/{JOINTS[place]}"]
