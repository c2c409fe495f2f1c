"""One zero-phase filter for residuals and traces: each row cut into bands, each band at about the
rate that it can tell anything at.

Bands share the spectrum smoothly, sum of squared gains 1 below a row's cutoff, so that the mean
squares of all bands add up to that of the filtered row. The filter is linear, unknown ticks count
as zero on both sides, and what it does to a residual it does to a
trace: it cancels. In a band [a, b] a row of duration T holds 2 (b - a) T independent numbers; the
    samples of a band number a few
more, and each counts for its `share`. So noise that is coloured over the whole band is nearly white
in each.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hyperleg_design.gap.signals.signals import Signals

EDGES = (0.5, 1.5, 4.0, 10.0)
"""Between bands [Hz]; the last band ends at a row's cutoff."""
HIGHEST = 25.0
"""Highest cutoff [Hz]: sensors and belts of arms and legs tell little of torques above
(assumed)."""
WIDEST = 1.0
"""Bandwidth that the numbers of a band count for at most [Hz]."""
OF_BANDWIDTH, OF_RATE = 0.9, 0.4
"""Cutoff over the frequency above which motion is noise, and over the log's rate."""
OF_SPEEDS = 0.5
"""The same of speeds that are not smoothed, against some that are: there the smoother lets 98 %
pass."""
WITHOUT_BANDWIDTH = 10.0
"""Cutoff where the log does not tell it [Hz]."""
OF_BALANCE = {"base": 10.0, "ground": 20.0}
"""Cutoff of residuals whose rows are no joints [Hz]."""
OVERLAP = 0.15
"""Half width of the transition between bands, over its frequency."""
KNOWN = 0.7
"""Share of known ticks around a sample from which it counts."""
LEAST_MOVING = 0.08
"""Share of known ticks in which a joint moves from which its rest is left out."""
SELDOM, STRETCH = 0.25, 0.2
"""Share of known ticks in which a joint with dry friction moves up to which only stretches as long
as this count [s]."""
FEWEST = 40
"""Known ticks of a row below which it is left out."""


@dataclass(frozen=True)
class Row:
    """One row of a residual."""

    residual_name: str
    column: int
    name: str
    """Joint, motor, foot and axis, or axis of the base."""
    cutoff: float
    """[Hz]"""


@dataclass(frozen=True, eq=False)
class Band:
    """One band of one row."""

    index: int
    low: float
    high: float
    """[Hz]"""
    bins: slice
    gain: np.ndarray
    count: int
    """Samples over the whole transform."""
    length: int
    """Ticks of the whole transform."""
    kept: np.ndarray
    """Samples that count."""


