"""What makes a control loop swing by itself, told by the joints in which it does: each cause makes
other modes unstable.

Late commands take the phase of all loops, and the one with the least margin goes first; a soft belt
rings with its rotor, and the joints of that motor swing in its proportions; a slow drive or a wrong
gain acts on its own joints. So the nominal loops are linearised (`stability`), each cause made as
large as makes a mode near the chatter's frequency unstable, and its shape compared with that of the
chatter: the share of the swing's squares that goes with it. Frequencies count for less: friction's
    bristles make joints that hardly
move stiffer, and nobody knows by how much. No torque is needed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.placing import ROBOT
from hyperleg_design.gap.inference.detectors.heard import UNSTABLE, Heard
from hyperleg_design.gap.inference.detectors.loose import PLAY, SPRING, WIDTH, play_and_spring
from hyperleg_design.gap.inference.detectors.unsettled import MOVED
from hyperleg_design.gap.model.machine import rotor
from hyperleg_design.gap.model.stability import Loops, Modes, inertia, modes
from hyperleg_design.gap.results.diagnosis import Named, Value
from hyperleg_design.gap.signals.swing import Swing, loudest, rms, swing

if TYPE_CHECKING:
    from hyperleg_design.gap.model.subject import Subject
    from hyperleg_design.gap.signals.signals import Signals

USUAL = 0.0015
"""By how much commands of healthy robots act late, all in all [s] (assumed: a tick of 1 kHz and a
torque loop)."""
LATE, SLOW = (4e-4, 0.02, 16), (4e-4, 0.05, 14)
"""Delays and time constants that are tried: least and largest [s], and how many."""
LOUDER, WEAKER = np.linspace(0.1, 1.2, 10), -np.linspace(0.1, 0.9, 9)
"""Gains over the declared ones, less one."""
RINGS = np.geomspace(110.0, 6.0, 18)
"""Frequencies of a rotor on its belt that are tried [Hz]."""
STARTS = (0.75, 1.0, 1.3)
"""Where modes are looked for, over the chatter's frequency."""
LOWER, HIGHER = 0.15, 0.35
"""Of the chatter's frequency below and above the mode's: spread of its logarithm (assumed, see
above)."""
ALIKE = 4.0
"""Log-likelihood per logarithm of the share of the swing that a mode explains (in development, true
causes explain 0.8 to 1)."""
FREE = 1.2
"""Log-likelihood that a belt pays for its compliance, with which it rings at any frequency: the
range of `RINGS` over `HIGHER`."""
MISSING = -25.0
"""Log-likelihood of a log in which a cause makes no mode unstable."""
GOOD = -1.5
"""Least log-likelihood of a log, on average, that explains it."""
APART = 2.0
"""Log-likelihood within which causes are one set."""
MOST = 3
"""Causes in a set, of more nothing is known."""
SPREAD = 0.6
"""Of sizes, to both sides: logarithm, for their intervals (assumed: lags, belts and friction of the
healthy robot are hardly known)."""


@dataclass(frozen=True, eq=False)
class _Variants:
    """Sizes of one cause."""

    effect: str
    location: str
    values: np.ndarray
    """Parameters of the effect, its sizes `(g, k)`."""
    loops: Loops


@dataclass(frozen=True, eq=False)
class _Match:
    """How well a cause goes with the chatter of one log, in its best size."""

    score: float
    values: np.ndarray
    share: float
    """Of the swing's squares."""
    stretch: float
    """Of its belt, on the motor's side [rad]."""
    mode: np.ndarray
    """Its shape, complex, of length 1 `(n,)`."""


