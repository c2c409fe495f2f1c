"""Belts that give, seen in a joint that chatters: at the chatter's frequency it takes torque that
its motor does not give.

On a rigid transmission a motor's torque is what its rotor and joints need, at any frequency: their
ratio H is 1, e^(i w T) where the true torque is late by T, and 1 / g under gains g times those
declared. A belt between them, soft or in its play, makes it small. With the joints' inertia I at
the motor and the rotor's J on a spring k, H = 1 - w^2 / w_a^2, w_a^2 = k (I + J) / (I J): the loop
rings on the belt. By how far the rotor then moves beyond its joints, s = (need - torque) / (J w^2),
the spring and the play follow. A spring's swing is a sine; a rotor that knocks about in its play
has harmonics, and the play is at least as wide as it moves. What is missed must be more than
friction: the bristles of a joint that hardly moves are a spring, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.detectors.heard import RINGING, Heard
from hyperleg_design.gap.model import rigid
from hyperleg_design.gap.model.machine import rotor
from hyperleg_design.gap.results.diagnosis import Named, Value
from hyperleg_design.gap.signals.channels import applied
from hyperleg_design.gap.signals.smoothing import filled
from hyperleg_design.gap.signals.swing import Swing, band, loudest, rms, sharp, swing

if TYPE_CHECKING:
    from hyperleg_design.gap.model.subject import Subject
    from hyperleg_design.gap.signals.signals import Signals

LARGEST_RATIO = 0.75
"""|H| up to which a belt is to blame; gains as wrong as they get, and rotors as light, leave
more."""
COHERENT = 0.95
"""Least coherence of need and torque; that of noise is small."""
WORST = 0.5
"""Torque that is missed, over that of the worst log, from which a log counts."""
CLEARLY = 2.0
"""Torque that the motor misses, over that of any other, each over its limit."""
LIKELIER = 0.7
"""Probability of the likelier of the two (in development it was that in about eight cases of
ten)."""
UNCERTAIN = 0.2
"""Of the rotor's inertia and the frequency together, for the interval of a spring (assumed)."""
WIDTH = 1.5
"""Play over how far the rotor swings to one side: to and fro, it passes both its ends by a third
(measured on simulated belts)."""
BLOCK = 100
"""Ticks that are held out together where there is one log."""
PLAY, SPRING = BELTS = "backlash", "transmission_elasticity"
"""Effects of belts that give."""


@dataclass(frozen=True, eq=False)
class _Line:
    """Chatter of one log, as amplitudes in time, `m` motors."""

    frequency: float
    need: np.ndarray
    """Torque that joints and rotors need `(t, m)` [Nm], complex."""
    joints: np.ndarray
    """The joints alone `(t, m)` [Nm]."""
    torque: np.ndarray
    """That is believed of the motors `(t, m)` [Nm]."""
    swing: Swing


def loose(signals: Sequence[Signals]) -> Heard | None:
    """The belt that makes joints chatter; None where none does, or it is not clear which, and of
    robots that stand on their feet.
    """
    subject = signals[0].subject
    if subject.floating:  # what a foot on the ground feels at such frequencies nobody knows
        return None
    lines = _worst([line for line in map(_line, signals) if line is not None], subject)
    if not lines:
        return None
    need, torque = (
        np.concatenate([getattr(line, name) for line in lines]) for name in ("need", "torque")
    )
    both, own, given = (
        np.einsum("tm,tm->m", a.conj(), b)
        for a, b in ((need, torque), (need, need), (torque, torque))
    )
    size = np.maximum(own.real, 1e-300)
    ratio = np.abs(both) / size
    coherence = np.abs(both) / np.sqrt(size * np.maximum(given.real, 1e-300))
    missed = rms(need - torque)
    share = coherence * missed / _limit(subject, torque)
    first, second = (*np.argsort(-share, kind="stable").tolist(), -1)[:2]
    beaten = second >= 0 and share[first] < CLEARLY * share[second]
    held = float(np.abs(subject.motor_from_joint[first]) @ subject.coulomb)
    if (
        ratio[first] > LARGEST_RATIO
        or coherence[first] < COHERENT
        or beaten
        or missed[first] <= held
    ):
        return None
    most = max(lines, key=lambda one: float(rms((one.need - one.torque)[:, first])))
    closed, interval = _closed(lines, first)
    shares = dict(zip(subject.motors, (share**2 / np.sum(share**2)).tolist(), strict=True))
    lacking = float(missed[first])
    says = (
        f"rings at {most.frequency:.0f} Hz on its belt: its joints take {lacking:.2g} Nm (rms) "
        f"there that it does not give; "
        "the belt is soft or has play"
    )
    causes = _causes(subject, first, most, closed)
    return Heard(
        subject.motors[first],
        RINGING,
        says,
        most.frequency,
        lacking,
        "Nm",
        closed,
        interval,
        "motor",
        shares,
        causes,
    )


