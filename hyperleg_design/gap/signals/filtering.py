"""One zero-phase filter for residuals and traces: each row is cut into frequency bands, and each
band is sampled at about twice its upper frequency.

Bands overlap smoothly. Their squared gains add up to 1 below a row's cutoff, so that the mean
squares of all bands add up to that of the filtered row. The filter is linear, unknown ticks count
as zero, and residuals and traces pass the same filter, so it changes no size that is fitted. In a
band [a, b] a row of duration T holds 2 (b - a) T independent numbers. A band has more samples than
that, so each counts for its `share`. Noise that is coloured over all bands is nearly white
within one.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.signals.resting import moving, rubbing
from hyperleg_design.gap.signals.signals import OF_SENSORS, Signals, row_names

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
"""Cutoff over the same frequency, of logged speeds that are compared with smoothed ones [-]: there
the smoother passes 98 %."""
WITHOUT_BANDWIDTH = 10.0
"""Cutoff of joints whose smoother's bandwidth is unknown [Hz]."""
WITHOUT_JOINTS = {"base": 10.0, "ground": 20.0, "gyro": 1.0, "accelerometer": 1.0}
"""Cutoff of residuals whose rows are no joints [Hz]; errors of an IMU hardly change, so that one
band holds them."""
OVERLAP = 0.15
"""Half width of the transition between bands, over its frequency."""
KNOWN = 0.7
"""Share of known ticks around a sample from which it counts."""
FEWEST = 40
"""Known ticks of a row below which it is left out."""


@dataclass(frozen=True)
class Row:
    """One row of a residual, and the frequencies at which it counts."""

    residual_name: str
    """Name of the residual, such as `motion`."""
    column: int
    """Index of the row in its residual."""
    name: str
    """Joint, motor, foot and axis, or axis of the base."""
    cutoff: float
    """Frequency above which the row holds noise only [Hz]."""


def place_of(rows: Sequence[Row], residual_name: str, column: int) -> int | None:
    """Find a row of a residual among some rows.

    Args:
        rows: of one log, or of all.
        residual_name: name of the residual, such as `motion`.
        column: index of the row in its residual.

    Returns:
        Its place; None where it is not among them.
    """
    keys = [(row.residual_name, row.column) for row in rows]
    key = residual_name, column
    return keys.index(key) if key in keys else None


@dataclass(frozen=True, eq=False)
class Band:
    """The coefficients of one row in one band of frequencies."""

    index: int
    low: float
    high: float
    """Lower and upper end of the band [Hz]."""
    bins: slice
    gain: np.ndarray
    count: int
    """Samples over the whole transform."""
    length: int
    """Ticks of the whole transform."""
    used: np.ndarray
    """Which samples count."""


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
    """Bands of each row."""
    length: int
    """Number of ticks of the Fourier transforms."""

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
            parts.append(irfft(cut, band.count, axis=-1)[:, band.used] * (band.count / self.length))
        return np.concatenate(parts, -1) if parts else np.zeros((len(values), 0))

    def count(self, row: int) -> int:
        """Count the samples of a row.

        Args:
            row: its index.

        Returns:
            The count.
        """
        return sum(len(band.used) for band in self.bands[row])

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
        parts = [(np.zeros(0, int), np.zeros(0), np.zeros(0))]
        for b in self.bands[row]:
            numbers = 2 * min(b.high - b.low, WIDEST) * span / b.count
            index, count = np.full(len(b.used), b.index), np.full(len(b.used), numbers)
            parts.append((index, b.used * (span / b.count), count))
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

    rows, masks, rubs = [], [], rubbing(signals).tolist()
    rubbed = _joints_that_rub(signals)
    for residual_name, residual in sorted(signals.residual.items()):
        for column in range(residual.shape[1]):
            mask = signals.valid & np.isfinite(residual[:, column])
            joint = rubbed.get((residual_name, column))
            if joint is not None and resting is not None:
                mask = moving(mask, resting[:, joint], signals.step, rubs=rubs[joint])
            if mask.sum() < FEWEST:
                continue
            name = row_names(signals.subject, residual_name)[column]
            cutoff = _cutoff(signals, residual_name, column)
            rows.append(Row(residual_name, column, name, cutoff))
            masks.append(mask)
    length = next_fast_len(len(signals.time), real=True)
    bands = [_bands(row, mask, length, signals.step) for row, mask in zip(rows, masks, strict=True)]
    shown = [row for row, own in enumerate(bands) if any(len(band.used) for band in own)]
    return FilteredLog(
        signals,
        tuple(rows[row] for row in shown),
        np.array([masks[row] for row in shown]).reshape(len(shown), len(signals.time)),
        tuple(bands[row] for row in shown),
        length,
    )


def _joints_that_rub(signals: Signals) -> dict[tuple[str, int], int]:
    """Joints whose friction each row of a residual holds: its own, or, before a torque sensor
    behind the gear, the joint that a motor moves most.
    """
    behind = signals.behind_gears
    if behind is None:
        return {("motion", joint): joint for joint in range(len(signals.subject.joints))}
    own = {("motion", joint): joint for joint in np.flatnonzero(~behind).tolist()}
    sensed = np.flatnonzero(signals.sensed_behind).tolist()
    return own | {("drive", motor): signals.subject.main_joint(motor) for motor in sensed}


def _cutoff(signals: Signals, residual_name: str, column: int) -> float:
    most = OF_RATE / signals.step
    if residual_name in WITHOUT_JOINTS:
        return min(WITHOUT_JOINTS[residual_name], most)
    if residual_name not in ("motion", "transmission"):
        return min(HIGHEST, most)
    joints, share = np.array([column]), OF_BANDWIDTH
    if residual_name == "transmission":
        joints = np.flatnonzero(signals.subject.joint_from_motor[:, column])
        share = OF_SPEEDS
    bandwidth = np.nan
    if signals.bandwidth is not None:
        bandwidth = float(np.min(signals.bandwidth[joints], initial=np.inf))
    if not np.isfinite(bandwidth):
        return min(WITHOUT_BANDWIDTH, most)
    return min(HIGHEST, share * bandwidth, most)


def _bands(row: Row, mask: np.ndarray, length: int, step: float) -> tuple[Band, ...]:
    from scipy.fft import next_fast_len

    span = length * step
    inner = () if row.residual_name in OF_SENSORS else EDGES
    edges = [0.0, *(e for e in inner if e < 0.8 * row.cutoff), row.cutoff]
    total = np.concatenate([[0], np.cumsum(mask)])
    bands = []
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
        counted_samples = np.flatnonzero((near >= KNOWN) & (place < len(mask)))
        bands.append(
            Band(
                index, low, high, slice(first, last + 1), gain, int(count), length, counted_samples
            )
        )
    return tuple(bands)


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
    samples, traces = {}, filtered_log.signals.shown(traces)
    shown = {n: ((x != 0) & np.isfinite(x)).any((0, 1)) for n, x in traces.items()}
    for place, row in enumerate(filtered_log.rows):
        if row.residual_name in traces and shown[row.residual_name][row.column]:
            values = traces[row.residual_name][..., row.column]
            samples[place] = filtered_log.sample(place, values)
    return samples