@dataclass(frozen=True, eq=False)
class FilteredLog:
    """What cuts the rows of one log into samples: bands of a row one after the other, samples of a
    band in order of time.
    """

    signals: Signals
    rows: tuple[Row, ...]
    mask: np.ndarray
    """Known ticks `(rows, t)`."""
    bands: tuple[tuple[Band, ...], ...]
    """Of each row."""
    length: int
    """Of the transforms."""

    def sample(self, row: int, values: np.ndarray) -> np.ndarray:
        """Samples of one row of a residual or of traces.

        Args:
            row: place in `rows`.
            values: `(k, t)`; unknown ticks count as zero.

        Returns:
            `(k, samples of the row)`.
        """
        from scipy.fft import irfft, rfft

        spectrum = rfft(
            np.where(self.mask[row] & np.isfinite(values), values, 0.0), self.length, axis=-1
        )
        parts = []
        for band in self.bands[row]:
            cut = np.zeros((len(values), band.count // 2 + 1), complex)
            cut[:, band.bins] = spectrum[:, band.bins] * band.gain
            parts.append(irfft(cut, band.count, axis=-1)[:, band.kept] * (band.count / self.length))
        return np.concatenate(parts, -1) if parts else np.zeros((len(values), 0))

    def count(self, row: int) -> int:
        """Count the samples of a row.

        Args:
            row: its index.

        Returns:
            The count.
        """
        return sum(len(band.kept) for band in self.bands[row])

    def labels(self, row: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Describe the samples of a row.

        What models of robots get wrong is wrong alike in every cycle of a motion, and most so at
        high frequencies. Therefore no band counts for more than one `WIDEST` wide.

        Args:
            row: its index.

        Returns:
            Band of each sample, time from the log's beginning [s], and the independent numbers that
            each stands for.
        """
        span = self.length * self.signals.step
        parts = [
            (
                np.full(len(b.kept), b.index),
                b.kept * (span / b.count),
                np.full(len(b.kept), 2 * min(b.high - b.low, WIDEST) * span / b.count),
            )
            for b in self.bands[row]
        ]
        if not parts:
            return np.zeros(0, int), np.zeros(0), np.zeros(0)
        return tuple(np.concatenate(column) for column in zip(*parts, strict=True))  # type: ignore[return-value]


def filtered_log(signals: Signals, resting: np.ndarray | None = None) -> FilteredLog:
    """Prepare the filter of one log.

    Args:
        signals: a conditioned log.
        resting: ticks at which a joint's friction is anything up to its size, left out of its row
            of motion `(t, n)`.

    Returns:
        The filter with its bands.
    """
    from scipy.fft import next_fast_len

    rows, masks = [], []
    for residual_name, residual in sorted(signals.residual.items()):
        for column in range(residual.shape[1]):
            mask = signals.valid & np.isfinite(residual[:, column])
            if residual_name == "motion" and resting is not None:
                mask = moving(
                    mask,
                    resting[:, column],
                    signals.step,
                    rubs=bool(signals.subject.coulomb[column] > 0),
                )
            if mask.sum() < FEWEST:
                continue
            rows.append(
                Row(
                    residual_name,
                    column,
                    row_name(signals, residual_name, column),
                    _cutoff(signals, residual_name, column),
                )
            )
            masks.append(mask)
    length = next_fast_len(len(signals.time), real=True)
    bands = tuple(
        _bands(row, mask, length, signals.step) for row, mask in zip(rows, masks, strict=True)
    )
    return FilteredLog(
        signals, tuple(rows), np.array(masks).reshape(len(rows), len(signals.time)), bands, length
    )


def moving(known: np.ndarray, resting: np.ndarray, step: float, *, rubs: bool) -> np.ndarray:
    """Choose the known ticks of a joint without its rest.

    The rest of a joint that hardly moves counts, too, unless its model has dry friction (`rubs`).
    Then only long stretches of its motion count, because what smoothing leaves of jerks is no noise
    any more where the moments between them are cut out.

    Args:
        known: ticks at which the residual is known, `(t,)`.
        resting: ticks at which the joint rests, `(t,)`.
        step: between ticks [s].
        rubs: whether the model of the joint has dry friction.

    Returns:
        The ticks that count, `(t,)`.
    """
    found = known & ~resting
    if found.sum() > (SELDOM if rubs else LEAST_MOVING) * known.sum():
        return found
    if not rubs:
        return known
    long = np.zeros_like(found)
    for part in stretches(found, STRETCH / step):
        long[part] = True
    return long


def stretches(mask: np.ndarray, shortest: float) -> list[slice]:
    """Find the unbroken stretches of a mask that are long enough.

    Args:
        mask: `(t,)`.
        shortest: length of a stretch at least [ticks].

    Returns:
        Slices of ticks.
    """
    ends = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    return [slice(a, b) for a, b in ends.reshape(-1, 2).tolist() if b - a >= shortest]


def moving_ticks(signals: Signals, known: np.ndarray, resting: np.ndarray) -> np.ndarray:
    """Choose the ticks that count for all joints, as `moving` does for one.

    Args:
        signals: conditioned log.
        known: `(t, n)`.
        resting: `(t, n)`.

    Returns:
        `(t, n)`.
    """
    rubs = signals.subject.coulomb > 0
    return np.stack(
        [
            moving(k, r, signals.step, rubs=bool(dry))
            for k, r, dry in zip(known.T, resting.T, rubs, strict=True)
        ],
        -1,
    )


def row_name(signals: Signals, residual_name: str, column: int) -> str:
    """Name a row of a residual: a joint, a motor, a foot and axis, or an axis of the base.

    Args:
        signals: conditioned log.
        residual_name: such as `motion`.
        column: index of the row.

    Returns:
        The name.
    """
    subject = signals.subject
    if residual_name == "motion":
        return subject.joints[column]
    if residual_name == "base":
        return ("force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z")[column]
    if residual_name == "ground":
        return f"{subject.feet[column // 3]}_{'xyz'[column % 3]}"
    return subject.motors[column]


def _cutoff(signals: Signals, residual_name: str, column: int) -> float:
    most = OF_RATE / signals.step
    if residual_name in OF_BALANCE:
        return min(OF_BALANCE[residual_name], most)
    if residual_name not in ("motion", "transmission"):
        return min(HIGHEST, most)
    joints = (
        [column]
        if residual_name == "motion"
        else np.flatnonzero(signals.subject.joint_from_motor[:, column])
    )
    bandwidth = (
        np.nan
        if signals.bandwidth is None
        else float(np.min(signals.bandwidth[joints], initial=np.inf))
    )
    if not np.isfinite(bandwidth):
        return min(WITHOUT_BANDWIDTH, most)
    return min(
        HIGHEST, (OF_BANDWIDTH if residual_name == "motion" else OF_SPEEDS) * bandwidth, most
    )


def _bands(row: Row, mask: np.ndarray, length: int, step: float) -> tuple[Band, ...]:
    from scipy.fft import next_fast_len

    span = length * step
    edges = [0.0, *(e for e in EDGES if e < 0.8 * row.cutoff), row.cutoff]
    total = np.concatenate([[0], np.cumsum(mask)])
    found = []
    for index, (low, high) in enumerate(itertools.pairwise(edges)):
        top = min(high * (1 + OVERLAP), 0.5 / step)
        first = int(np.ceil(low * (1 - OVERLAP) * span)) if low else 0
        last = int(np.floor(top * span))
        if last <= first + 1:
            continue
        frequency = np.arange(first, last + 1) / span
        gain = np.sin(_rise(frequency, low)) if low else np.ones(len(frequency))
        gain = gain * np.cos(_rise(frequency, high))
        count = next_fast_len(2 * last + 2, real=True)
        count += count % 2
        place = np.arange(count) * (length / count)
        reach = max(0.35 / high / step, 1.0)
        left = np.clip(np.floor(place - reach).astype(int), 0, len(mask))
        right = np.clip(np.ceil(place + reach).astype(int), 0, len(mask))
        near = (total[right] - total[left]) / np.maximum(
            np.minimum(place + reach, length) - np.maximum(place - reach, 0), 1.0
        )
        kept = np.flatnonzero((near >= KNOWN) & (place < len(mask)))
        found.append(Band(index, low, high, slice(first, last + 1), gain, int(count), length, kept))
    return tuple(found)


def _rise(frequency: np.ndarray, edge: float) -> np.ndarray:
    """From 0 to pi / 2 across an edge."""
    return np.asarray(np.pi / 2 * np.clip((frequency / edge - 1 + OVERLAP) / (2 * OVERLAP), 0, 1))


def traced(filtered_log: FilteredLog, traces: Mapping[str, np.ndarray]) -> dict[int, np.ndarray]:
    """Filter traces of effects.

    Args:
        filtered_log: the filter.
        traces: by residual, `(k, t, columns)`.

    Returns:
        Samples by row, `(k, samples)` each; rows that the traces leave alone are missing.
    """
    found = {}
    for place, row in enumerate(filtered_log.rows):
        if row.residual_name in traces:
            values = traces[row.residual_name][..., row.column]
            if np.any(np.nan_to_num(values) != 0):
                found[place] = filtered_log.sample(place, values)
    return found


STILL, AROUND = 0.06, 0.02
"""Time over which a joint that moves less than its friction takes to turn over may stick, and time
around it that is left out [s]."""
CREEP, ASTRAY = 0.1, 0.5
"""Speed below which friction may be smaller than it is in motion [rad/s], unless the joint follows
its target to this share."""
UNDERWAY = 30.0
"""Way without rest or return from which friction is that of motion, over that on which it turns
over (assumed)."""


def travelled(position: np.ndarray, still: np.ndarray) -> np.ndarray:
    """Compute the way of joints since they last stood still or turned back.

    Args:
        position: [rad], `(t, n)`.
        still: ticks at which each joint stands still, `(t, n)`.

    Returns:
        The way [rad], `(t, n)`.
    """
    step = np.diff(position, axis=0, prepend=position[:1])
    turned = np.zeros_like(still)
    turned[1:] = step[1:] * step[:-1] < 0
    ticks = np.arange(len(position))[:, None]
    last = np.maximum.accumulate(np.where(still | turned, ticks, 0), 0)
    return np.asarray(position - np.take_along_axis(position, last, 0))


def sticking(signals: Signals, underway: float = UNDERWAY) -> np.ndarray:
    """Find the ticks at which a joint may stick, so that its friction is whatever the other torques
    ask for.

    Args:
        signals: a conditioned log.
        underway: way without rest or return from which a slow joint slides, over that on which
            friction turns over; where torques are measured.

    Returns:
        `(t, n)`.
    """
    from scipy.ndimage import maximum_filter1d, minimum_filter1d, uniform_filter1d

    from hyperleg_design.gap.signals.sliding import presliding, shaken

    span = max(round(STILL / signals.step), 2)
    moved = maximum_filter1d(signals.position, span, axis=0) - minimum_filter1d(
        signals.position, span, axis=0
    )
    still = (moved < 2 * presliding(signals)) & ~shaken(signals)
    if signals.target is not None:
        ahead = np.gradient(
            uniform_filter1d(signals.target, span, axis=0, mode="nearest"), signals.step, axis=0
        )
        led = np.abs(signals.velocity - ahead) <= ASTRAY * np.abs(ahead)
        # without a measured torque, whatever a servo's firmware does while it slows down would look
        # like friction
        begun = (
            True
            if signals.measured is None
            else np.abs(travelled(signals.position, still)) < underway * presliding(signals)
        )
        still |= (
            (np.abs(signals.velocity) < CREEP)
            & ~led
            & np.isfinite(ahead)
            & ~shaken(signals)
            & begun
        )
    return np.asarray(
        maximum_filter1d(still.astype(np.uint8), 2 * round(AROUND / signals.step) + 1, axis=0) > 0
    )
