"""Operations on evenly sampled signals that traces share: delay, first-order lag, second
derivative; NaN stays NaN.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from hyperleg_design.gap.signals.smoothing import bridged


def delayed(values: np.ndarray, delay: np.ndarray, step: float) -> np.ndarray:
    """Signal some time ago, by linear interpolation; before its beginning, its first value.

    Args:
        values: `(t,)`.
        delay: `(k,)` [s], not negative.
        step: of the time base [s].

    Returns:
        `(k, t)`.
    """
    out = np.empty((len(delay), len(values)))
    for row, ticks in enumerate(np.maximum(delay, 0.0) / step):
        whole = min(int(ticks), len(values) - 1)
        part = ticks - whole
        late = np.concatenate([np.full(whole, values[0]), values[: len(values) - whole]])
        if part:
            late = np.concatenate([late[:1], (1 - part) * late[1:] + part * late[:-1]])
        out[row] = late
    return out


def lagged(values: np.ndarray, time_constant: np.ndarray, step: float) -> np.ndarray:
    """Signal after a first-order lag T y' = u - y, exact for a signal that is straight between
    ticks; it starts settled.

    Args:
        values: `(t,)`; unknown ticks are bridged, and unknown in the result.
        time_constant: `(k,)` [s], not negative.
        step: of the time base [s].

    Returns:
        `(k, t)`.
    """
    from scipy.signal import lfilter

    def respond(filled: np.ndarray, lag: float) -> np.ndarray:
        if lag <= 1e-6 * step:
            return filled
        ratio = step / lag
        keep = np.exp(-ratio)
        new = 1 - (1 - keep) / ratio
        old = 1 - keep - new
        settled = filled[0] - new * filled[0]
        return np.asarray(lfilter([new, old], [1.0, -keep], filled, zi=[settled])[0])

    return _responses(values, respond, time_constant)


def swung(
    values: np.ndarray, square: np.ndarray, time_constant: np.ndarray, step: float
) -> np.ndarray:
    """Signal after a mass on a spring, S y'' + T y' + y = u, exact for a signal that is straight
    between ticks; it starts settled.

    Args:
        values: `(t,)`; unknown ticks are bridged, and unknown in the result.
        square: S, of 1 over the circular frequency at which the mass swings `(k,)` [s^2], positive.
        time_constant: T `(k,)` [s], not negative.
        step: of the time base [s].

    Returns:
        `(k, t)`.
    """
    from scipy.signal import cont2discrete, lfilter, lfilter_zi

    def respond(filled: np.ndarray, mass: float, late: float) -> np.ndarray:
        top, bottom, _ = cont2discrete(([1.0], [mass, late, 1.0]), step, method="foh")
        settled = lfilter_zi(top[0], bottom) * filled[0]
        return np.asarray(lfilter(top[0], bottom, filled, zi=settled)[0])

    return _responses(values, respond, square, time_constant)


def _responses(
    values: np.ndarray, respond: Callable[..., np.ndarray], *parameters: np.ndarray
) -> np.ndarray:
    """Responses to a signal `(t,)`, one for each value of some parameters `(k,)`, `(k, t)`."""
    known = np.isfinite(values)
    out = np.full((len(parameters[0]), len(values)), np.nan)
    if known.any():
        filled = bridged(values)
        for row, own in enumerate(zip(*(each.tolist() for each in parameters), strict=True)):
            out[row] = respond(filled, *own)
        out[:, ~known] = np.nan
    return out


def band_limited(values: np.ndarray, step: float, cutoff: float) -> np.ndarray:
    """Signal `(t,)` without what lies above a frequency [Hz], no delay; unknown ticks are
    bridged.

    Args:
        values: `(t,)`, NaN where unknown.
        step: between ticks [s].
        cutoff: the frequency [Hz].

    Returns:
        The filtered signal `(t,)`.
    """
    if not np.isfinite(values).any():
        return values
    return low_passed(bridged(values), step, cutoff, 100)


def low_passed(values: np.ndarray, step: float, cutoff: float, padding: int = 60) -> np.ndarray:
    """Filter signals forwards and backwards with a Butterworth filter of second order.

    Args:
        values: `(..., t)`.
        step: between ticks [s].
        cutoff: frequency above which little passes [Hz].
        padding: ticks by which signals are continued at their ends.

    Returns:
        `(..., t)`; the signals as they are, where they are too short or too slow for the filter.
    """
    from scipy.signal import butter, sosfiltfilt

    count = values.shape[-1]
    if cutoff >= 0.45 / step or count < 20:
        return values
    sections = butter(2, cutoff, fs=1 / step, output="sos")
    return np.asarray(sosfiltfilt(sections, values, padlen=min(count - 1, padding)))


def second_derivative(values: np.ndarray, step: float) -> np.ndarray:
    """Central second difference along the last axis `(..., t)`; its ends repeat their
    neighbours.

    Args:
        values: `(..., t)`.
        step: between ticks [s].

    Returns:
        The derivative `(..., t)`.
    """
    out = np.empty_like(values)
    out[..., 1:-1] = (values[..., 2:] - 2 * values[..., 1:-1] + values[..., :-2]) / step**2
    out[..., 0], out[..., -1] = out[..., 1], out[..., -2]
    return out


def first_derivative(values: np.ndarray, step: float) -> np.ndarray:
    """Central difference along the last axis `(..., t)`.

    Args:
        values: `(..., t)`.
        step: between ticks [s].

    Returns:
        The derivative `(..., t)`.
    """
    return np.asarray(np.gradient(values, step, axis=-1))
