"""Recommended experiments for a rig: motions inside the robot's limits, which effects each can tell
apart, and the shortest set.

DIR/plan.json       the plan and what it tells, in numbers; report/gap/excite.py says the same for people
DIR/NAME.csv        targets of one motion: t, position_target/JOINT, drives_on; NAME.parquet is the same as a log

What a motion tells is judged on its rehearsal, the nominal model's own log of it; `information`
says how.
"""  # noqa: E501

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InfeasibleError, InputError
from hyperleg_design.gap.effects import LOOK_ALIKES
from hyperleg_design.gap.experiments import information as info
from hyperleg_design.gap.experiments.motions import LeftOut, Motion, recommended
from hyperleg_design.gap.experiments.rehearsal import knows_gains, rehearsed
from hyperleg_design.gap.experiments.rig_room import Room, room_of
from hyperleg_design.gap.logs.log import Log, write_log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.writing import write_json, write_text

if TYPE_CHECKING:
    from hyperleg_design.gap.experiments.information import Blocks, Place
    from hyperleg_design.gap.model.subject import Subject

CLEAR = 3.0
"""Standard deviations from which an effect of usual size shows, and from which two are told
apart."""
RATE = 200.0
"""Of the targets [Hz]."""
RATES = (50.0, 2000.0)
"""Allowed [Hz]."""
FORMATS = ("csv", "parquet", "both")


@dataclass(frozen=True)
class Pair:
    """Two look-alikes at one joint."""

    joint: str
    first: tuple[str, str]
    second: tuple[str, str]
    by: str
    """What separates them."""


@dataclass(frozen=True, eq=False)
class Experiment:
    """Recommended motions of one robot and what they tell."""

    subject: Subject
    room: Room
    rate: float
    noise: float
    torque: bool
    """Whether the rig is taken to measure motor torque or current."""
    motions: tuple[Motion, ...]
    left_out: tuple[LeftOut, ...]
    blocks: Blocks
    grams: Mapping[str, np.ndarray]
    """Fisher information by motion `(c, c)`."""
    pairs: tuple[Pair, ...]
    chosen: tuple[str, ...]
    """Shortest set of motions that tells what all of them can, in the order in which they add
    most."""
    notes: tuple[str, ...]

    def motion(self, name: str) -> Motion:
        """Look up a motion.

        Args:
            name: of the motion.

        Returns:
            The motion.
        """
        return next(m for m in self.motions if m.name == name)

    def gram(self, names: Sequence[str] | None = None) -> np.ndarray:
        """Sum the information of some motions.

        Args:
            names: of the motions; all by default.

        Returns:
            Fisher information, `(c, c)`.
        """
        return info.summed(
            self.grams, names if names is not None else [m.name for m in self.motions]
        )

    def apart(self, pair: Pair, names: Sequence[str] | None = None) -> float:
        """Compute how far two look-alikes are told apart by some motions.

        Args:
            pair: of look-alikes.
            names: of the motions; all by default.

        Returns:
            The distance of the less clear of the two [standard deviations].
        """
        return apart(self.gram(names), self.blocks, pair)

    def shown(self, place: Place, names: Sequence[str] | None = None) -> float:
        """Compute how far an effect of usual size stands out.

        Args:
            place: effect and location.
            names: of the motions; all by default.

        Returns:
            The distance [standard deviations].
        """
        return info.strength(self.gram(names), self.blocks, place)


def apart(gram: np.ndarray, blocks: Blocks, pair: Pair) -> float:
    """Compute what is left of each of two effects after the other explained what it can.

    Args:
        gram: Fisher information, `(c, c)`.
        blocks: of the robot.
        pair: of look-alikes.

    Returns:
        The lesser of the two [standard deviations].
    """
    return min(
        info.distinction(gram, blocks, pair.first, [pair.second]),
        info.distinction(gram, blocks, pair.second, [pair.first]),
    )


