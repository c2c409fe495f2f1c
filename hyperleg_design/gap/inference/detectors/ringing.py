"""Joints that ring: above the frequencies of their motion their residuals are far larger than in
the references.

Play that knocks, a loose part and a control loop on the edge of its stability all do so. None of
them is noise, but what a log shows above its motion is taken for the noise of its sensors, in which
every fault is lost then.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import welch

from hyperleg_design.gap.inference.white_noise import has_room, white_density
from hyperleg_design.gap.signals.filtering import FilteredLog, Row
from hyperleg_design.gap.signals.smoothing import bridged

AROUND = 0.2
"""Half the width of the band around that frequency in which motion is compared, over it [-]."""
WINDOW = 1024
"""Most ticks in a window of the spectrum in which the loudest frequency is looked up."""


@dataclass(frozen=True)
class Ringing:
    """How loud a joint rings."""

    times: float
    """Root mean square of its residual of motion above the frequencies of the motion, in the
    loudest log, over that in the loudest reference [-]."""
    frequency: float
    """Above those of the motion, at which this log is loudest [Hz]."""
    mover: str
    """Joint whose motion at this frequency is farthest above that in the references."""
    moves: float
    """How far: root mean square over the largest of the references [-]."""


def ringing(
    tests: Sequence[FilteredLog], references: Sequence[FilteredLog], least: float
) -> dict[str, Ringing]:
    """Find the joints that ring in a log under test and in no reference.

    Args:
        tests: logs under test.
        references: of the healthy robot; without any, no joint is named.
        least: density over that of the references from which a joint rings,
            `PosteriorRules.ringing` [-].

    Returns:
        How loud each of these joints is, the loudest first.
    """
    quiet = [_densities(log) for log in references]
    loud = [_densities(log) for log in tests]
    over: dict[str, Ringing] = {}
    for joint in dict.fromkeys(joint for density in loud for joint in density):
        own = [density.get(joint, 0.0) for density in loud]
        before = max((density.get(joint, 0.0) for density in quiet), default=0.0)
        loudest = int(np.argmax(own))
        if before > 0 and own[loudest] > least * before:
            times = float(np.sqrt(own[loudest] / before))
            frequency = _loudest_frequency(tests[loudest], joint)
            mover, moves = _mover(tests[loudest], references, frequency)
            over[joint] = Ringing(times, frequency, mover, moves)
    return dict(sorted(over.items(), key=lambda entry: -entry[1].times))


def _loudest_frequency(log: FilteredLog, joint: str) -> float:
    """Frequency above its cutoff at which a joint's residual of motion is largest [Hz]."""
    row, _, values = next(entry for entry in _of_motion(log) if entry[0].name == joint)
    step = log.signals.step
    frequency, density = welch(values, 1 / step, nperseg=min(WINDOW, len(values)))
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
            at, density = welch(speed, 1 / recording.step, nperseg=min(WINDOW, len(speed)))
            around = np.abs(at / frequency - 1) < AROUND
            sizes[joint] = float(np.sqrt(density[around].sum()))
    return sizes


def _densities(log: FilteredLog) -> dict[str, float]:
    """By joint, the density of its residual of motion above its cutoff [unit^2/Hz]; not of joints
    whose motion goes up to what the log's rate can show.
    """
    return {
        row.name: white_density(values, mask, row.cutoff, log.signals.step)
        for row, mask, values in _of_motion(log)
        if has_room(row.cutoff, log.signals.step)
    }


def _of_motion(log: FilteredLog) -> Iterator[tuple[Row, np.ndarray, np.ndarray]]:
    """Rows of the residual of motion, their known ticks, and values that are zero elsewhere."""
    for row, mask in zip(log.rows, log.mask, strict=True):
        if row.residual_name == "motion":
            residual = log.signals.residual["motion"][:, row.column]
            yield row, mask, np.where(mask, np.nan_to_num(residual), 0.0)
