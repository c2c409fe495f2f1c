"""Joints that ring, and rotors that rattle against their joints: above the frequencies of their
motion their residuals are far larger than in the references.

Play that knocks, a loose part and a control loop on the edge of its stability all do so. None of
them is noise, but what a log shows above its motion is taken for the noise of its sensors, in which
every fault is lost then.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import welch

from hyperleg_design.gap.inference.white_noise import HIGHEST, has_room, white_density
from hyperleg_design.gap.signals.filtering import FilteredLog, Row
from hyperleg_design.gap.signals.smoothing import bridged

AROUND = 0.2
"""Half the width of the band around that frequency in which motion is compared, over it [-]."""
WINDOW = 1024
"""Most ticks in a window of a spectrum."""
MOTION, TRANSMISSION = HEARD = "motion", "transmission"
"""Residuals that are listened to: of the torque of joints, and of the speed of rotors over that of
their joints."""


@dataclass(frozen=True)
class Ringing:
    """How loud a residual of a joint or a motor rings."""

    times: float
    """Root mean square of the residual above the frequencies of the motion, in the loudest log,
    over that in the loudest reference [-]."""
    frequency: float
    """Above those of the motion, at which this log is loudest [Hz]."""
    mover: str
    """Joint whose motion at this frequency is farthest above that in the references."""
    moves: float
    """How far: root mean square over the largest of the references [-]."""


def ringing(
    tests: Sequence[FilteredLog], references: Sequence[FilteredLog], least: float
) -> dict[tuple[str, str], Ringing]:
    """Find the joints and rotors that ring in a log under test and in no reference.

    Args:
        tests: logs under test.
        references: of the healthy robot; without any, none is named.
        least: density over that of the references from which a residual rings,
            `PosteriorRules.ringing` [-].

    Returns:
        How loud each is, by its residual and its name, the loudest first.
    """
    quiet = [_densities(log) for log in references]
    loud = [_densities(log) for log in tests]
    over: dict[tuple[str, str], Ringing] = {}
    for place in dict.fromkeys(place for density in loud for place in density):
        own = [density.get(place, 0.0) for density in loud]
        before = max((density.get(place, 0.0) for density in quiet), default=0.0)
        loudest = int(np.argmax(own))
        if before > 0 and own[loudest] > least * before:
            times = float(np.sqrt(own[loudest] / before))
            frequency = _loudest_frequency(tests[loudest], place)
            mover, moves = _mover(tests[loudest], references, frequency)
            over[place] = Ringing(times, frequency, mover, moves)
    return dict(sorted(over.items(), key=lambda entry: -entry[1].times))


def _loudest_frequency(log: FilteredLog, place: tuple[str, str]) -> float:
    """Frequency above its cutoff at which a residual is largest [Hz]."""
    row, _, values = next(entry for entry in _heard(log) if _place(entry[0]) == place)
    step = log.signals.step
    frequency, density = _spectrum(values, step)
    above = frequency >= min(row.cutoff, 0.25 / step)
    return float(frequency[above][np.argmax(density[above])])


def _mover(
    log: FilteredLog, references: Sequence[FilteredLog], frequency: float
) -> tuple[str, float]:
    """Joint whose motion at a frequency is farthest above that in the references, and how far."""
    moved = _motion_at(log, frequency)
    before = {
        joint: max(_motion_at(other, frequency).get(joint, 0.0) for other in references)
        for joint in moved
    }
    ratios = {joint: size / before[joint] for joint, size in moved.items() if before[joint] > 0}
    mover = max(ratios, key=lambda joint: ratios[joint], default="")
    return mover, ratios.get(mover, 0.0)


def _motion_at(log: FilteredLog, frequency: float) -> dict[str, float]:
    """By joint, the root mean square of its logged motion around a frequency."""
    recording, sizes = log.signals.log, {}
    for joint in log.signals.subject.joints:
        position = recording.column(f"position/{joint}")
        if np.isfinite(position).any():
            speed = np.diff(bridged(position))
            at, density = _spectrum(speed, recording.step)
            around = np.abs(at / frequency - 1) < AROUND
            sizes[joint] = float(np.sqrt(density[around].sum()))
    return sizes


def _spectrum(values: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [Hz], and the density of values `(t,)` at each."""
    return welch(values, 1 / step, nperseg=min(WINDOW, len(values)))


def _densities(log: FilteredLog) -> dict[tuple[str, str], float]:
    """The density of each residual above its cutoff [unit^2/Hz]; not of those whose motion goes up
    to what the log's rate can show.
    """
    return {
        _place(row): (white_density if row.residual_name == MOTION else _mean_density)(
            values, mask, row.cutoff, log.signals.step
        )
        for row, mask, values in _heard(log)
        if has_room(row.cutoff, log.signals.step)
    }


def _mean_density(values: np.ndarray, mask: np.ndarray, cutoff: float, step: float) -> float:
    """As `white_density`, but the mean: a rotor that hits both ends of its play at one rate is a
    line, and other lines of its speed over that of its joints are as loud in the references.
    """
    frequency, density = _spectrum(values, step)
    above = (frequency >= cutoff) & (frequency <= HIGHEST / step)
    return float(density[above].mean()) if mask.any() and above.any() else 0.0


def _place(row: Row) -> tuple[str, str]:
    return row.residual_name, row.name


def _heard(log: FilteredLog) -> Iterator[tuple[Row, np.ndarray, np.ndarray]]:
    """Rows of `HEARD`, their known ticks, and values that are zero elsewhere."""
    for row, mask in zip(log.rows, log.mask, strict=True):
        if row.residual_name in HEARD:
            residual = log.signals.residual[row.residual_name][:, row.column]
            yield row, mask, np.where(mask, np.nan_to_num(residual), 0.0)
