"""Position, velocity and acceleration from noisy samples, without delay: a smoothing spline whose
noise the samples tell.

The spline minimises, over quintic splines p,

    sum (y_i - p(t_i))^2 / s_p^2 + sum (w_i - p'(t_i))^2 / s_v^2 + 1/Q integral p'''(t)^2 dt,

which is the fixed-interval (Rauch-Tung-Striebel) smoother of a joint whose jerk is white noise of
density Q: it looks both ways in time, so nothing is late. In frequency it passes 1 / (1 + (omega /
omega_c)^6) with the crossover Q = s_p^2 h omega_c^6, where h is the time between samples. Noise and
crossover are those of largest likelihood (Whittle's) given the periodogram of the log itself,
modelled as s_p^2 (1 + (omega_c / omega)^6) or steeper: quantisation, sensor noise and bandwidth
need not be declared.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

KNOTS_PER_RADIAN = 2.0
"""Knots in a radian of the crossover: a spline this dense follows all that the crossover lets
pass."""
LOWEST_CROSSOVER = 1.0
"""Lowest crossover [Hz]: below it a log would say nothing about accelerations; assumed."""
CROSSOVERS = 48
"""Crossovers tried, spaced evenly in their logarithm."""
STEEPER = (0, 1, 3)
"""Further integrations of white noise that are tried as the signal's spectrum."""
BEYOND = 1.5
"""Crossover of the spline over that of a steeper spectrum, so that it still passes all but a
thousandth of what lies below half."""
MOST_PER_SAMPLE = 0.9
"""Highest crossover over the Nyquist frequency: above it, samples are interpolated."""
CONSISTENT = 0.03
"""Largest difference between a logged velocity and the derivative of the logged position, over its
size, at which the logged one is believed; filtered or late velocities differ by more."""
LATEST = 0.01
"""By how much a logged velocity is late at most, or early [s] (assumed)."""


@dataclass(frozen=True)
class Noise:
    """What one channel's samples tell of their noise."""

    level: float
    """Standard deviation of a sample."""
    crossover: float
    """Angular frequency at which signal and noise are equal [rad/s]."""


@dataclass(frozen=True, eq=False)
class Smooth:
    """Of `n` channels on `t` ticks."""

    value: np.ndarray
    first: np.ndarray
    second: np.ndarray
    """`(t, n)` each: value, first and second derivative."""
    crossover: np.ndarray
    """Crossover frequency of the smoother of each joint `(n,)` [rad/s]."""
    level: np.ndarray
    """Standard deviation of the samples' noise `(n,)`."""


def smooth(
    time: np.ndarray, value: np.ndarray, ticks: np.ndarray, rate: np.ndarray | None = None
) -> Smooth:
    """Smooth channels sampled at any rising times.

    Args:
        time: of the samples `(s,)` [s].
        value: `(s, n)`, NaN where unknown.
        ticks: evenly spaced, where the result is wanted `(t,)` [s].
        rate: logged first derivatives `(s, n)`, NaN where unknown; used where they agree with the
            values.

    Returns:
        NaN for channels with fewer than 8 samples.
    """
    count = value.shape[1]
    tables = [np.full((len(ticks), count), np.nan) for _ in range(3)]
    out = Smooth(tables[0], tables[1], tables[2], np.full(count, np.nan), np.full(count, np.nan))
    step = float(np.median(np.diff(time)))
    for channel in range(count):
        known = np.isfinite(value[:, channel])
        if known.sum() < 8:
            continue
        at, samples = time[known], value[known, channel]
        noise = estimate_noise(at, samples, step, order=3)
        jerk = noise.level**2 * step * noise.crossover**6
        fitted = _fit(at, samples, ticks, noise.crossover, jerk / max(noise.level**2, 1e-300))
        if rate is not None:
            fitted, noise = _with_rate(
                time, value[:, channel], rate[:, channel], ticks, step, noise, jerk, fitted
            )
        out.value[:, channel], out.first[:, channel], out.second[:, channel] = fitted
        out.crossover[channel], out.level[channel] = noise.crossover, noise.level
    return out


