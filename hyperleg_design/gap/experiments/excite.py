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
from pathlib import Path

import numpy as np

from hyperleg_design.errors import InfeasibleError, InputError, meant
from hyperleg_design.gap.experiments import information as info
from hyperleg_design.gap.experiments.designed_experiment import CLEAR, Experiment
from hyperleg_design.gap.experiments.information import Blocks
from hyperleg_design.gap.experiments.motions import Motion, recommended
from hyperleg_design.gap.experiments.pair import Pair, apart, pairs_of
from hyperleg_design.gap.experiments.plan import plan_mapping
from hyperleg_design.gap.experiments.rehearsal import knows_gains, rehearsed
from hyperleg_design.gap.experiments.rig_room import FASTEST, room_of
from hyperleg_design.gap.logs.log import Log, write_log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.writing import write_json, write_text

RATE = 200.0
"""Of the targets [Hz]."""
RATES = (50.0, 2000.0)
"""Lowest and highest sampling rate [Hz]."""
FORMATS = ("csv", "parquet", "both")


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
            f"{subject.name}: no motion fits; a default posture in which gravity loads these "
            "joints less may help, or stronger motors: "
            f"{'; '.join(f'{motion.name} {motion.why}' for motion in left_out)}"
        )
    blocks = info.blocks_of(subject)
    grams = {}
    for motion in tqdm(motions, desc="judging motions", disable=not progress):
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

    def clearness(chosen: Sequence[str]) -> np.ndarray:
        """Compute how clearly motions show each effect and tell each pair apart, up to `CLEAR`.

        Args:
            chosen: names of the motions.
        """
        gram = info.summed(grams, chosen)
        shown = [info.strength(gram, blocks, place) for place in blocks.places]
        return np.minimum(np.array([*shown, *(apart(gram, blocks, pair) for pair in pairs)]), CLEAR)

    wanted = clearness(names) >= CLEAR
    chosen: list[str] = []
    while len(chosen) < len(names):
        now = clearness(chosen) if chosen else np.zeros(len(wanted))
        if (now[wanted] >= CLEAR).all():
            break
        gains = {
            name: float((clearness([*chosen, name])[wanted] - now[wanted]).sum()) / lengths[name]
            for name in names
            if name not in chosen
        }
        chosen.append(max(gains, key=lambda name: gains[name]))
    for name in list(chosen):
        fewer = [n for n in chosen if n != name]
        if fewer and (clearness(fewer)[wanted] >= CLEAR).all():
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
            "Speed limits of some motors are unknown: joints are assumed to move by at most "
            f"{FASTEST:g} rad/s, or m/s of a slide."
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
        targets = [f"position_target/{subject.joints[i]}" for i in driven]
        rows = [["t", *targets, "drives_on"]]
        for t, target, off in zip(motion.time, motion.target[:, driven], motion.off, strict=True):
            values = ("" if off else f"{v:.6f}" for v in target)
            rows.append([f"{t:.6f}", *values, "0" if off else "1"])
        text = "\n".join(map(",".join, rows)) + "\n"
        written.append(write_text(folder / f"{motion.name}.csv", text))
    if "parquet" in kinds:
        signals = {f"position_target/{subject.joints[i]}": motion.target[:, i] for i in driven}
        notes = f"targets of {motion.name}; unknown while the drives are off"
        metadata = Metadata(robot=subject.path, base="fixed", notes=notes)
        log = Log(motion.name, motion.time, signals, metadata)
        written.append(write_log(folder / f"{motion.name}.parquet", log))
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
    joints: Sequence[str] = (),
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
        joints: that move, others being held still; all by default.
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
        fixed_subject(str(robot), overrides, joints),
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


def fixed_subject(robot: str, overrides: Sequence[str] = (), joints: Sequence[str] = ()) -> Subject:
    """Load a robot with its base held.

    Args:
        robot: a design, MJCF or URDF.
        overrides: of a design, `path=value` each.
        joints: that move, others being held still; all by default.

    Returns:
        The nominal model.

    Raises:
        InputError: it cannot be read, or has no such joint.
    """
    subject = load_subject(robot, overrides=overrides or None, base="fixed", joints=joints)
    for joint in joints:
        if joint not in subject.joints:
            remedy = (
                f"is no joint of this robot; {meant(joint, (*subject.joints, *subject.unlogged))}"
            )
            raise InputError("excite", "joints", joint, remedy)
    return subject