def design_experiment(
    subject: Subject,
    *,
    rate: float = RATE,
    noise: float = info.NOISE,
    torque: bool = True,
    seed: int = 0,
    progress: bool = False,
) -> Experiment:
    """Plan motions for a robot on a rig and judge them.

    Args:
        subject: with its base fixed.
        rate: of the targets [Hz].
        noise: standard deviation of the residuals over the strength of joints and motors [-].
        torque: whether motor torque or current is measured.
        seed: of the Fourier series' phases.
        progress: show a bar.

    Returns:
        The motions, their information, and the shortest set.

    Raises:
        InputError: a floating base, a rate or noise out of range.
        InfeasibleError: no motion fits.
    """
    from tqdm import tqdm

    if subject.floating:
        raise InputError(
            subject.name, "base", subject.base, "expects a rig that holds the base: --base fixed"
        )
    if not RATES[0] <= rate <= RATES[1]:
        raise InputError("excite", "rate", rate, f"expects {RATES[0]:g} to {RATES[1]:g} Hz")
    if not 0 < noise < 1:
        raise InputError(
            "excite", "noise", noise, "expects a share of the joints' strength between 0 and 1"
        )
    room = room_of(subject)
    motions, left_out = recommended(subject, room, rate, np.random.default_rng(seed))
    if not motions:
        raise InfeasibleError(
            f"{subject.name}: no motion fits: "
            f"{'; '.join(f'{one.name}: {one.why}' for one in left_out)}"
        )
    blocks = info.blocks_of(subject)
    grams = {}
    for motion in tqdm(motions, desc="information", disable=not progress):
        log = rehearsed(
            subject, motion.name, motion.time, motion.target, motion.position, torque=torque
        )
        grams[motion.name] = info.information(condition(log, subject), blocks, noise=noise)
    pairs = pairs_of(subject, blocks)
    lengths = {m.name: m.duration for m in motions}
    chosen = shortest_set(grams, lengths, blocks, pairs)
    return Experiment(
        subject,
        room,
        rate,
        noise,
        torque,
        tuple(motions),
        tuple(left_out),
        blocks,
        grams,
        pairs,
        chosen,
        _notes(subject, torque),
    )


def pairs_of(subject: Subject, blocks: Blocks) -> tuple[Pair, ...]:
    """List the look-alikes joint by joint.

    Args:
        subject: the robot.
        blocks: of the robot.

    Returns:
        The pairs that can sit on this robot.
    """
    found: list[Pair] = []
    for first, second, by in LOOK_ALIKES:
        for index, joint in enumerate(subject.joints):
            places = [place_at(name, index, subject, blocks) for name in (first, second)]
            if (
                places[0] is not None
                and places[1] is not None
                and not any((p.first, p.second) == (places[0], places[1]) for p in found)
            ):
                found.append(Pair(joint, places[0], places[1], by))
    return tuple(found)


def place_at(effect: str, joint: int, subject: Subject, blocks: Blocks) -> Place | None:
    """Find where an effect sits that acts on a joint most: the joint, its main motor, the link that
    it carries, or the robot.

    Args:
        effect: its identifier.
        joint: index of the joint.
        subject: the robot.
        blocks: of the robot.

    Returns:
        Effect and location; None where the effect cannot sit there.
    """
    known = [location for name, location in blocks.places if name == effect]
    motor = subject.motors[int(np.argmax(np.abs(subject.joint_from_motor[joint])))]
    links = [
        name
        for name, carrier in zip(subject.tree.links, subject.tree.link_joint, strict=True)
        if carrier == joint
    ]
    for name in (subject.joints[joint], motor, *links):
        if name in known:
            return effect, name
    shared = [name for name in known if name in ("robot", "battery")]
    return (effect, shared[0]) if shared else None


def shortest_set(
    grams: Mapping[str, np.ndarray],
    lengths: Mapping[str, float],
    blocks: Blocks,
    pairs: Sequence[Pair],
) -> tuple[str, ...]:
    """Choose motions that together show what all motions can show.

    They are added one by one, by what each adds per second; then those that are not needed are
    taken out.

    Args:
        grams: information by motion.
        lengths: of the motions [s].
        blocks: of the robot.
        pairs: look-alikes.

    Returns:
        Names of the motions.
    """
    names = list(grams)

    def told(chosen: Sequence[str]) -> np.ndarray:
        """How clear each effect and each pair is, up to `CLEAR`."""
        gram = info.summed(grams, chosen)
        shown = [info.strength(gram, blocks, place) for place in blocks.places]
        return np.minimum(np.array([*shown, *(apart(gram, blocks, pair) for pair in pairs)]), CLEAR)

    wanted = told(names) >= CLEAR
    chosen: list[str] = []
    while True:
        now = told(chosen) if chosen else np.zeros(len(wanted))
        if (now[wanted] >= CLEAR).all():
            break
        gains = {
            name: float((told([*chosen, name])[wanted] - now[wanted]).sum()) / lengths[name]
            for name in names
            if name not in chosen
        }
        chosen.append(max(gains, key=lambda name: gains[name]))
    for name in list(chosen):
        fewer = [n for n in chosen if n != name]
        if fewer and (told(fewer)[wanted] >= CLEAR).all():
            chosen = fewer
    return tuple(chosen)


