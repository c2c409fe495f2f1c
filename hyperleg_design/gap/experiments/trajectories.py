"""Shapes of excitation of `n` joints over `t` ticks, each starting and ending at rest in the centre
of the room.

All joints move at once, out of step with each other: each has its own row in the residuals, and
coupled inertia shows as well.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hyperleg_design.gap.experiments.rig_room import Room

GOLDEN = 0.6180339887498949
"""Fraction of a turn between the phases of neighbouring joints: no two of many come together."""
SHARPNESS = 6.0
"""Exponent of the smooth least of the limits of an amplitude."""
FADE = 1.0
"""Time over which a motion swells and dies away [s]."""


def smooth_step(share: np.ndarray) -> np.ndarray:
    """Rise from 0 to 1 with zero velocity and acceleration at both ends.

    Args:
        share: from 0 to 1, `(...)`.

    Returns:
        The values, `(...)`.
    """
    share = np.clip(share, 0.0, 1.0)
    return share**3 * (10 - 15 * share + 6 * share**2)


def window(time: np.ndarray, fade: float = FADE) -> np.ndarray:
    """Compute a window that is 1 but for both ends, where it swells and dies away smoothly.

    Args:
        time: of the ticks [s], `(t,)`.
        fade: time of each end [s].

    Returns:
        `(t,)`.
    """
    return smooth_step((time - time[0]) / fade) * smooth_step((time[-1] - time) / fade)


def amplitude(frequency: np.ndarray, room: Room, size: float = 1.0) -> np.ndarray:
    """Compute the amplitude of a sine that keeps within range, speed and acceleration.

    Args:
        frequency: of the sine [Hz], `(...)`.
        room: of the joints.
        size: largest share of the range [-].

    Returns:
        The amplitude [rad], `(..., n)`.
    """
    omega = 2 * np.pi * np.asarray(frequency)[..., None]
    by_speed, by_acceleration = size * room.speed / omega, size * room.acceleration / omega**2
    by_range = np.broadcast_to(size * room.reach, by_speed.shape)
    limits = np.stack([by_range, by_speed, by_acceleration])
    least = limits.min(0)
    # A smooth least: where one limit gives way to another, a chirp's velocity must not jump.
    return np.asarray(least * ((least / limits) ** SHARPNESS).sum(0) ** (-1 / SHARPNESS))


def chirp(time: np.ndarray, room: Room, slowest: float, fastest: float) -> np.ndarray:
    """Plan a frequency that rises by the same factor each second, each joint a little off the
    others.

    Its amplitude is what range, speed and acceleration leave at each frequency.

    Args:
        time: of the ticks [s], `(t,)`.
        room: of the joints.
        slowest: frequency at the begin [Hz].
        fastest: frequency at the end [Hz].

    Returns:
        Positions [rad], `(t, n)`.
    """
    total, count = time[-1] - time[0], len(room.centre)
    growth = np.log(fastest / slowest)
    share = (time - time[0]) / total
    columns = []
    for joint in range(count):
        pace = 1 - 0.12 * ((joint * GOLDEN) % 1.0)
        frequency = pace * slowest * np.exp(growth * share)
        turns = pace * slowest * total / growth * np.expm1(growth * share) + joint * GOLDEN
        phase = 2 * np.pi * turns
        columns.append(0.85 * amplitude(frequency, room)[:, joint] * np.sin(phase))
    return np.asarray(room.centre + np.stack(columns, -1) * window(time)[:, None])


def sweeps(
    rate: float,
    room: Room,
    frequencies: Sequence[float],
    sizes: Sequence[float],
    periods: float = 2.5,
) -> np.ndarray:
    """Plan bursts of sines, with every amplitude at each frequency.

    Args:
        rate: of the ticks [Hz].
        room: of the joints.
        frequencies: of the sines [Hz].
        sizes: shares of the largest amplitude [-].
        periods: of a burst, which lasts at least as many seconds.

    Returns:
        Positions [rad], `(t, n)`.
    """
    phase = np.arange(len(room.centre)) * GOLDEN
    parts = []
    for frequency in frequencies:
        time = np.arange(round(max(periods / frequency, periods) * rate)) / rate
        wave = (
            np.sin(2 * np.pi * (frequency * time[:, None] + phase))
            * window(time, min(FADE, time[-1] / 4))[:, None]
        )
        parts += [wave * amplitude(np.array(frequency), room, size) for size in sizes]
    return np.asarray(room.centre + np.concatenate(parts))


def ramps(rate: float, room: Room, speeds: Sequence[float], reach: float = 0.4) -> np.ndarray:
    """Plan one slow triangle with rounded corners at each speed.

    Args:
        rate: of the ticks [Hz].
        room: of the joints.
        speeds: of the triangles [rad/s].
        reach: of the triangles [rad], or less where the room is smaller.

    Returns:
        Positions [rad], `(t, n)`.
    """
    parts = []
    size = np.minimum(0.9 * room.reach, reach)
    for speed in speeds:
        # All joints take the time of the one with the longest way, at their own share of the speed.
        length = 4 * float(size.max()) / speed
        time = np.arange(round(length * rate)) / rate
        turns = (time / length)[:, None] + np.zeros(len(size))
        sign = np.where(np.arange(len(size)) % 2 == 0, 1.0, -1.0)
        parts.append(sign * size * _rounded(_triangle(turns), round(0.15 * rate)))
    return np.asarray(room.centre + np.concatenate(parts))


def holds(
    rate: float, room: Room, count: int, move: float = 1.0, dwell: float = 0.8, beyond: float = 0.06
) -> np.ndarray:
    """Plan postures spread over the room, each held twice: reached from below and from above.

    Args:
        rate: of the ticks [Hz].
        room: of the joints.
        count: of postures.
        move: time of a way there [s].
        dwell: time at rest [s].
        beyond: how far before and past a posture the two ways turn [rad].

    Returns:
        Positions [rad], `(t, n)`.
    """
    places = spread(count, len(room.centre))
    size = np.maximum(room.reach - beyond, 0.3 * room.reach)
    postures = [room.centre]
    rests = [0.0]
    for row in places:
        goal = room.centre + size * row
        side = np.minimum(beyond, 0.3 * room.reach)
        postures += [goal - side, goal, goal + side, goal]
        rests += [0.0, dwell, 0.0, dwell]
    postures.append(room.centre)
    rests.append(0.2)
    return visited(rate, postures, rests, room, move)


def reversals(
    rate: float,
    room: Room,
    postures: Sequence[np.ndarray],
    sizes: Sequence[float],
    strokes: int = 6,
    beat: float = 0.7,
) -> np.ndarray:
    """Plan quick small strokes to and fro about some postures, which gravity loads more or less.

    Args:
        rate: of the ticks [Hz].
        room: of the joints.
        postures: [rad], `(n,)` each.
        sizes: of the strokes.
        strokes: at each posture and size.
        beat: time of a stroke [s].

    Returns:
        Positions [rad], `(t, n)`.
    """
    parts, last = [], room.centre
    for posture in postures:
        parts.append(visited(rate, [last, posture], [0.0, 0.4], room, 1.0))
        stops, rests = [posture], [0.0]
        for size in sizes:
            step = np.minimum(size, 0.4 * room.reach)
            for stroke in range(strokes):
                # Neighbouring joints stroke against each other.
                swing = np.where((np.arange(len(room.centre)) + stroke) % 2 == 0, 1.0, -1.0)
                stops.append(posture + swing * step)
                rests.append(0.5 * beat)
            stops.append(posture)
            rests.append(0.3)
        parts.append(visited(rate, stops, rests, room, 0.0))
        last = posture
    parts.append(visited(rate, [last, room.centre], [0.0, 0.3], room, 1.0))
    return np.concatenate(parts)


def fourier(
    time: np.ndarray, room: Room, base: float, harmonics: int, phase: np.ndarray
) -> np.ndarray:
    """Plan sums of harmonics of one slow frequency.

    Args:
        time: of the ticks [s], `(t,)`.
        room: of the joints.
        base: the slow frequency [Hz].
        harmonics: their number.
        phase: of each harmonic and joint [rad], `(harmonics, n)`.

    Returns:
        Positions [rad], `(t, n)`.
    """
    order = np.arange(1, harmonics + 1)
    weight = 1.0 / np.sqrt(order)
    waves = np.sin(2 * np.pi * base * order[None, :, None] * time[:, None, None] + phase[None])
    wave = np.einsum("h,thn->tn", weight, waves)
    wave /= np.maximum(np.abs(wave).max(0), 1e-9)
    moving = room.reach * wave * window(time)[:, None]
    step = time[1] - time[0]
    speed = np.abs(np.gradient(moving, step, axis=0)).max(0)
    return np.asarray(
        room.centre + moving * np.minimum(1.0, 0.7 * room.speed / np.maximum(speed, 1e-9))
    )


def visited(
    rate: float, stops: Sequence[np.ndarray], rests: Sequence[float], room: Room, least: float
) -> np.ndarray:
    """Plan straight ways from stop to stop, as quick as speed and acceleration allow.

    Args:
        rate: of the ticks [Hz].
        stops: postures [rad], `(n,)` each.
        rests: time at each stop [s].
        room: of the joints.
        least: time that a way takes at least [s].

    Returns:
        Positions [rad], `(t, n)`.
    """
    rows = [np.broadcast_to(stops[0], (max(round(rests[0] * rate), 1), len(room.centre)))]
    for before, after, rest in zip(stops[:-1], stops[1:], rests[1:], strict=True):
        way = np.abs(after - before)
        # The fifth-order step is at most 1.875 ways a duration fast and accelerates at most by
        # 5.7735.
        by_speed = float((1.875 * way / room.speed).max())
        by_acceleration = float(np.sqrt(5.7735 * way / room.acceleration).max())
        time = max(0.12, least, by_speed, by_acceleration)
        share = smooth_step(np.arange(1, round(time * rate) + 1) / round(time * rate))[:, None]
        rows += [
            before + share * (after - before),
            np.broadcast_to(after, (round(rest * rate), len(way))),
        ]
    return np.concatenate(rows)


def _triangle(turns: np.ndarray) -> np.ndarray:
    """From 0 up to 1, down to -1 and back in one turn."""
    return np.asarray(4 * np.abs((turns - 0.25) % 1.0 - 0.5) - 1)


def _rounded(values: np.ndarray, ticks: int) -> np.ndarray:
    """Corners rounded by two running means; both ends are taken to go on as they are held."""
    from scipy.ndimage import uniform_filter1d

    padded = np.concatenate(
        [np.repeat(values[:1] * 0, 2 * ticks, 0), values, np.repeat(values[-1:] * 0, 2 * ticks, 0)]
    )
    return np.asarray(uniform_filter1d(uniform_filter1d(padded, ticks, axis=0), ticks, axis=0))


def spread(count: int, dimensions: int) -> np.ndarray:
    """Compute points that fill (-1, 1)^dimensions evenly, the same each time (additive recurrence
    of Roberts).

    Args:
        count: number of points.
        dimensions: of each point.

    Returns:
        `(count, dimensions)`.
    """
    root = 2.0
    for _ in range(40):
        root = (1 + root) ** (1 / (dimensions + 1))
    steps = root ** -np.arange(1.0, dimensions + 1)
    return np.asarray(2 * ((0.5 + np.outer(np.arange(1, count + 1), steps)) % 1.0) - 1)
