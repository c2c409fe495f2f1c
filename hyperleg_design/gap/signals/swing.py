"""The line of a joint that chatters, as complex amplitudes in time: a signal is the real part of a
e^(i w t) about the frequency w.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.signals.channels import resampled
from hyperleg_design.gap.signals.waveform import HARMONIC, THIRD, sharpness

if TYPE_CHECKING:
    from hyperleg_design.gap.model.subject import Subject
    from hyperleg_design.gap.signals.signals import Signals

HALF_WIDTH = 6 / 256
"""Of the limit cycle's line, over the log's rate; its frequency wanders with posture and load."""
FOLDS, UNLIKE = 3, 1.35
"""Multiples of a log's rate that frequencies are looked for beside; frequency by speed over swing,
over the true one or its inverse, at most: drives filter the speeds that they tell."""
SHOWN_PERIODS = 10
"""Of chatter, for the eye."""
COMMANDED = 0.1
"""Highest frequency of commanded motion, over the log's rate (assumed)."""


@dataclass(frozen=True, eq=False)
class Swing:
    """Chatter of one log, `n` joints."""

    frequency: float
    """[Hz]"""
    seen: float
    """Where the log's rate shows it [Hz]."""
    angle: np.ndarray
    """Amplitudes of the joints' angles `(t, n)` [rad], complex."""
    third: np.ndarray
    """Of three times the frequency `(t, n)` [rad]; 0 where the log's rate shows that as slow as
    what is commanded, or beside the line."""
    folded: bool
    """Whether just one of both is shown with its phase turned round."""


def swing(signals: Signals) -> Swing | None:
    """The line of the joint that chatters most, in all joints; None where none does, or speeds and
    angles do not go together.
    """
    if signals.limit_cycle is None or not signals.limit_cycle.joints.any():
        return None
    shaken = np.flatnonzero(signals.limit_cycle.joints)
    strongest = int(shaken[np.argmax(np.mean(signals.limit_cycle.speed[:, shaken] ** 2, 0))])
    seen = float(signals.limit_cycle.frequency[strongest])
    apart, faster = (
        _apart(signals, "position", signals.position),
        _apart(signals, "velocity", signals.velocity),
    )
    angle = band(apart, signals.step, seen)
    size, speed = (float(rms(x[:, strongest])) for x in (angle, band(faster, signals.step, seen)))
    frequency = (
        seen if speed == 0 else unfolded(seen, 1 / signals.step, speed / size) if size > 0 else None
    )
    if frequency is None:
        return None
    rate = 1 / signals.step
    shown = _folded(THIRD * frequency, rate)
    apart_enough = shown > COMMANDED * rate and abs(shown - seen) > 2 * HALF_WIDTH * rate
    third = (
        band(apart, signals.step, shown, HALF_WIDTH / 2) if apart_enough else np.zeros_like(angle)
    )
    return Swing(
        frequency, seen, angle, third, _turned(frequency, rate) != _turned(THIRD * frequency, rate)
    )


def sharp(found: Swing, subject: Subject, motor: int) -> bool:
    """Whether a motor with its joints swings as a rotor in its play does, see `waveform`; that of a
    spring is a sine.
    """
    first, third = (one @ subject.joint_from_motor[:, motor] for one in (found.angle, found.third))
    z = sharpness(first, np.conj(third) if found.folded else third)
    return z.real > 0 and abs(z) > HARMONIC


def loudest(size: np.ndarray, frequency: float, step: float) -> slice:
    """Some periods about where a line is largest, for the eye; `size` `(t,)`."""
    half = round(SHOWN_PERIODS / 2 / frequency / step)
    middle = min(max(int(np.argmax(size)), half), len(size) - 1 - half)
    return slice(max(middle - half, 0), middle + half + 1)


def _folded(frequency: float, rate: float) -> float:
    """Where a log's rate shows a frequency [Hz]."""
    return min(frequency % rate, -frequency % rate)


def _turned(frequency: float, rate: float) -> bool:
    """Whether a log's rate shows a frequency with its phase turned round."""
    return frequency % rate > rate / 2


def unfolded(seen: float, rate: float, told: float) -> float | None:
    """The frequency that a log's rate may show as another, by speed over swing [rad/s]; None where
    that fits none.
    """
    able = [abs(turn * rate + sign * seen) for turn in range(FOLDS) for sign in (1, -1)]
    nearest = min(able, key=lambda one: abs(np.log(told / (2 * np.pi * one))))
    return nearest if 1 / UNLIKE < told / (2 * np.pi * nearest) < UNLIKE else None


def band(
    values: np.ndarray, step: float, frequency: float, width: float = HALF_WIDTH
) -> np.ndarray:
    """Amplitude and phase of a line `(t, k)`, complex: the signal about a frequency, those below 0
    left out.
    """
    about = np.abs(np.fft.fftfreq(len(values), step) - frequency) <= width / step
    return np.asarray(np.fft.ifft(2 * about[:, None] * np.fft.fft(values, axis=0), axis=0))


def rms(values: np.ndarray) -> np.ndarray:
    """Of complex rows `(t, ...)`, `(...)`."""
    return np.asarray(np.sqrt(np.mean(np.abs(values) ** 2, 0)))


def _apart(signals: Signals, kind: str, smooth: np.ndarray) -> np.ndarray:
    """Logged motion less the smoothed, on the ticks `(t, n)`; 0 where it is unknown."""
    found = (
        resampled(signals.log.time, signals.log.stack(kind, signals.subject.joints), signals.time)
        - smooth
    )
    return np.where(np.isfinite(found), found, 0.0)