def _notes(subject: Subject, torque: bool) -> tuple[str, ...]:
    notes = [
        "Self-collision is not checked: watch the first run at reduced gains, or with the "
        "neighbouring links out of the way."
    ]
    limits = np.isfinite(subject.torque_limit)
    if not limits.all():
        notes.append(
            "Torque limits of some motors are unknown: bounded by what gravity and a lively "
            "acceleration need."
        )
    if not np.isfinite(subject.no_load_speed).all():
        notes.append(
            "Speed limits of some motors are unknown: bounded by the assumed ones of "
            "gap/experiments/rig_room.py."
        )
    if knows_gains(subject):
        notes.append(
            "Targets lead the motion by torque over stiffness, so that the nominal controller "
            "follows it."
        )
    else:
        notes.append(
            "Gains are unknown: the robot is taken to follow its targets exactly, and effects of "
            "the controller are not judged."
        )
    if subject.passive.any():
        held = ", ".join(j for j, p in zip(subject.joints, subject.passive, strict=True) if p)
        notes.append(f"Joints without a drive are planned as if held still; hold them: {held}.")
    if torque:
        notes.append(
            "Log motor torque or current beside positions and targets: it separates drives from "
            "mechanics."
        )
    notes.append(
        "thermal_derating needs motors that warm by 10 K (a loaded hold, logged with temperature) "
        "and voltage_sag two states of the battery."
    )
    return tuple(notes)


def inseparable(experiment: Experiment) -> tuple[Pair, ...]:
    """List the look-alikes that both show, or would, and that all motions together cannot tell
    apart.

    Args:
        experiment: the plan.

    Returns:
        The pairs.
    """
    gram = experiment.gram()
    return tuple(
        pair
        for pair in experiment.pairs
        if apart(gram, experiment.blocks, pair) < CLEAR
        and all(
            info.strength(gram, experiment.blocks, place) >= CLEAR
            for place in (pair.first, pair.second)
        )
    )


def hidden(experiment: Experiment) -> tuple[Place, ...]:
    """List the effects at places where, at their usual size, no motion shows them.

    Args:
        experiment: the plan.

    Returns:
        Effects and locations.
    """
    gram = experiment.gram()
    return tuple(
        place
        for place in experiment.blocks.places
        if info.strength(gram, experiment.blocks, place) < CLEAR
    )


def plan_mapping(experiment: Experiment) -> dict[str, Any]:
    """Write the plan as JSON holds it.

    Args:
        experiment: the plan.

    Returns:
        Nested mappings.
    """
    subject, blocks = experiment.subject, experiment.blocks
    chosen = experiment.gram(experiment.chosen)
    grams = {m.name: experiment.grams[m.name] for m in experiment.motions}

    def effects_of(gram: np.ndarray) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for place in blocks.places:
            deviations = {
                k: _number(v)
                for k, v in info.standard_deviations(gram, blocks, place, subject).items()
            }
            clear = info.strength(gram, blocks, place)
            found.setdefault(place[0], {})[place[1]] = {
                "stands_out": _number(clear),
                "standard_deviation": deviations,
            }
        return found

    return {
        "schema": 1,
        "robot": subject.path,
        "base": "fixed",
        "rate": experiment.rate,
        "noise": {
            "share_of_strength": experiment.noise,
            "correlation_time": info.NOISE_TIME,
            "torque_measured": experiment.torque,
        },
        "clear_from": CLEAR,
        "start_posture": dict(
            zip(subject.joints, (float(v) for v in experiment.room.centre), strict=True)
        ),
        "motions": [
            {
                "name": m.name,
                "purpose": m.purpose,
                "duration": m.duration,
                "scale": m.scale,
                "drives_off": float(m.off.sum() / experiment.rate),
                "use": {
                    "range": m.use.range,
                    "speed": m.use.speed,
                    "envelope": m.use.envelope,
                    "continuous": m.use.continuous,
                    "worst": m.use.worst,
                },
                "shows": sorted(
                    {
                        place[0]
                        for place in blocks.places
                        if info.strength(grams[m.name], blocks, place) >= CLEAR
                    }
                ),
                "tells_apart": _pairs_told(grams[m.name], experiment),
                "effects": effects_of(grams[m.name]),
            }
            for m in experiment.motions
        ],
        "left_out": [{"name": one.name, "why": one.why} for one in experiment.left_out],
        "shortest_set": {
            "motions": list(experiment.chosen),
            "duration": float(sum(experiment.motion(n).duration for n in experiment.chosen)),
            "effects": effects_of(chosen),
            "tells_apart": _pairs_told(chosen, experiment),
        },
        "inseparable": [
            _pair(pair, experiment.gram(), experiment) for pair in inseparable(experiment)
        ],
        "not_shown": [
            {"effect": effect, "location": location} for effect, location in hidden(experiment)
        ],
        "notes": list(experiment.notes),
    }


