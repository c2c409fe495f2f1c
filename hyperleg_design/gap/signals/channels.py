"""Signals of a log as arrays: collected under any of the motors' names, interpolated onto even
ticks, and multiplied by matrices so that unknown values (NaN) stay unknown.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.subject import Subject

GAP = 2.5
"""Ticks between two samples from which there is a gap."""


def applied(matrix: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Multiply rows by a matrix so that the result is NaN only where something unknown is really
    needed.

    Args:
        matrix: `(l, k)`.
        values: `(t, k)`, NaN where unknown.

    Returns:
        `(t, l)`.
    """
    unknown = ~np.isfinite(values)
    if not unknown.any():
        return np.asarray(values @ matrix.T)
    product = np.where(unknown, 0.0, values) @ matrix.T
    product[(unknown.astype(float) @ np.abs(matrix).T) > 0] = np.nan
    return np.asarray(product)


def of_motors(log: Log, kind: str, subject: Subject) -> np.ndarray:
    """Collect a signal of the motors, under their names or those of their actuators, on the
    subject's side of gears.

    Args:
        log: the log.
        kind: such as `motor_torque`.
        subject: the robot.

    Returns:
        `(s, m)`; NaN where unknown.
    """
    own = log.stack(kind, subject.motors)
    if subject.motor_aliases != subject.motors:
        own = np.where(np.isfinite(own), own, log.stack(kind, subject.motor_aliases))
    return own * subject.motor_scale[kind] if kind in subject.motor_scale else own


def held(values: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Hold channels at their last known values.

    Args:
        values: `(t, k)`, NaN where unknown.
        start: what holds before a channel is first known, `(k,)`.

    Returns:
        `(t, k)`.
    """
    known = np.isfinite(values)
    latest = np.maximum.accumulate(np.where(known, np.arange(len(values))[:, None], 0), 0)
    values = np.take_along_axis(values, latest, 0)
    return np.where(np.isfinite(values), values, start)


def resampled(time: np.ndarray, values: np.ndarray, ticks: np.ndarray) -> np.ndarray:
    """Interpolate channels to ticks.

    Args:
        time: of the rows [s], `(s,)`.
        values: `(s, k)`.
        ticks: [s], `(t,)`.

    Returns:
        `(t, k)`; NaN where a channel is unknown for more than `GAP` of its own steps.
    """
    on_ticks = np.full((len(ticks), values.shape[1]), np.nan)
    for column in range(values.shape[1]):
        known = np.isfinite(values[:, column])
        if known.sum() < 2:
            continue
        at = time[known]
        interpolated = np.interp(ticks, at, values[known, column])
        reach = GAP * float(np.median(np.diff(at)))
        after = np.clip(np.searchsorted(at, ticks), 0, len(at) - 1)
        before = np.clip(after - 1, 0, len(at) - 1)
        near = np.minimum(np.abs(at[after] - ticks), np.abs(ticks - at[before]))
        on_ticks[:, column] = np.where(near <= reach / 2, interpolated, np.nan)
    return on_ticks


def resampled_or_none(time: np.ndarray, values: np.ndarray, ticks: np.ndarray) -> np.ndarray | None:
    """Interpolate channels to ticks, as `resampled` does.

    Args:
        time: of the rows [s], `(s,)`.
        values: `(s, k)`.
        ticks: [s], `(t,)`.

    Returns:
        `(t, k)`; None where nothing is known.
    """
    return resampled(time, values, ticks) if np.isfinite(values).any() else None
