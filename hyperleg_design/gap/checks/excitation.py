"""Which effects of the catalogue a log can show, and why not the others: what moved, how fast,
under which load, what was measured.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from hyperleg_design.gap.checks.rules import RULES
from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.effects.excitation import Excitation, Motion
from hyperleg_design.gap.effects.kinds import GearEffect, before_sensors
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.sampling import quantum
from hyperleg_design.gap.model.joint_units import slides
from hyperleg_design.gap.model.postures import posture_dependent, turning
from hyperleg_design.gap.model.subject import Subject

SEGMENT = 16384
"""Most rows of which one spectrum is made."""


def excitation_of(log: Log, subject: Subject | None = None) -> tuple[Excitation, ...]:
    """Find out what a log can show of each effect; with a coupled robot, motors count for all
    joints that they move.

    Args:
        log: the log.
        subject: the robot; without it the log alone counts.

    Returns:
        One entry for each effect of the catalogue.
    """
    motion = motion_of(log, subject)
    return tuple(
        beside_sensors(effect.excited(log, motion), effect, log, motion)
        for effect in EFFECTS.values()
    )


def beside_sensors(excitation: Excitation, effect: Effect, log: Log, motion: Motion) -> Excitation:
    """Leave out the joints at which torque sensors behind the gears hide an effect.

    Args:
        excitation: what the log can show of the effect otherwise.
        effect: the effect.
        log: as it was read.
        motion: facts of it.

    Returns:
        What it can show. Gears are not judged there, and what acts before a sensor shows only
        beside what was asked for.
    """
    hidden = {name for name in log.metadata.torque_sensors if log.has("joint_torque", name)}
    why = "torque sensors behind the gears: play, belts and ratios are not judged"
    if before_sensors(effect):
        hidden -= set(motion.joints[motion.asked].tolist())
        why = "torque sensors behind the gears, and no command tells what acts before them"
    elif not isinstance(effect, GearEffect):
        return excitation
    where = tuple(name for name in excitation.where if name not in hidden)
    if len(where) == len(excitation.where):
        return excitation
    return replace(excitation, shown=bool(where), where=where, why=excitation.why if where else why)


def motion_of(log: Log, subject: Subject | None) -> Motion:
    """Collect the facts of each joint by which effects know whether a log shows them.

    Args:
        log: the log.
        subject: the robot, if it is known.

    Returns:
        The facts.
    """
    joints = list(log.joints)
    scale = np.array([1 / RULES.motion.lever if _slides(subject, j) else 1.0 for j in joints])
    position = log.stack("position", joints) * scale
    rate = 1 / log.step
    velocity = np.stack([_speed(log, joint) for joint in joints], -1) * scale
    moving = np.abs(velocity) > RULES.motion.moving
    reversals, spread, slow = np.zeros(len(joints)), np.zeros(len(joints)), np.zeros(len(joints))
    for i in range(len(joints)):
        signs = np.sign(velocity[moving[:, i], i])
        reversals[i] = np.count_nonzero(np.diff(signs))
        speeds = np.abs(velocity[moving[:, i], i])
        if len(speeds) > 10:
            spread[i] = np.percentile(speeds, 90) / max(np.percentile(speeds, 10), 1e-9)
            slow[i] = np.mean(speeds < 0.1 * speeds.max())
    names = [tuple(dict.fromkeys((joint, *_movers(subject, joint)))) for joint in joints]

    def anywhere(*kinds: str) -> np.ndarray:
        some = [any(log.has(kind, name) for kind in kinds for name in own) for own in names]
        return np.array(some, bool)

    gains = log.metadata.gains or (
        dict(zip(subject.joints, subject.gains, strict=True)) if subject is not None else {}
    )
    known = [j in gains and bool(np.isfinite(gains[j]).all()) for j in joints]
    with_gains = np.array([log.has("position_target", j) for j in joints], bool) & known
    measured = anywhere("joint_torque", "motor_torque", "motor_current")
    asked = with_gains | anywhere("motor_torque_command")
    asked_of = [[_content(a, rate, noisy=False) for a in _asked(log, own)] for own in names]
    commands = np.array([max(contents, default=0.0) for contents in asked_of])
    content = np.array([_content(q, rate) for q in position.T]) * moving.any(0)
    swing = np.nanmax(position, 0) - np.nanmin(position, 0)
    return Motion(
        joints=np.array(joints),
        reversals=reversals,
        spread=spread,
        swing=swing,
        acceleration=_acceleration(log, velocity),
        content=content,
        command=commands,
        slow=slow,
        torque=measured | asked,
        measured=measured,
        asked=asked,
        steered=with_gains,
        posture=_of_joints(subject, joints, posture_dependent),
        turning=_of_joints(subject, joints, turning),
    )


def _slides(subject: Subject | None, joint: str) -> bool:
    return subject is not None and slides(subject, "joint", joint)


def _of_joints(
    subject: Subject | None, joints: Sequence[str], fact: Callable[[Subject], np.ndarray]
) -> np.ndarray:
    """A fact of the robot's joints, in the order of the log; true where the robot is not known."""
    if subject is None:
        return np.ones(len(joints), bool)
    facts = dict(zip(subject.joints, fact(subject).tolist(), strict=True))
    return np.array([facts.get(joint, True) for joint in joints], bool)