def _pairs_told(gram: np.ndarray, experiment: Experiment) -> list[dict[str, Any]]:
    return [_pair(pair, gram, experiment) for pair in experiment.pairs]


def _pair(pair: Pair, gram: np.ndarray, experiment: Experiment) -> dict[str, Any]:
    blocks = experiment.blocks
    return {
        "joint": pair.joint,
        "first": list(pair.first),
        "second": list(pair.second),
        "separated_by": pair.by,
        "apart": _number(apart(gram, blocks, pair)),
        "principal_angle": _number(
            float(np.degrees(info.principal_angle(gram, blocks, pair.first, pair.second)))
        ),
    }


def _number(value: float) -> float | None:
    return float(f"{value:.4g}") if np.isfinite(value) else None


def write_motion(
    folder: Path, experiment: Experiment, motion: Motion, kinds: Sequence[str]
) -> list[Path]:
    """Write the targets of one motion.

    Args:
        folder: to write to.
        experiment: the plan.
        motion: the motion.
        kinds: `csv`, `parquet` (a log), or both.

    Returns:
        The files.
    """
    subject = experiment.subject
    driven = [i for i in range(len(subject.joints)) if not subject.passive[i]]
    written = []
    if "csv" in kinds:
        header = ",".join(
            ["t", *(f"position_target/{subject.joints[i]}" for i in driven), "drives_on"]
        )
        rows = [header]
        for time, target, off in zip(
            motion.time, motion.target[:, driven], motion.off, strict=True
        ):
            rows.append(
                ",".join(
                    [
                        f"{time:.6f}",
                        *("" if off else f"{v:.6f}" for v in target),
                        "0" if off else "1",
                    ]
                )
            )
        written.append(write_text(folder / f"{motion.name}.csv", "\n".join(rows) + "\n"))
    if "parquet" in kinds:
        signals = {f"position_target/{subject.joints[i]}": motion.target[:, i] for i in driven}
        metadata = Metadata(
            robot=subject.path,
            base="fixed",
            notes=f"targets of {motion.name}; unknown while the drives are off",
        )
        written.append(
            write_log(
                folder / f"{motion.name}.parquet", Log(motion.name, motion.time, signals, metadata)
            )
        )
    return written


def excite(
    robot: str | os.PathLike[str],
    out: Path,
    *,
    base: str = "fixed",
    rate: float = RATE,
    noise: float = info.NOISE,
    torque: bool = True,
    kinds: str = "csv",
    seed: int = 0,
    overrides: Sequence[str] = (),
    progress: bool = False,
) -> Experiment:
    """Design the experiments for a rig and write targets and plan into a folder; texts and figures
    are the report's.

    Args:
        robot: a design, MJCF or URDF.
        out: folder, which exists.
        base: must be `fixed`.
        rate: of the targets [Hz].
        noise: of the residuals over the strength of joints and motors [-].
        torque: whether motor torque or current is measured.
        kinds: one of `FORMATS`.
        seed: of the Fourier series' phases.
        overrides: of a design.
        progress: show a bar.

    Returns:
        The plan.

    Raises:
        InputError: a robot that cannot be read, a floating base, a number out of range.
        InfeasibleError: no motion fits.
    """
    if kinds not in FORMATS:
        raise InputError("excite", "format", kinds, f"expects one of {', '.join(FORMATS)}")
    if base != "fixed":
        raise InputError(
            "excite", "base", base, "expects fixed: these motions need a rig that holds the robot"
        )
    experiment = design_experiment(
        fixed_subject(str(robot), overrides),
        rate=rate,
        noise=noise,
        torque=torque,
        seed=seed,
        progress=progress,
    )
    for motion in experiment.motions:
        write_motion(out, experiment, motion, ("csv", "parquet") if kinds == "both" else (kinds,))
    write_json(out / "plan.json", plan_mapping(experiment))
    return experiment


def fixed_subject(robot: str, overrides: Sequence[str] = ()) -> Subject:
    """Load a robot with its base held.

    Args:
        robot: a design, MJCF or URDF.
        overrides: of a design, `path=value` each.

    Returns:
        The nominal model.

    Raises:
        InputError: it cannot be read.
    """
    free = load_subject(robot, overrides=overrides or None)
    if not free.floating:
        return free
    blank = np.zeros(2)
    signals = {f"position/{name}": blank for name in free.joints}
    return load_subject(
        robot,
        [Log("rig", np.array([0.0, 1.0]), signals, Metadata(base="fixed"))],
        overrides=overrides or None,
    )