def ringing(signals: Signals, motor: str) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Where a log chatters most: time [s], torque that a motor's joints and rotor need, and its own
    `(t,)` [Nm], about that frequency.

    None where the log does not chatter.
    """
    line = _line(signals)
    if line is None:
        return None
    column = signals.subject.motors.index(motor)
    need, torque = line.need[:, column], line.torque[:, column]
    part = loudest(np.abs(need), line.frequency, signals.step)
    return signals.time[part], need[part].real, torque[part].real


def _worst(lines: Sequence[_Line], subject: Subject) -> list[_Line]:
    """Those logs in which about as much torque is missed as in the worst."""
    missed = [
        float((rms(line.need - line.torque) / _limit(subject, line.torque)).max()) for line in lines
    ]
    return [line for line, one in zip(lines, missed, strict=True) if one >= WORST * max(missed)]


def _line(signals: Signals) -> _Line | None:
    found = swing(signals)
    if found is None:
        return None
    subject, step = signals.subject, signals.step
    acceleration = -((2 * np.pi * found.frequency) ** 2) * found.angle
    parts = rigid.accelerating(subject, signals.position, (acceleration.real, acceleration.imag))
    need = applied(subject.motor_from_joint, parts[0]) + 1j * applied(
        subject.motor_from_joint, parts[1]
    )
    inertias = np.array([rotor(subject, m) for m in range(len(subject.motors))])
    return _Line(
        found.frequency,
        need,
        need - inertias * (acceleration @ subject.joint_from_motor),
        band(filled(signals.believed), step, found.seen),
        found,
    )


def _limit(subject: Subject, torque: np.ndarray) -> np.ndarray:
    """What torques of the motors are measured by `(m,)` [Nm]: their limits, else the largest that
    was seen.
    """
    largest = np.maximum(np.abs(torque).max(0), 1e-9)
    return np.where(
        np.isfinite(subject.torque_limit), subject.torque_limit, np.maximum(largest, largest.max())
    )


def _closed(lines: Sequence[_Line], motor: int) -> tuple[float, tuple[float, float]]:
    """Share of the missed torque that the ratio of torque to need explains in data that it was not
    taken from; all, and least and most.
    """
    parts = [(line.need[:, motor], line.torque[:, motor]) for line in lines]
    if len(parts) == 1:
        odd = np.arange(len(parts[0][0])) // BLOCK % 2 == 1
        parts = [(parts[0][0][cut], parts[0][1][cut]) for cut in (odd, ~odd)]
    both, own = (
        np.array([np.vdot(need, x) for need, x in pairs])
        for pairs in (parts, [(need, need) for need, _ in parts])
    )
    ratios = (both.sum() - both) / (own.sum() - own)
    left = np.array(
        [float(np.sum(np.abs(t - r * n) ** 2)) for (n, t), r in zip(parts, ratios, strict=True)]
    )
    before = np.array([float(np.sum(np.abs(t - n) ** 2)) for n, t in parts])
    each = 1 - np.sqrt(left / before)
    return float(1 - np.sqrt(left.sum() / before.sum())), (float(each.min()), float(each.max()))


def _causes(subject: Subject, motor: int, line: _Line, closed: float) -> tuple[Named, Named]:
    """Play and spring, the likelier first, with what the swing of a log says of their sizes."""
    radians = 2 * np.pi * line.frequency
    swings = (line.need - line.torque)[:, motor] / (rotor(subject, motor) * radians**2)
    apart, through, given, need = (
        rms(x) for x in (swings, *(x[:, motor] for x in (line.joints, line.torque, line.need)))
    )
    # the phase of a believed torque is uncertain, so that all of it may be missed beside the need,
    # or none
    missed = apart * rotor(subject, motor) * radians**2
    compliance = apart / through
    spring = (
        compliance,
        compliance * abs(need - given) / missed / (1 + UNCERTAIN),
        compliance * (need + given) / missed * (1 + UNCERTAIN),
    )
    seen = float(np.percentile(np.abs(swings), 95)) / float(
        np.abs(subject.joint_from_motor[:, motor]).max()
    )
    play = WIDTH * seen, seen, 2 * seen * (1 + UNCERTAIN)
    return play_and_spring(subject, motor, line.swing, play, spring, closed)


def play_and_spring(
    subject: Subject,
    motor: int,
    found: Swing,
    play: Sequence[float],
    spring: Sequence[float],
    closed: float,
    side: float = 0.0,
) -> tuple[Named, Named]:
    """Play and spring of a belt on which joints swing, the likelier first; their probabilities are
    1 together.

    Args:
        subject: the robot.
        motor: whose belt gives.
        found: chatter that tells play from a spring.
        play: angle: value, low and high.
        spring: compliance: the same.
        closed: share of what is heard that is explained.
        side: of the encoders, see `valued`.
    """
    place, likely = (
        subject.motors[motor],
        LIKELIER if sharp(found, subject, motor) else 1 - LIKELIER,
    )
    named = [
        Named(effect, place, share, closed, valued(effect, subject, place, size, side))
        for effect, share, size in ((PLAY, likely, play), (SPRING, 1 - likely, spring))
    ]
    first, second = sorted(named, key=lambda one: -one.probability)
    return first, second


def sided(effect: str, subject: Subject, place: str, side: float) -> np.ndarray:
    """An effect's example, with the encoders on a given side `(parameters,)`."""
    one = EFFECTS[effect]
    return np.array(
        [
            side if p.name == "side" else v
            for p, v in zip(one.parameters, one.example(place, subject), strict=True)
        ]
    )


def valued(
    effect: str, subject: Subject, place: str, size: Sequence[float], side: float = 0.0
) -> dict[str, Value]:
    """Parameters of play or a spring, and what people call them: value, low and high of the first,
    the others as its example has them.

    Args:
        effect: `PLAY` or `SPRING`.
        subject: the robot.
        place: motor.
        size: first parameter: value, low and high.
        side: on which the encoders sit: 0, at the joints, or 1, on the rotors.
    """
    one = EFFECTS[effect]
    low, high = one.bounds(place, subject)
    value, least, most = np.clip(size, low[0], high[0])
    example = sided(effect, subject, place, side)
    found = {
        p.name: Value(float(v), float(v), float(v), p.unit)
        for p, v in zip(one.parameters, example, strict=True)
    }
    found[one.parameters[0].name] = Value(
        float(value), float(least), float(most), one.parameters[0].unit
    )
    ends = [one.derived(place, np.r_[end, example[1:]], subject) for end in (value, least, most)]
    for name, (told, unit) in ends[0].items():
        others = [end[name][0] for end in ends[1:]]
        found[name] = Value(told, min(others), max(others), unit)
    return found
