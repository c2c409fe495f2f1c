"""One signal of one log: its residual, by regime and by frequency band."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.model.joint_units import unit_at
from hyperleg_design.gap.playback.regimes import regimes_of
from hyperleg_design.gap.playback.replay import best_input, replay
from hyperleg_design.gap.playback.windows import short_windows
from hyperleg_design.gap.signals.channels import applied
from hyperleg_design.gap.signals.signals import RESIDUALS, Signals, row_names

BAND = 10.0
"""Frequency up to which torque residuals count [Hz] (assumed; joints of legs and arms move below
it)."""
BANDS = ((0.0, 1.0), (1.0, 3.0), (3.0, 10.0), (10.0, 25.0))
"""Frequency bands told apart [Hz]."""
WINDOW = 0.25
"""Length of the predictions that give gaps of position and velocity [s]."""
TORQUE_SIGNALS = {
    residual_name: ("torque" if residual_name == "motion" else residual_name, kind, unit)
    for residual_name, (kind, unit) in RESIDUALS.items()
}
"""Name, kind of place and unit of what each residual shows."""


@dataclass(frozen=True, eq=False)
class Sheet:
    """One signal of one log: residual, the same without what lies above the band, size, and masks
    of regimes.
    """

    signal: str
    kind: str
    units: tuple[str, ...]
    """Unit of the gap at each place."""
    names: tuple[str, ...]
    residual: np.ndarray
    """`(t, k)`, NaN where unknown."""
    floor: np.ndarray
    """Floor of its own split `(k,)`."""
    size: np.ndarray
    regimes: dict[str, np.ndarray]
    """By name `(t, k)` of bool."""
    bands: dict[str, np.ndarray]
    """Residual within frequency bands `(t, k)`."""


def sheets_of(signals: Signals, predict: bool) -> dict[tuple[str, str], Sheet]:
    """Collect the residuals of one log, one sheet a signal and kind of place.

    Args:
        signals: the conditioned log.
        predict: whether short replays give sheets of position and velocity too.

    Returns:
        The sheets by signal and kind of place.
    """
    subject = signals.subject
    loads = {
        "motion": applied(subject.joint_from_motor, signals.believed),
        "drive": signals.measured,
        "control": signals.command,
        "transmission": signals.velocity @ subject.joint_from_motor,
    }
    sheets: list[Sheet] = []
    for residual_name, (signal, kind, unit) in TORQUE_SIGNALS.items():
        if residual_name not in signals.residual:
            continue
        residual = np.where(signals.valid[:, None], signals.residual[residual_name], np.nan)
        names = row_names(subject, residual_name)
        sheets.append(
            _sheet(signals, signal, kind, unit, names, residual, loads.get(residual_name))
        )
        if residual_name == "motion" and not subject.one_to_one:
            at_motors = applied(subject.motor_from_joint, residual)
            sheets.append(
                _sheet(signals, signal, "motor", unit, subject.motors, at_motors, signals.believed)
            )
    if predict and signals.valid.any():
        sheets += _predictions(signals)
    return {(s.signal, s.kind): s for s in sheets}


def _predictions(signals: Signals) -> list[Sheet]:
    """Sheets of the errors of short replays, put back on the ticks that the errors belong to."""
    subject = signals.subject
    try:
        windows = short_windows(signals, WINDOW)
    except InputError:
        return []
    follow = best_input(signals)
    if follow == "torque" and not np.isfinite(signals.believed[signals.valid]).all():
        return []
    predictions = replay(signals, windows=windows, follow=follow).errors(signals)
    sheets, ticks = [], windows.ticks[:, :-1]
    for signal, unit, errors, measured in (
        ("position", "rad", predictions[0][0], signals.position),
        ("velocity", "rad/s", predictions[1][0], signals.velocity),
    ):
        values = np.full(measured.shape, np.nan)
        values[ticks] = errors[:, :-1]
        # what an unknown ground pushes is no gap
        values[~np.isfinite(signals.residual["motion"])] = np.nan
        sheets.append(_sheet(signals, signal, "joint", unit, subject.joints, values, measured))
        if not subject.one_to_one:
            matrix = np.asarray(subject.joint_from_motor)
            values, measured = applied(matrix.T, values), measured @ matrix
            sheets.append(_sheet(signals, signal, "motor", unit, subject.motors, values, measured))
    return sheets


def _sheet(
    signals: Signals,
    signal: str,
    kind: str,
    unit: str,
    names: tuple[str, ...],
    residual: np.ndarray,
    own: np.ndarray | None,
) -> Sheet:
    """Make the sheet of a residual; `own` is the signal itself, with whose size the residual is
    compared.
    """
    predicted = signal in ("position", "velocity")
    units = tuple(unit_at(signals.subject, kind, name, unit) for name in names)
    regimes = regimes_of(signals, kind, names, None if predicted else own)
    size = np.full(len(names), np.nan)
    if own is not None:
        size = root_mean_square(np.where(signals.valid[:, None], own, np.nan))
    if predicted:
        floor = _smoothing_error(signals, signal, kind)
        return Sheet(signal, kind, units, names, residual, floor, size, regimes, {})
    spectrum, frequency, weight = _spectrum(residual, signals.step)
    in_band = _band(spectrum, frequency, 0.0, BAND, residual)
    high = frequency > BAND
    with np.errstate(invalid="ignore", divide="ignore"):
        density = np.mean(np.abs(spectrum[high]) ** 2, 0) if high.any() else np.zeros(len(names))
        floor = np.sqrt(density * 2 * np.sum(frequency <= BAND)) / len(residual) / weight
    bands = {
        f"{low:g}-{top:g} Hz": _band(spectrum, frequency, low, top, residual)
        for low, top in BANDS
        if low < 0.5 / signals.step
    }
    return Sheet(signal, kind, units, names, in_band, np.nan_to_num(floor), size, regimes, bands)


def _smoothing_error(signals: Signals, signal: str, kind: str) -> np.ndarray:
    """Standard deviation of smoothed positions or velocities, at the joints `(n,)` or the motors
    `(m,)`.

    White noise through a low-pass at the crossover keeps omega_c h / pi of its variance, its
    derivative omega_c^2 times that.
    """
    if signals.noise is None or signals.bandwidth is None:
        return np.zeros(len(signals.subject.motors if kind == "motor" else signals.subject.joints))
    crossover = 2 * np.pi * np.nan_to_num(signals.bandwidth)
    error = np.nan_to_num(signals.noise) * np.sqrt(
        np.minimum(crossover * signals.step / np.pi, 1.0)
    )
    if signal == "velocity":
        error = error * crossover
    return np.sqrt(error**2 @ signals.subject.joint_from_motor**2) if kind == "motor" else error


def _spectrum(residual: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Spectrum of a residual with unknown ticks at zero, its frequencies, and the root of the known
    part `(k,)`.
    """
    known = np.isfinite(residual)
    spectrum = np.fft.rfft(np.where(known, residual, 0.0), axis=0)
    return spectrum, np.fft.rfftfreq(len(residual), step), np.sqrt(np.maximum(known.mean(0), 1e-9))