def _with_rate(
    time: np.ndarray,
    value: np.ndarray,
    rate: np.ndarray,
    ticks: np.ndarray,
    step: float,
    noise: Noise,
    jerk: float,
    fitted: np.ndarray,
) -> tuple[np.ndarray, Noise]:
    """Fit with logged derivatives too, where they are there and agree."""
    known = np.isfinite(rate)
    if known.sum() < 8:
        return fitted, noise
    of_rate = estimate_noise(time[known], rate[known], step, order=2)
    slow = min(noise.crossover, of_rate.crossover)
    compared = _fit(time[known], rate[known], ticks, slow, slow**6 * step)[0]
    error = noise.level * noise.crossover * np.sqrt(noise.crossover * step / np.pi)
    size = float(np.sqrt(np.mean(fitted[1] ** 2)))
    if not np.sqrt(np.mean((compared - fitted[1]) ** 2)) < max(CONSISTENT * size, 2 * error):
        return fitted, noise
    late = lateness(compared - fitted[1], fitted[2])
    jerk_of_rate = of_rate.level**2 * step * of_rate.crossover**4
    if of_rate.crossover > noise.crossover:
        jerk = jerk_of_rate
    weight = (noise.level / max(of_rate.level, 1e-12 * noise.level, 1e-300)) ** 2
    crossover = _joint_crossover(
        jerk, noise.level**2 * step, weight, np.pi / step * MOST_PER_SAMPLE
    )
    both = np.isfinite(value)
    smooth, rates = jerk / max(noise.level**2, 1e-300), (time[known] - late, rate[known], weight)
    fitted = _fit(time[both], value[both], ticks, crossover, smooth, rates)
    return fitted, Noise(noise.level, crossover)


def lateness(beyond: np.ndarray, second: np.ndarray) -> float:
    """Compute how much later a logged derivative is than its log states: drives filter and
    difference, simulators step speeds before places.

    Args:
        beyond: logged derivative minus the derivative of the values, `(t,)`.
        second: second derivative of the values, `(t,)`.

    Returns:
        The lateness [s].
    """
    return float(np.clip(-(beyond @ second) / max(float(second @ second), 1e-300), -LATEST, LATEST))


def _joint_crossover(jerk: float, density: float, weight: float, most: float) -> float:
    """Where signal equals noise when value and derivative are both measured: omega^6 / Q = (1 +
    weight omega^2) / density.
    """
    low, high = 1e-3, most
    for _ in range(60):
        middle = np.sqrt(low * high)
        if middle**6 * density < jerk * (1 + weight * middle**2):
            low = middle
        else:
            high = middle
    return float(low)


def bridged(values: np.ndarray) -> np.ndarray:
    """Bridge the unknown ticks of a signal by straight lines; at least one tick must be known.

    Args:
        values: `(t,)`, NaN where unknown.

    Returns:
        `(t,)`.
    """
    known = np.isfinite(values)
    ticks = np.arange(len(values))
    return values if known.all() else np.interp(ticks, ticks[known], values[known])


