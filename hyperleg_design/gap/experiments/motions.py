"""The recommended motions for a rig, each scaled until it stays inside the robot's room and its
motors.

    chirp      frequency from slow to fast, all joints          delay, bandwidth, elasticity, rotor inertia
    sweeps     sines of several amplitudes and frequencies      gains against saturation, viscous friction
    ramps      slow triangles at two speeds                     friction over speed and place, cogging
    holds      postures come to from both sides                 gravity: masses, centres of mass, offsets; stiction
    reversals  small quick strokes, lightly and heavily loaded  backlash against Coulomb friction
    postures   slow Fourier series                              inertial parameters
    swing      drives off, let go from beside the rest          friction of the joints without any drive

The Fourier series is the best of several by the determinant of its inertial regressor.
"""  # noqa: E501

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from itertools import compress

import numpy as np

from hyperleg_design.gap.effects.strength import joint_strength
from hyperleg_design.gap.experiments import trajectories
from hyperleg_design.gap.experiments.rehearsal import closed_loop, knows_gains, swung
from hyperleg_design.gap.experiments.rig_room import LONG, Room, Use, targets_for, use_of
from hyperleg_design.gap.model import inertial_regressor, rigid
from hyperleg_design.gap.model.subject import Subject

SLOWEST, FASTEST = 0.1, 20.0
"""Of the chirp [Hz]."""
PART_OF_RATE = 0.1
"""Fastest frequency over the rate of the ticks: a sine keeps ten of them."""
CHIRP, FOURIER, SWING = 25.0, 25.0, 4.0
"""Lengths [s]."""
SWEEPS = ((0.4, 1.2, 3.0), (0.3, 0.6, 1.0))
"""Frequencies [Hz], and amplitudes over the largest allowed."""
RAMPS = (0.08, 0.3)
"""Speeds of the slow ramps [rad/s]."""
POSTURES = 6
STROKES = (0.02, 0.08)
"""Sizes of quick strokes [rad]."""
FOURIER_BASE, HARMONICS, DRAWS = 0.08, 10, 12
"""Slowest frequency [Hz] and number of harmonics of the postures, and how many sets of phases are
tried."""
SCALES = 0.85 ** np.arange(16)
"""Sizes tried until a motion fits."""
SWING_FROM = (0.5, 0.3, 0.15)
"""Excursions tried for the swing, over the reach of the joints."""
SETTLING = 0.3
"""Damping over strength with which the robot is let down to find where it hangs [s/rad]."""
RANGE_SLACK = 1.15
"""Range that the rehearsed motion may use over the free range [-]: some of what is kept free at the
ends."""


@dataclass(frozen=True, eq=False)
class Motion:
    """One planned motion of `t` ticks."""

    name: str
    purpose: str
    time: np.ndarray
    """Times of the targets `(t,)` [s]."""
    target: np.ndarray
    """Position targets `(t, n)` [rad]; NaN while the drives are off."""
    position: np.ndarray
    """Planned motion `(t, n)` [rad]: the targets; while the drives are off, what the nominal model
    does."""
    scale: float
    """Of its full size."""
    use: Use
    """Of room and motors by the planned motion."""

    @property
    def duration(self) -> float:
        """The duration of the motion [s]."""
        return float(self.time[-1] - self.time[0])

    @property
    def off(self) -> np.ndarray:
        """Ticks at which the drives are off `(t,)`."""
        return np.asarray(np.isnan(self.target).all(1))


@dataclass(frozen=True)
class LeftOut:
    """A motion that this robot cannot make."""

    name: str
    why: str


