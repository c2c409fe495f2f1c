"""What keeps a drive's lag from smoothing torques away that nobody measures.

A controller asks for whatever torque its loop needs, model errors included. Of what it asks for at
a frequency f, a lag of time constant T passes the share h = 1 / sqrt(1 + (2 pi f T)^2). Least
squares would rather have slow drives, whose torques hold less that needs an explanation, and a
larger gain would then make up for slow frequencies. With u = h asked - needed the density of what
is asked for is p(u) h, so the log-likelihood has n log h, as it has n log s of causes that scale a
torque by s (`endogenous`).
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.inference.samples import Samples
from hyperleg_design.gap.inference.shrinking import SMALLEST, Shrinking, moved_row
from hyperleg_design.gap.signals.channels import applied
from hyperleg_design.gap.signals.filtering import FilteredLog, place_of

FREQUENCIES = 8
"""That stand for those of a band."""


def smoothing(
    samples: Samples, effect: Effect, location: str, usual: np.ndarray, values: np.ndarray
) -> Shrinking | None:
    """Of an effect at a motor whose first parameter is a time constant; None where the motor's
    torque is measured, or its joint has no row.

    The factor's square is a parabola in the parameter that has its value and slope at the
    effect's values.

    Args:
        samples: of the logs.
        effect: of the catalogue.
        location: its place.
        usual: sizes of its parameters `(k,)`.
        values: of them `(k,)`.
    """
    if not effect.lags:
        return None
    at = moved_row(samples, location)
    if at is None or samples.measures(at[0]):
        return None
    _, joint, row = at
    parts = []
    for log, places in zip(samples.filtered_logs, samples.where, strict=True):
        place = place_of(log.rows, "motion", joint)
        if place is not None:
            parts.append(_asked(samples, log, place, places[place]))
    frequency, number = np.concatenate(parts, -1)
    size = max(float(values[0] / usual[0]), SMALLEST)
    lag = (2 * np.pi * frequency * usual[0] * size) ** 2
    slope = lag**2 / (1 + lag) ** 2 / size
    square = lag * (lag - 1) / (1 + lag) ** 2 / size**2
    return Shrinking(0, slope, square, np.ones(len(lag)), number, row)


def _asked(samples: Samples, log: FilteredLog, place: int, at: slice) -> np.ndarray:
    """Frequencies of the samples of a joint's row, and the independent numbers of each in which the
    torque is no noise `(2, samples)`.
    """
    torque = applied(
        log.signals.subject.joint_from_motor[log.rows[place].column][None], log.signals.believed
    )
    sampled = log.sample(place, np.nan_to_num(torque[:, 0])[None])[0]
    frequency, number, start = np.empty(len(sampled)), samples.share[at].copy(), 0
    for band in log.bands[place]:
        mine = slice(start, start + len(band.used))
        start = mine.stop
        part = (np.arange(len(band.used)) % FREQUENCIES + 0.5) / FREQUENCIES
        frequency[mine] = band.low + (band.high - band.low) * part
        noise = np.sum(samples.floor[at][mine] ** 2)
        number[mine] *= 1 - min(noise / max(float(np.sum(sampled[mine] ** 2)), 1e-300), 1.0)
    return np.stack([frequency, number])