def estimate_noise(time: np.ndarray, samples: np.ndarray, step: float, order: int) -> Noise:
    """Estimate noise and crossover of the largest Whittle likelihood.

    Args:
        time: of the samples `(s,)`.
        samples: `(s,)`.
        step: median time between them [s].
        order: how many times white noise is integrated to give the signal: spectrum omega^(-2
            order).

    Returns:
        The noise.
    """
    even = np.arange(time[0], time[-1] + step / 2, step)
    signal = np.interp(even, time, samples)
    length = len(signal)
    line = np.linspace(-1, 1, length)
    signal = signal - np.polynomial.polynomial.polyval(
        line, np.polynomial.polynomial.polyfit(line, signal, 3)
    )
    # A window whose side lobes fall faster than the signal's own spectrum, so that none of it leaks
    # into the noise.
    window = np.sin(np.pi * (np.arange(length) + 0.5) / length) ** 4
    power = np.abs(np.fft.rfft(signal * window)) ** 2 / np.sum(window**2)
    omega = 2 * np.pi * np.fft.rfftfreq(length, step)
    nyquist = np.pi / step
    use = slice(max(5, length // 2000), len(omega) - 1)
    power, omega = power[use] + 1e-30 * max(float(np.max(power)), 1e-200), omega[use]
    if len(omega) < 4:
        return Noise(float(np.std(samples)), MOST_PER_SAMPLE * nyquist)
    lowest = min(2 * np.pi * LOWEST_CROSSOVER, 0.3 * nyquist)
    crossovers = np.geomspace(lowest, MOST_PER_SAMPLE * nyquist, CROSSOVERS)
    best, noise = -np.inf, Noise(float(np.std(samples)), float(crossovers[-1]))
    # commanded motion ends in a band of its own, more steeply than white jerk
    for steeper in STEEPER:
        shape = 1 + (crossovers[:, None] / omega) ** (2 * (order + steeper))
        level = np.mean(power / shape, 1)
        likelihood = -np.sum(np.log(shape), 1) - len(omega) * np.log(level)
        top = int(np.argmax(likelihood))
        if likelihood[top] > best:
            beyond = 1.0 if steeper == 0 else BEYOND
            best = float(likelihood[top])
            noise = Noise(
                float(np.sqrt(level[top])),
                min(beyond * float(crossovers[top]), float(crossovers[-1])),
            )
    return noise


def _fit(
    time: np.ndarray,
    samples: np.ndarray,
    ticks: np.ndarray,
    crossover: float,
    jerk: float,
    rate: tuple[np.ndarray, np.ndarray, float] | None = None,
) -> np.ndarray:
    """Value and two derivatives at the ticks `(3, t)`; `jerk` is Q over the variance of a
    sample.
    """
    from scipy.linalg import solveh_banded

    first, last = min(time[0], ticks[0]), max(time[-1], ticks[-1])
    step = (ticks[-1] - ticks[0]) / max(len(ticks) - 1, 1)
    spacing = max(step, 1 / (KNOTS_PER_RADIAN * crossover))
    cells = max(int(np.ceil((last - first) / spacing - 1e-9)), 1)
    spacing = (last - first) / cells
    size = cells + 5
    scale = max(float(np.ptp(samples)), 1e-12)
    offset = float(np.mean(samples))
    cell, basis = _basis((time - first) / spacing, cells, 0)
    band = np.zeros((6, size))
    right = np.zeros(size)
    _add_rows(band, right, cell, basis, (samples - offset) / scale, 1.0)
    if rate is not None:
        cell, basis = _basis((rate[0] - first) / spacing, cells, 1)
        _add_rows(band, right, cell, basis / spacing, rate[1] / scale, rate[2])
    penalty = _jerk_penalty() / (jerk * spacing**5)
    for i in range(6):
        for j in range(i, 6):
            band[5 - (j - i), j : j + cells] += penalty[i, j]
    # A trace of stiffness keeps coefficients that no sample reaches finite.
    band[5] += 1e-13 * np.max(band[5])
    coefficients = solveh_banded(band, right)
    out = np.empty((3, len(ticks)))
    for order in range(3):
        cell, basis = _basis((ticks - first) / spacing, cells, order)
        out[order] = (
            scale * np.sum(basis * coefficients[cell[:, None] + np.arange(6)], 1) / spacing**order
        )
    out[0] += offset
    return out


def _add_rows(
    band: np.ndarray,
    right: np.ndarray,
    cell: np.ndarray,
    basis: np.ndarray,
    samples: np.ndarray,
    weight: float,
) -> None:
    size = band.shape[1]
    for i in range(6):
        right += weight * np.bincount(cell + i, basis[:, i] * samples, size)
        for j in range(i, 6):
            band[5 - (j - i)] += weight * np.bincount(cell + j, basis[:, i] * basis[:, j], size)


def _basis(place: np.ndarray, cells: int, order: int) -> tuple[np.ndarray, np.ndarray]:
    """Cell of each place and the values of the six quintic B-splines, or of their derivatives,
    there `(k, 6)`.
    """
    cell = np.clip(np.floor(place).astype(int), 0, cells - 1)
    inside = place - cell
    powers = _cell_polynomials(order)
    return cell, np.stack([np.polyval(p, inside) for p in powers], -1)


@cache
def _cell_polynomials(order: int) -> tuple[np.ndarray, ...]:
    """The six pieces of the uniform quintic B-spline within one cell, differentiated `order` times,
    highest power first.
    """
    from math import comb, factorial

    pieces = []
    for piece in range(6):
        # B(x) = 1/5! sum_k (-1)^k C(6, k) (x - k)_+^5, on x = 5 - piece + u.
        total = np.zeros(6)
        start = 5 - piece
        for k in range(start + 1):
            total += (
                (-1) ** k
                * comb(6, k)
                / factorial(5)
                * np.array([comb(5, p) * float(start - k) ** (5 - p) for p in range(5, -1, -1)])
            )
        pieces.append(np.polyder(total, order) if order else total)
    return tuple(pieces)


@cache
def _jerk_penalty() -> np.ndarray:
    """Integrals over a cell of products of third derivatives of the six splines `(6, 6)`."""
    pieces = _cell_polynomials(3)
    out = np.empty((6, 6))
    for i in range(6):
        for j in range(6):
            out[i, j] = np.polyval(np.polyint(np.polymul(pieces[i], pieces[j])), 1.0)
    return out