def recommended(
    subject: Subject, room: Room, rate: float, rng: np.random.Generator
) -> tuple[list[Motion], list[LeftOut]]:
    """Plan all motions of this module that fit.

    Args:
        subject: with its base fixed.
        room: of its joints.
        rate: of the targets [Hz].
        rng: of the Fourier series' phases.

    Returns:
        The motions, and those that were left out.
    """
    fastest = min(FASTEST, PART_OF_RATE * rate)

    def ticks(length: float) -> np.ndarray:
        return np.asarray(np.arange(round(length * rate) + 1) / rate)

    heavy, light = loaded_postures(subject, room)
    phases = best_phases(subject, room, ticks(FOURIER)[:: max(round(rate / 25), 1)], rng)
    shapes: dict[str, tuple[str, Callable[[], np.ndarray]]] = {
        "chirp": (
            "delay, bandwidth, elasticity and rotor inertia",
            lambda: trajectories.chirp(ticks(CHIRP), room, SLOWEST, fastest),
        ),
        "sweeps": (
            "gains against saturation, viscous friction",
            lambda: trajectories.sweeps(
                rate, room, [f for f in SWEEPS[0] if f <= fastest], SWEEPS[1]
            ),
        ),
        "ramps": (
            "friction over speed and place, cogging",
            lambda: trajectories.ramps(rate, room, RAMPS),
        ),
        "holds": (
            "gravity: masses, centres of mass, encoder offsets; stiction",
            lambda: trajectories.holds(rate, room, POSTURES),
        ),
        "reversals": (
            "backlash against Coulomb friction, with and without preload",
            lambda: trajectories.reversals(rate, room, [heavy, light], STROKES),
        ),
        "postures": (
            "inertial parameters",
            lambda: trajectories.fourier(ticks(FOURIER), room, FOURIER_BASE, HARMONICS, phases),
        ),
    }
    motions: list[Motion] = []
    left_out: list[LeftOut] = []
    for name, (purpose, shape) in shapes.items():
        motion = fitted(subject, room, name, purpose, shape(), 1 / rate)
        if isinstance(motion, Motion):
            motions.append(motion)
        else:
            left_out.append(motion)
    swing = swinging(subject, room, rate)
    (motions if isinstance(swing, Motion) else left_out).append(swing)  # type: ignore[arg-type]
    return motions, left_out


def fitted(
    subject: Subject, room: Room, name: str, purpose: str, full: np.ndarray, step: float
) -> Motion | LeftOut:
    """Make a motion smaller about the centre of the room until it, its targets and its rehearsal
    fit.

    Args:
        subject: the robot.
        room: of its joints.
        name: of the motion.
        purpose: of the motion.
        full: planned positions at full size `(t, n)` [rad].
        step: between ticks [s].

    Returns:
        The motion; or why it was left out.
    """
    time = np.arange(len(full)) * step
    why = ""
    for scale in SCALES:
        position = room.centre + scale * (full - room.centre)
        use = use_of(subject, room, position, step)
        why = (
            f"{use.worst} is past its limit (torque {use.envelope:.2f} of the envelope, "
            f"{use.continuous:.2f} of the continuous)"
        )
        if not use.fits(time[-1] > LONG):
            continue
        target = targets_for(subject, position, step)
        past = np.maximum(target - subject.position_high, subject.position_low - target).max(0)
        if past.max() > 0:
            why = (
                f"the targets of {subject.joints[int(np.argmax(past))]} leave its range: its "
                f"controller is soft"
            )
            continue
        if knows_gains(subject):
            rehearsed, _, torque = closed_loop(subject, step, target, position[0])
            real = use_of(subject, room, rehearsed, step, torque)
            if not np.isfinite(rehearsed).all() or real.range > RANGE_SLACK or real.envelope > 1:
                why = f"{real.worst} comes too near a limit in the rehearsal"
                continue
        return Motion(name, purpose, time, target, position, float(scale), use)
    return LeftOut(name, f"does not fit at any size: {why}")


