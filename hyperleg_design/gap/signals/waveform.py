"""Whether joints that swing by themselves knock about: between the ends of their play they move at
constant speed.

A joint on a spring swings as a sine. One in its play is hit at the ends of each swing and is free
between: its angle is about a triangle, whose third harmonic, 1 / 9 of the first, peaks where the
first does. So z = <a_3 conj(a_1)^3> / <|a_1|^4> of the amplitudes of both, which no shift in time
changes, is positive; noise averages out. Limits of torque round the triangle off, and friction that
holds a joint at its turns makes z negative. Only lines that the targets do not have count.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from hyperleg_design.gap.signals.channels import resampled
from hyperleg_design.gap.signals.smoothing import filled

if TYPE_CHECKING:
    from hyperleg_design.gap.signals.signals import Signals

THIRD = 3
"""The harmonic by which play differs from a spring."""
WINDOW, PADDED = 1.0, 8
"""In which a swing is looked at [s], and zeros after it, in windows: lines between the frequencies
of a window are seen."""
LOWEST, HIGHEST = 6.0, 0.15
"""Of a swing [Hz], and over the log's rate: its third harmonic must be seen."""
NEAR, ALOOF = 1.5, 4.0
"""How far from a line noise begins, and how far it is looked at, in 1 / `WINDOW`."""
LINE = 0.4
"""Share of the squares of speeds above `LOWEST` which a line has."""
COMMANDED = 0.3
"""Amplitude of the targets over that of the joints, from which a line is commanded."""
HARMONIC, CLEAR, WINDOWS = 0.02, 1.8, 5
"""z of play at least, its third harmonic over the noise beside it, and in so many windows."""

_SWINGS: WeakKeyDictionary[Signals, dict[int, np.ndarray]] = WeakKeyDictionary()


def sharpness(first: np.ndarray, third: np.ndarray) -> complex:
    """The z of amplitudes `(t,)`, complex; 0 of none."""
    size = float(np.sum(np.abs(first) ** 4))
    return complex(np.sum(third * np.conj(first) ** THIRD) / size) if size > 0 else 0j


def knocks(signals: Sequence[Signals], motor: int) -> bool:
    """Whether the joints of a motor swing by themselves as in play, in logs of which the sum of all
    such swings counts.
    """
    found = np.concatenate([_swings(one, motor) for one in signals], 1)
    if found.shape[1] < WINDOWS:
        return False
    first, third, noise = found
    weight = np.abs(first) ** 2
    clear = float(np.sum(weight * np.abs(third)) / max(float(np.sum(weight * noise.real)), 1e-300))
    return clear > CLEAR and sharpness(first, third).real > HARMONIC


def _swings(signals: Signals, motor: int) -> np.ndarray:
    """Of each window with a swing: amplitudes of the line, of its third harmonic, and of the noise
    beside that `(3, w)`, complex.
    """
    kept = _SWINGS.setdefault(signals, {})
    if motor not in kept:
        kept[motor] = _looked(signals, motor)
    return kept[motor]


def _looked(signals: Signals, motor: int) -> np.ndarray:
    step, subject = signals.step, signals.subject
    size = round(WINDOW / step)
    frequency = np.fft.rfftfreq(PADDED * size, step)
    able = (frequency >= LOWEST) & (frequency <= HIGHEST / step)
    if signals.target is None or not able.any() or len(signals.time) < size:
        return np.zeros((3, 0), complex)
    weights = subject.joint_from_motor[:, motor]
    way = (
        filled(
            resampled(signals.log.time, signals.log.stack("position", subject.joints), signals.time)
        )
        @ weights
    )
    wanted = np.nan_to_num(signals.target) @ weights
    turn = np.exp(
        2j * np.pi * frequency * (size - 1) / 2 * step
    )  # amplitudes in the middle of the window
    found = []
    for start in range(0, len(way) - size + 1, size // 2):
        moved, asked = (_spectrum(values[start : start + size]) for values in (way, wanted))
        power = np.abs(moved * frequency) ** 2
        place = int(np.argmax(np.where(able, power, 0.0)))
        line = frequency[place]
        share = power[np.abs(frequency - line) <= NEAR / WINDOW].sum() / max(
            float(power[frequency > LOWEST - 1 / WINDOW].sum()), 1e-300
        )
        if share < LINE or abs(asked[place]) > COMMANDED * abs(moved[place]):
            continue
        apart = np.abs(frequency - THIRD * line)
        harmonic = int(np.argmin(apart))
        noise = np.median(np.abs(moved[(apart > NEAR / WINDOW) & (apart <= ALOOF / WINDOW)]))
        found.append((moved[place] * turn[place], moved[harmonic] * turn[harmonic], noise))
    return np.array(found, complex).reshape(-1, 3).T


def _spectrum(values: np.ndarray) -> np.ndarray:
    """Of a window `(t,)` less its parabola, tapered."""
    time = np.linspace(-1.0, 1.0, len(values))
    rest = values - np.polyval(np.polyfit(time, values, 2), time)
    return np.asarray(np.fft.rfft(rest * np.hanning(len(values)), PADDED * len(values)))