def unstable(signals: Sequence[Signals]) -> Heard | None:
    """What makes joints chatter; None where none do, or it is not clear, and of robots that stand
    on their feet.
    """
    subject = signals[0].subject
    if subject.floating or not np.isfinite(subject.gains[~subject.passive]).all():
        return None
    heard = [(one, found) for one in signals if (found := swing(one)) is not None]
    matches = [_matched(*pair) for pair in heard]
    names = {name for found in matches for name in found}
    if not names:
        return None
    goes = {
        name: sum(found[name].score if name in found else MISSING for found in matches)
        for name in names
    }
    score = {name: goes[name] - FREE * (name[0] == SPRING) for name in names}
    order = sorted(score, key=lambda name: (-score[name], name))
    best = order[0]
    near = [name for name in order if score[name] > score[best] - APART]
    if goes[best] < GOOD * len(heard) or len(near) > MOST:
        return None
    shares = [found[best].share if best in found else 0.0 for found in matches]
    closed, *each = (float(1 - np.sqrt(1 - share)) for share in (float(np.mean(shares)), *shares))
    speeds = [2 * np.pi * found.frequency * found.angle for _, found in heard]
    worst = heard[max(range(len(heard)), key=lambda i: float(rms(speeds[i]).max()))][1]
    weight = {name: float(np.exp(score[name] - score[best])) for name in order}
    total = sum(weight.values())
    told = (
        c
        for name in near
        for c in _named(
            subject,
            name,
            [f[name] for f in matches if name in f],
            worst,
            weight[name] / total,
            closed,
        )
    )
    causes = sorted(told, key=lambda cause: -cause.probability)
    size = rms(np.concatenate(speeds))
    joint = subject.joints[int(np.argmax(size))]
    says = (
        f"has unstable control loops: {joint} swings to and fro by itself at {worst.frequency:.0f} "
        f"Hz, and "
        f"{100 * float(np.mean(shares)):.0f} % of how all joints swing together goes with the mode "
        f"that the model's loops then have"
    )
    spread = dict(zip(subject.joints, (size**2 / np.sum(size**2)).tolist(), strict=True))
    return Heard(
        causes[0].location,
        UNSTABLE,
        says,
        worst.frequency,
        float(np.linalg.norm(size)),
        "rad/s",
        closed,
        (min(each), max(each)),
        "joint",
        spread,
        tuple(causes),
    )