def swinging(subject: Subject, room: Room, rate: float) -> Motion | LeftOut:
    """Plan a swing with the drives off, beside the posture in which gravity lets the joints hang,
    as far as the nominal model stays within the ranges of motion.

    Args:
        subject: with its base fixed.
        room: of its joints.
        rate: of the ticks [Hz].

    Returns:
        The motion; or why it was left out.
    """
    name = "swing"
    ticks = np.arange(round(SWING * rate) + 1) / rate
    viscous = subject.viscous + SETTLING * joint_strength(subject)
    hanging = swung(dataclasses.replace(subject, viscous=viscous), room.centre, ticks)[-1]
    if not ((hanging >= room.low) & (hanging <= room.high)).all():
        return LeftOut(name, "with the drives off the joints fall out of their range")
    side = np.where(np.arange(len(room.centre)) % 2 == 0, 1.0, -1.0)
    for size in SWING_FROM:
        start = np.clip(hanging + size * room.reach * side, room.low, room.high)
        lift = trajectories.visited(rate, [room.centre, start], [0.2, 0.5], room, 1.0)
        free = swung(subject, start, ticks)
        if not (np.isfinite(free).all() and (free >= room.low).all() and (free <= room.high).all()):
            continue
        use = use_of(subject, room, lift, 1 / rate)
        target = targets_for(subject, lift, 1 / rate)
        if (
            use.fits(False)
            and (target <= subject.position_high).all()
            and (target >= subject.position_low).all()
        ):
            position = np.concatenate([lift, free])
            time = np.arange(len(position)) / rate
            target = np.concatenate([target, np.full_like(free, np.nan)])
            purpose = "friction and springs of the joints with the drives off"
            return Motion(name, purpose, time, target, position, size, use)
    return LeftOut(name, "with the drives off the joints swing out of their range")


def loaded_postures(subject: Subject, room: Room, count: int = 64) -> tuple[np.ndarray, np.ndarray]:
    """Find, of many postures, the one that gravity loads most and the one that it loads least, over
    the joints' strength.

    Args:
        subject: with its base fixed.
        room: of its joints.
        count: number of postures.

    Returns:
        The two postures [rad], `(n,)` each.
    """
    postures = room.centre + 0.8 * room.reach * trajectories.spread(count, len(room.centre))
    still = np.zeros_like(postures)
    load = np.abs(rigid.inverse_dynamics(subject, postures, still, still)) / joint_strength(subject)
    total = load.sum(1)
    return postures[int(np.argmax(total))], postures[int(np.argmin(total))]


def best_phases(
    subject: Subject, room: Room, time: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Draw phases of the Fourier series and keep those whose inertial regressor has the largest
    determinant.

    Parameters that no motion of this robot shows are left out of the determinant.

    Args:
        subject: with its base fixed.
        room: of its joints.
        time: of the ticks [s], `(t,)`.
        rng: random numbers.

    Returns:
        The phases [rad], `(harmonics, n)`.
    """
    drawn = rng.uniform(0, 2 * np.pi, (DRAWS, HARMONICS, len(room.centre)))
    motions = (trajectories.fourier(time, room, FOURIER_BASE, HARMONICS, p) for p in drawn)
    grams = [_inertial_gram(subject, motion, time[1] - time[0]) for motion in motions]
    values, axes = np.linalg.eigh(np.sum(grams, 0))
    shown = axes[:, values > 1e-9 * values[-1]]
    scores = [np.linalg.slogdet(shown.T @ gram @ shown)[1] for gram in grams]
    return np.asarray(drawn[int(np.argmax(scores))])


def _inertial_gram(subject: Subject, position: np.ndarray, step: float) -> np.ndarray:
    velocity = np.gradient(position, step, axis=0)
    acceleration = np.gradient(velocity, step, axis=0)
    tree = subject.tree
    columns = []
    for joint in range(tree.count):
        link = next(compress(tree.links, tree.link_joint == joint), None)
        if link is not None:
            motion = position, velocity, acceleration
            columns.append(inertial_regressor.regressors(subject, *motion, None, link)[0])
    matrix = (np.concatenate(columns, -1) / joint_strength(subject)[None, :, None]).reshape(
        -1, 10 * len(columns)
    )
    scale = np.maximum(np.abs(matrix).max(0), 1e-12)
    return np.asarray((matrix / scale).T @ (matrix / scale))