def _acceleration(log: Log, velocity: np.ndarray) -> np.ndarray:
    """Of each joint, smoothed over 0.1 s, what is exceeded for a twentieth of the time `(n,)`."""
    width = max(1, round(0.1 / log.step))
    change = velocity[width:] - velocity[:-width]
    if not len(change):
        return np.zeros(velocity.shape[1])
    return np.asarray(np.percentile(np.abs(change), 95, axis=0) / (width * log.step))


def _movers(subject: Subject | None, joint: str) -> tuple[str, ...]:
    """Names of the motors that move a joint, and of their actuators."""
    if subject is None or joint not in subject.joints:
        return ()
    own = np.flatnonzero(subject.joint_from_motor[subject.joints.index(joint)])
    names = ((subject.motors[motor], subject.motor_aliases[motor]) for motor in own)
    return tuple(name for pair in names for name in pair)


def _asked(log: Log, names: Sequence[str]) -> list[np.ndarray]:
    """What a joint was asked for, else each of its motors."""
    for kind in ("position_target", "motor_torque_command"):
        logged = [name for name in names if log.has(kind, name)]
        if logged:
            return [log.column(f"{kind}/{name}") for name in logged]
    return []


def _speed(log: Log, joint: str) -> np.ndarray:
    """Of a joint, smoothed over 25 ms, without the noise of differences [rad/s]."""
    width = max(1, round(0.025 / log.step))
    values = log.column(f"position/{joint}")
    known = np.isfinite(values)
    filled = (
        np.interp(log.time, log.time[known], values[known])
        if known.sum() > 1
        else np.zeros(len(values))
    )
    rate = np.gradient(filled, log.time)
    if width > 1 and len(rate) > 3 * width:
        rate = np.convolve(rate, np.ones(width) / width, mode="same")
    rate[~known] = 0.0
    return np.asarray(rate)


def _content(values: np.ndarray, rate: float, *, noisy: bool = True) -> float:
    """Highest frequency above which a signal's rate still holds 2 % of its power, and more than its
    noise can [Hz].

    Noise is white in the signal itself; its size is that of the top quarter of the spectrum, or of
    the quantisation.
    """
    step = quantum(values[np.isfinite(values)])
    rates = np.diff(values)
    rates = np.nan_to_num(rates - np.nanmean(rates)) if np.isfinite(rates).any() else np.zeros(0)
    if len(rates) < 32 or not rates.any():
        return 0.0
    length = min(len(rates), SEGMENT)
    window = np.hanning(length)
    segments = rates[: len(rates) // length * length].reshape(-1, length)
    power = np.mean([np.abs(np.fft.rfft(segment * window)) ** 2 for segment in segments], axis=0)
    frequency = np.fft.rfftfreq(length, 1 / rate)
    scale = 4 * np.sin(np.pi * frequency / rate) ** 2  # of a difference
    top = slice(3 * len(power) // 4, None)
    # median of an exponential
    variance = max(
        float(np.median(power[top] / scale[top])) / np.log(2), step**2 / 12 * float(window @ window)
    )
    above = np.cumsum(power[::-1])[::-1]
    enough = np.flatnonzero(
        above >= max(0.02 * above[0], noisy * RULES.motion.noise * variance * float(scale.sum()))
    )
    return float(frequency[enough[-1]]) if len(enough) else 0.0