def swinging(
    signals: Signals, effect: str, location: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Where a log chatters most: time `(t,)` [s], the joints' speeds about that frequency, and what
    of them goes with the mode that a cause makes unstable `(t, n)` [rad/s]; None where the log does
    not chatter, or the cause makes none.
    """
    found = swing(signals)
    match = (
        None
        if found is None
        else _matched(signals, found).get((SPRING if effect == PLAY else effect, location))
    )
    if found is None or match is None:
        return None
    part = loudest(np.linalg.norm(found.angle, axis=1), found.frequency, signals.step)
    speed = 2j * np.pi * found.frequency * found.angle[part]
    return signals.time[part], speed.real, ((speed @ match.mode.conj())[:, None] * match.mode).real


def _matched(signals: Signals, found: Swing) -> dict[tuple[str, str], _Match]:
    """Causes that make a mode near the chatter of a log unstable."""
    subject, angle = signals.subject, found.angle
    size = np.linalg.norm(angle, axis=1)
    loud = size > size.max() / 2
    powers, shapes = np.linalg.eigh(angle[loud].T @ angle[loud].conj())
    shape, pure = shapes[:, -1], max(float(powers[-1] / powers.sum()), 0.5)
    posture = np.asarray(np.median(signals.position[loud], 0))
    mass, moved = inertia(subject, posture), np.abs(shape) > MOVED * np.abs(shape).max()
    best: dict[tuple[str, str], _Match] = {}
    for one in _variants(subject, moved):
        for start in STARTS:
            mode = modes(subject, mass, one.loops, start * found.frequency)
            share = np.minimum(
                np.abs(mode.shape.conj() @ shape) ** 2 / pure, 1.0
            )  # several modes may swing at once
            score = np.where(
                mode.found & (mode.growth > 0), _likely(mode, share, found.frequency), MISSING
            )
            k = int(np.argmax(score))
            name = one.effect, one.location
            if score[k] > MISSING and score[k] > (best[name].score if name in best else MISSING):
                stretch = float(mode.stretch[k] * np.percentile(size, 95))
                best[name] = _Match(
                    float(score[k]), one.values[k], float(share[k]), stretch, mode.shape[k]
                )
    return best


def _likely(mode: Modes, share: np.ndarray, frequency: float) -> np.ndarray:
    apart = np.log(frequency / np.maximum(mode.frequency, 1e-3))
    return np.asarray(
        ALIKE * np.log(np.maximum(share, 1e-3))
        - (apart / np.where(apart > 0, HIGHER, LOWER)) ** 2 / 2
    )


def _variants(subject: Subject, moved: np.ndarray) -> Iterator[_Variants]:
    """Causes in several sizes, of the joints that move and their motors."""
    motors = len(subject.motors)
    nominal = np.nan_to_num(subject.gains)

    def loops(many: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return np.full(many, USUAL), np.zeros((many, motors)), np.tile(nominal, (many, 1, 1))

    sizes = np.geomspace(*LATE)
    late, slow, gains = loops(len(sizes))
    yield _Variants(
        "command_delay",
        ROBOT,
        np.column_stack([sizes, np.zeros(len(sizes))]),
        Loops(late + sizes, slow, gains),
    )
    for joint in np.flatnonzero(moved & ~subject.passive).tolist():
        for ways, changes in ((((1, 0), (0, 1), (1, 1)), LOUDER), (((0, 1),), WEAKER)):
            for way in ways:
                late, slow, gains = loops(len(changes))
                scales = 1 + changes[:, None] * np.array(way)
                gains[:, joint] *= scales
                yield _Variants(
                    "controller_gain", subject.joints[joint], scales, Loops(late, slow, gains)
                )
    for motor in np.flatnonzero((np.abs(subject.joint_from_motor[moved]) > 0).any(0)).tolist():
        sizes = np.geomspace(*SLOW)
        late, slow, gains = loops(len(sizes))
        slow[:, motor] = sizes
        yield _Variants(
            "actuator_bandwidth", subject.motors[motor], sizes[:, None], Loops(late, slow, gains)
        )
        springs = rotor(subject, motor) * (2 * np.pi * RINGS) ** 2
        late, slow, gains = loops(len(springs))
        for side in (False, True):
            belt = Loops(late, slow, gains, motor, springs, side)
            yield _Variants(
                SPRING,
                subject.motors[motor],
                np.column_stack([1 / springs, np.full(len(springs), float(side))]),
                belt,
            )


def _named(
    subject: Subject,
    name: tuple[str, str],
    found: Sequence[_Match],
    worst: Swing,
    probability: float,
    closed: float,
) -> Sequence[Named]:
    """A cause with its parameters; of a belt, the spring and play as wide as it would swing."""
    effect, place = name
    values = [match.values for match in found]
    if effect == SPRING:
        motor = subject.motors.index(place)
        size = float(np.exp(np.mean([np.log(v[0]) for v in values])))
        play = (
            WIDTH
            * max(match.stretch for match in found)
            / float(np.abs(subject.joint_from_motor[:, motor]).max())
        )
        both = play_and_spring(
            subject, motor, worst, _about(play), _about(size), closed, side=values[0][1]
        )
        return [replace(one, probability=one.probability * probability) for one in both]
    mean, null = np.mean(values, 0), EFFECTS[effect].nulls
    parameters = {}
    for parameter, value, zero in zip(EFFECTS[effect].parameters, mean, null, strict=True):
        ends = [zero + (value - zero) * factor for factor in _about(1.0)[1:]]
        parameters[parameter.name] = Value(
            float(value),
            float(max(min(ends), parameter.low)),
            float(min(max(ends), parameter.high)),
            parameter.unit,
        )
    return [Named(effect, place, probability, closed, parameters)]


def _about(size: float) -> tuple[float, float, float]:
    """A size, and the ends of its interval."""
    return size, size * float(np.exp(-SPREAD)), size * float(np.exp(SPREAD))
