"""Motions that the rigs' operators ran: written for the plants, apart from the ones that the
diagnosis recommends.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.validation.blind.robots.chain import Chain

RIG = ("chirp", "ramps", "holds", "reversals")
"""Motions of the first plant's operator."""
OTHER = ("multisine", "triangles", "steps", "sweep")
"""Motions of the second's."""


def motion(
    kind: str, chain: Chain, duration: float, rate: float, rng: np.random.Generator
) -> np.ndarray:
    """Position targets `(ticks, n)` [rad] that start at the rest posture and stay inside the
    limits.

    Args:
        kind: one of `RIG` or `OTHER`.
        chain: the robot.
        duration: [s].
        rate: of the host [Hz].
        rng: for phases, orders and amplitudes.

    Raises:
        ValueError: an unknown kind.
    """
    if kind not in _SHAPES:
        raise ValueError(f"no motion {kind!r}; there are {', '.join(_SHAPES)}")
    time = np.arange(round(duration * rate)) / rate
    room = np.minimum(chain.rest - chain.low, chain.high - chain.rest)
    amplitude = np.minimum(0.75 * room, 0.55) * rng.uniform(0.75, 1.0, room.size)
    shape = _SHAPES[kind](time, amplitude, rng)
    grown = np.clip(time / 0.5, 0, 1)
    return chain.rest + shape * (grown * grown * (3 - 2 * grown))[:, None]


def _chirp(time: np.ndarray, amplitude: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Logarithmic chirps whose amplitude falls so that speeds stay near a limit."""
    columns = []
    for size in amplitude:
        slow, fast = rng.uniform(0.08, 0.2), rng.uniform(4.0, 9.0)
        total = time[-1] + time[1]
        growth = np.log(fast / slow)
        phase = 2 * np.pi * slow * total / growth * np.expm1(growth * time / total)
        frequency = slow * np.exp(growth * time / total)
        shrink = np.minimum(1.0, np.sqrt(0.5 / frequency)) * np.minimum(
            1.0, 2.5 / (2 * np.pi * frequency * size)
        )
        columns.append(size * shrink * np.sin(rng.choice([-1, 1]) * phase))
    return np.stack(columns, -1)


def _ramps(time: np.ndarray, amplitude: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Slow triangles, each joint at its own constant speed."""
    return np.stack(
        [size * _triangle(time / rng.uniform(3.0, 7.0) + rng.uniform()) for size in amplitude], -1
    )


def _holds(time: np.ndarray, amplitude: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Postures held, with smooth moves of 0.6 s between."""
    dwell = rng.uniform(1.3, 2.0)
    count = int(time[-1] / dwell) + 2
    places = rng.uniform(-1, 1, (count, amplitude.size)) * amplitude
    places[0] = 0
    index = np.minimum((time / dwell).astype(int), count - 2)
    share = np.clip((time - index * dwell) / 0.6, 0, 1)[:, None]
    share = share**3 * (10 - 15 * share + 6 * share**2)
    return places[index] * (1 - share) + places[index + 1] * share


def _reversals(time: np.ndarray, amplitude: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Small fast sines on a slow wander: many reversals at many postures."""
    columns = []
    for size in amplitude:
        quick = rng.uniform(0.9, 2.2)
        columns.append(
            0.65 * size * np.sin(2 * np.pi * (time * rng.uniform(0.07, 0.16) + rng.uniform()))
            + 0.3 * size * np.sin(2 * np.pi * quick * time)
        )
    return np.stack(columns, -1)


def _multisine(time: np.ndarray, amplitude: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Sums of nine sines with random phases."""
    frequency = np.geomspace(0.1, 4.0, 9)
    weight = 1.0 / np.maximum(1.0, frequency / 0.5) ** 1.3
    columns = []
    for size in amplitude:
        own = frequency * rng.uniform(0.93, 1.07, 9)
        wave = (
            weight * np.sin(2 * np.pi * np.outer(time, own) + rng.uniform(0, 2 * np.pi, 9))
        ).sum(-1)
        columns.append(size * wave / np.abs(wave).max())
    return np.stack(columns, -1)


def _triangles(time: np.ndarray, amplitude: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Triangles that grow from small to full, one joint after the other leading."""
    grow = np.linspace(0.25, 1.0, time.size)[:, None]
    return grow * np.stack(
        [size * _triangle(time / rng.uniform(1.2, 4.0) + rng.uniform()) for size in amplitude], -1
    )


def _steps(time: np.ndarray, amplitude: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Steps of several sizes, rounded over 0.2 s."""
    dwell = rng.uniform(0.8, 1.4)
    count = int(time[-1] / dwell) + 2
    places = rng.uniform(-0.8, 0.8, (count, amplitude.size)) * amplitude
    places[0] = 0
    index = np.minimum((time / dwell).astype(int), count - 2)
    share = np.clip((time - index * dwell) / 0.2, 0, 1)[:, None]
    share = share * share * (3 - 2 * share)
    return places[index] * (1 - share) + places[index + 1] * share


def _sweep(time: np.ndarray, amplitude: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Sines in stages: each stage another frequency, ten stages."""
    from scipy.ndimage import uniform_filter1d

    stages = np.minimum((10 * time / (time[-1] + 1e-9)).astype(int), 9)
    columns = []
    for size in amplitude:
        frequency = rng.permutation(np.geomspace(0.2, 4.5, 10))[stages]
        phase = 2 * np.pi * np.cumsum(frequency) * (time[1] - time[0])
        weight = uniform_filter1d(
            np.minimum(1.0, 0.4 / frequency) ** 1.3, max(1, round(0.4 / (time[1] - time[0])))
        )
        columns.append(size * weight * np.sin(phase))
    return np.stack(columns, -1)


def _triangle(turns: np.ndarray) -> np.ndarray:
    return 4 * np.abs((turns + 0.25) % 1.0 - 0.5) - 1.0


_SHAPES = {
    "chirp": _chirp,
    "ramps": _ramps,
    "holds": _holds,
    "reversals": _reversals,
    "multisine": _multisine,
    "triangles": _triangles,
    "steps": _steps,
    "sweep": _sweep,
}