def _band(
    spectrum: np.ndarray, frequency: np.ndarray, low: float, top: float, residual: np.ndarray
) -> np.ndarray:
    """Part of a residual in a band, unknown where the residual is."""
    inside = (frequency >= low) & (frequency < top)
    part = np.fft.irfft(np.where(inside[:, None], spectrum, 0.0), len(residual), axis=0)
    return np.where(np.isfinite(residual), part, np.nan)


def regime_names(group: Sequence[Sheet]) -> list[str]:
    """List the regimes and frequency bands of which some sheets tell, after `all`.

    Args:
        group: the sheets.

    Returns:
        The names, each once.
    """
    names = dict.fromkeys(n for sheet in group for n in (*sheet.regimes, *sheet.bands))
    return ["all", *names]


def regime_values(sheet: Sheet, regime: str) -> np.ndarray:
    """Read the residual of one sheet in one regime or band.

    Args:
        sheet: the sheet.
        regime: its name; `all` for every tick.

    Returns:
        The residual `(t, k)`, NaN outside the regime.
    """
    if regime == "all":
        return sheet.residual
    if regime in sheet.bands:
        return sheet.bands[regime]
    if regime in sheet.regimes:
        return np.where(sheet.regimes[regime], sheet.residual, np.nan)
    return np.full(sheet.residual.shape, np.nan)


def root_mean_square(values: np.ndarray) -> np.ndarray:
    """Compute the root mean square of each column over its known ticks.

    Args:
        values: `(t, k)`, NaN where unknown.

    Returns:
        `(k,)`; NaN where no tick is known.
    """
    known = np.isfinite(values)
    count = known.sum(0)
    total = np.sum(np.where(known, values, 0.0) ** 2, 0)
    return np.where(count > 0, np.sqrt(total / np.maximum(count, 1)), np.nan)
