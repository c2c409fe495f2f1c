"""How large the gap is, and where: by signal, joint, motor and regime, against the repeatability
floor.

Torque residuals count below `BAND` only: above it, noise of sensors and of differentiation
outweighs what a model can explain. At the motors, torques are those of the controller's map from
joints to motors, angles those of the transposed `joint_from_motor`. The floor, the size that a
residual has when nothing is wrong, comes from reference logs; else from pairs of test logs with the
same targets (half of the variance of their difference); else from the smooth-against-noisy split:
of torques the residual's own level above `BAND`, taken as white, of positions and velocities the
smoother's own error.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, fields

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.playback.replay import best_input, replay, short_windows
from hyperleg_design.gap.signals.channels import applied
from hyperleg_design.gap.signals.signals import RESIDUALS, Signals

BAND = 10.0
"""[Hz] Up to which torque residuals count (assumed; joints of legs and arms move below it)."""
BANDS = ((0.0, 1.0), (1.0, 3.0), (3.0, 10.0), (10.0, 25.0))
"""Frequency bands told apart [Hz]."""
STILL = 0.05
"""Speed below which a joint stands still [rad/s]; assumed, some times what a position sensor
resolves."""
REVERSAL = 0.1
"""[s] Around a change of direction; assumed, in which presliding and play show."""
SAME_TARGET = 0.002
"""Root-mean-square difference of targets up to which two logs are repeats [rad]."""
WINDOW = 0.25
"""Of the predictions that give gaps of position and velocity [s]."""
TORQUE_SIGNALS = {
    residual_name: ("torque" if residual_name == "motion" else residual_name, *told)
    for residual_name, told in RESIDUALS.items()
}
"""Name, kind of place and unit of what each residual shows."""


@dataclass(frozen=True)
class Row:
    """One line of the table."""

    signal: str
    """`torque`, `drive`, `control`, `transmission`, `base`, `ground`, `position` or `velocity`."""
    unit: str
    kind: str
    """`joint`, `motor`, `foot` or `robot`."""
    location: str
    regime: str
    """`all`, or what the joint, motor or foot was doing."""
    gap: float
    """Root mean square of the residual in this regime."""
    floor: float
    """What it would be if nothing were wrong."""
    mean: float
    """Mean of the residual: what is lasting in it."""
    share: float
    """Of the squared excess over the floor of this signal at all places, what this place has; in a
    regime, of this place's."""
    size: float
    """Root mean square of the signal itself, where that means something; NaN else."""
    ticks: int

    @property
    def excess(self) -> float:
        """Root of the squared gap above the squared floor."""
        return float(np.sqrt(max(self.gap**2 - self.floor**2, 0.0)))


@dataclass(frozen=True)
class Gap:
    """Gap of a set of logs."""

    rows: tuple[Row, ...]
    floor_from: str
    """`reference`, `repeats` or `split`: where the floor comes from."""
    notes: tuple[str, ...] = ()

    def table(self) -> dict[str, list[object]]:
        """Tabulate the gap.

        Returns:
            Columns by name, excess included.
        """
        names = [f.name for f in fields(Row)]
        return {
            **{n: [getattr(r, n) for r in self.rows] for n in names},
            "excess": [r.excess for r in self.rows],
        }

    def mapping(self) -> dict[str, object]:
        """Write the gap as JSON takes it.

        Returns:
            Nested mappings; what is unknown is None.
        """
        rows = [
            {
                k: None if isinstance(v, float) and not np.isfinite(v) else v
                for k, v in asdict(r).items()
            }
            for r in self.rows
        ]
        return {"floor_from": self.floor_from, "notes": list(self.notes), "rows": rows}

    def select(
        self, signal: str = "", kind: str = "", location: str = "", regime: str = "all"
    ) -> tuple[Row, ...]:
        """Select rows; an empty text stands for any.

        Args:
            signal: such as `position`.
            kind: of place, such as `joint`.
            location: such as `knee`.
            regime: such as `all`.

        Returns:
            The rows.
        """
        wanted = {"signal": signal, "kind": kind, "location": location, "regime": regime}
        return tuple(
            r for r in self.rows if all(not v or getattr(r, k) == v for k, v in wanted.items())
        )


@dataclass(frozen=True, eq=False)
class _Sheet:
    """One signal of one log: residual, the same without what lies above the band, size, and masks
    of regimes.
    """

    signal: str
    kind: str
    unit: str
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


def measure(
    signals: Sequence[Signals],
    reference: Sequence[Signals] = (),
    *,
    predict: bool = True,
    threads: int = 1,
) -> Gap:
    """Measure the gap of logs, in every signal that they allow.

    Args:
        signals: conditioned logs of one robot.
        reference: conditioned logs of the same robot when all was well.
        predict: also gaps of position and velocity, from short replays.
        threads: of MuJoCo.

    Returns:
        The rows of the gap, and where its noise floor comes from.

    Raises:
        InputError: no log.
    """
    if not signals:
        raise InputError("measure", "logs", None, "are missing: give at least one log")
    sheets = [_sheets(s, predict, threads) for s in signals]
    floors, origin = _floors(signals, sheets, [_sheets(s, predict, threads) for s in reference])
    rows: list[Row] = []
    for key in dict.fromkeys(k for each in sheets for k in each):
        rows += _rows([each[key] for each in sheets if key in each], floors)
    notes = dict.fromkeys(f"{s.log.name}: {note}" for s in signals for note in s.notes)
    return Gap(tuple(rows), origin, tuple(notes))


def _sheets(signals: Signals, predict: bool, threads: int) -> dict[tuple[str, str], _Sheet]:
    subject = signals.subject
    made: list[_Sheet] = []
    valid = signals.valid[:, None]
    for residual_name, (signal, kind, unit) in TORQUE_SIGNALS.items():
        if residual_name not in signals.residual:
            continue
        residual = np.where(valid, signals.residual[residual_name], np.nan)
        if residual_name == "motion":
            believed = applied(subject.joint_from_motor, signals.believed)
            made.append(
                _sheet(
                    signals,
                    signal,
                    "joint",
                    unit,
                    subject.joints,
                    residual,
                    believed,
                    signals.position,
                    signals.velocity,
                )
            )
            if not subject.one_to_one:
                at_motors = applied(subject.motor_from_joint, residual)
                made.append(_motor_sheet(signals, signal, unit, at_motors, signals.believed))
        elif residual_name == "drive":
            assert signals.measured is not None
            made.append(_motor_sheet(signals, signal, unit, residual, signals.measured))
        elif residual_name == "control":
            assert signals.command is not None
            made.append(_motor_sheet(signals, signal, unit, residual, signals.command))
        elif residual_name == "transmission":
            made.append(
                _motor_sheet(
                    signals, signal, unit, residual, signals.velocity @ subject.joint_from_motor
                )
            )
        else:
            names: tuple[str, ...] = (
                "force_x",
                "force_y",
                "force_z",
                "moment_x",
                "moment_y",
                "moment_z",
            )
            if residual_name == "ground":
                names = tuple(f"{foot}_{axis}" for foot in subject.feet for axis in "xyz")
            made.append(_sheet(signals, signal, kind, unit, names, residual, None, None, None))
    if predict and signals.valid.any():
        made += _predictions(signals, threads)
    return {(s.signal, s.kind): s for s in made}


def _motor_sheet(
    signals: Signals, signal: str, unit: str, residual: np.ndarray, size: np.ndarray
) -> _Sheet:
    matrix = signals.subject.joint_from_motor
    return _sheet(
        signals,
        signal,
        "motor",
        unit,
        signals.subject.motors,
        residual,
        size,
        signals.position @ matrix,
        signals.velocity @ matrix,
    )


def _predictions(signals: Signals, threads: int) -> list[_Sheet]:
    """Errors of short predictions, put back on the ticks that they belong to."""
    subject = signals.subject
    try:
        windows = short_windows(signals, WINDOW)
    except InputError:
        return []
    follow = best_input(signals)
    if follow == "torque" and not np.isfinite(signals.believed[signals.valid]).all():
        return []
    found = replay(signals, windows=windows, follow=follow, threads=threads).errors(signals)
    made, ticks = [], windows.ticks[:, :-1]
    for signal, unit, errors in (
        ("position", "rad", found[0][0]),
        ("velocity", "rad/s", found[1][0]),
    ):
        values = np.full(signals.position.shape, np.nan)
        values[ticks] = errors[:, :-1]
        values[~np.isfinite(signals.residual["motion"])] = (
            np.nan
        )  # what an unknown ground pushes is no gap
        own = signals.position if signal == "position" else signals.velocity
        made.append(
            _sheet(
                signals,
                signal,
                "joint",
                unit,
                subject.joints,
                values,
                own,
                signals.position,
                signals.velocity,
                banded=False,
            )
        )
        if not subject.one_to_one:
            matrix = np.asarray(subject.joint_from_motor)
            at_motors, position = applied(matrix.T, values), signals.position @ matrix
            made.append(
                _sheet(
                    signals,
                    signal,
                    "motor",
                    unit,
                    subject.motors,
                    at_motors,
                    own @ matrix,
                    position,
                    signals.velocity @ matrix,
                    banded=False,
                )
            )
    return made


def _sheet(
    signals: Signals,
    signal: str,
    kind: str,
    unit: str,
    names: tuple[str, ...],
    residual: np.ndarray,
    load: np.ndarray | None,
    position: np.ndarray | None,
    velocity: np.ndarray | None,
    banded: bool = True,
) -> _Sheet:
    regimes = _regimes(
        signals,
        kind,
        names,
        load if signal not in ("position", "velocity") else None,
        position,
        velocity,
    )
    size = (
        np.full(len(names), np.nan)
        if load is None
        else _rms(np.where(signals.valid[:, None], load, np.nan))
    )
    if not banded:
        return _Sheet(
            signal,
            kind,
            unit,
            names,
            residual,
            _smoothing_error(signals, signal, kind),
            size,
            regimes,
            {},
        )
    spectrum, frequency, weight = _spectrum(residual, signals.step)
    kept = _band(spectrum, frequency, weight, 0.0, BAND, residual)
    high = frequency > BAND
    with np.errstate(invalid="ignore", divide="ignore"):
        density = np.mean(np.abs(spectrum[high]) ** 2, 0) if high.any() else np.zeros(len(names))
        floor = np.sqrt(density * 2 * np.sum(frequency <= BAND)) / len(residual) / weight
    bands = {
        f"{low:g}-{top:g} Hz": _band(spectrum, frequency, weight, low, top, residual)
        for low, top in BANDS
        if low < 0.5 / signals.step
    }
    return _Sheet(signal, kind, unit, names, kept, np.nan_to_num(floor), size, regimes, bands)


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
    spectrum: np.ndarray,
    frequency: np.ndarray,
    weight: np.ndarray,
    low: float,
    top: float,
    residual: np.ndarray,
) -> np.ndarray:
    """Part of a residual in a band, unknown where the residual is."""
    inside = (frequency >= low) & (frequency < top)
    part = np.fft.irfft(np.where(inside[:, None], spectrum, 0.0), len(residual), axis=0)
    return np.where(np.isfinite(residual), part, np.nan)


def _regimes(
    signals: Signals,
    kind: str,
    names: tuple[str, ...],
    load: np.ndarray | None,
    position: np.ndarray | None,
    velocity: np.ndarray | None,
) -> dict[str, np.ndarray]:
    """What each joint, motor or foot does at each tick `(t, k)`, by regime."""
    shape = (len(signals.time), len(names))
    found: dict[str, np.ndarray] = {}
    if velocity is not None:
        speed = np.abs(velocity)
        found["still"] = speed < STILL
        found["forward"], found["backward"] = velocity >= STILL, velocity <= -STILL
        moving = np.where(found["still"], np.nan, speed)
        found["slow"], found["fast"] = _halves(moving)
        found["reversal"] = _near_reversal(velocity, max(round(REVERSAL / signals.step / 2), 1))
    if load is not None:
        found["light load"], found["heavy load"] = _halves(np.abs(load))
    if position is not None:
        found["low posture"], found["high posture"] = _halves(position)
    if signals.voltage is not None and np.ptp(signals.voltage[np.isfinite(signals.voltage)]) > 0:
        low, high = _halves(signals.voltage[:, None])
        found["low voltage"], found["high voltage"] = (
            np.broadcast_to(low, shape),
            np.broadcast_to(high, shape),
        )
    if signals.touching is not None and kind == "joint":
        stance, known = _stance(signals, names)
        found["stance"], found["swing"] = stance & known, ~stance & known
    return found


def _halves(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Ticks below and above the median of each column."""
    middle = np.full(values.shape[1], np.nan)
    some = np.isfinite(values).any(0)
    middle[some] = np.nanmedian(values[:, some], 0)
    return values < middle, values >= middle


def _near_reversal(velocity: np.ndarray, reach: int) -> np.ndarray:
    """Ticks near a change of sign."""
    changes = np.zeros(velocity.shape)
    changes[1:] = np.sign(velocity[1:]) != np.sign(velocity[:-1])
    total = np.concatenate([np.zeros((1, velocity.shape[1])), np.cumsum(changes, 0)])
    index = np.arange(len(velocity))
    low, high = np.maximum(index - reach, 0), np.minimum(index + reach + 1, len(velocity))
    return np.asarray(total[high] - total[low] > 0)


def _stance(signals: Signals, names: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Whether a foot that each joint carries touches `(t, n)`, and whether the joint carries a foot
    `(n,)`.
    """
    subject, touching = signals.subject, signals.touching
    assert touching is not None
    stance, known = np.zeros((len(signals.time), len(names)), bool), np.zeros(len(names), bool)
    for pad in subject.pads:
        chain = subject.tree.chain(int(subject.tree.link_joint[pad.link]))
        stance[:, chain] |= touching[:, pad.foot, None]
        known[chain] = True
    return stance, known


def _floors(
    signals: Sequence[Signals],
    sheets: Sequence[dict[tuple[str, str], _Sheet]],
    reference: Sequence[dict[tuple[str, str], _Sheet]],
) -> tuple[dict[tuple[str, str, str], np.ndarray], str]:
    """Floors by signal, kind and regime `(k,)`, and where they come from; `all` stands in for
    regimes that are missing.
    """
    if reference:
        return _pooled_floors(reference), "reference"
    repeats = _repeats(signals, sheets)
    if repeats:
        return repeats, "repeats"
    found = {}
    for key in dict.fromkeys(k for each in sheets for k in each):
        own = [each[key].floor for each in sheets if key in each]
        found[(*key, "all")] = np.sqrt(np.mean(np.square(own), 0))
    return found, "split"


def _pooled_floors(
    sheets: Iterable[dict[tuple[str, str], _Sheet]],
) -> dict[tuple[str, str, str], np.ndarray]:
    groups: dict[tuple[str, str], list[_Sheet]] = {}
    for each in sheets:
        for key, sheet in each.items():
            groups.setdefault(key, []).append(sheet)
    found = {}
    for key, group in groups.items():
        for regime in _regime_names(group):
            found[(*key, regime)] = _rms(
                np.concatenate([_values(sheet, regime) for sheet in group])
            )
    return found


def _repeats(
    signals: Sequence[Signals], sheets: Sequence[dict[tuple[str, str], _Sheet]]
) -> dict[tuple[str, str, str], np.ndarray]:
    """Half of the variance between logs that follow the same targets from their first tick on."""
    differences: dict[tuple[str, str, str], list[np.ndarray]] = {}
    for i, one in enumerate(signals):
        for j in range(i + 1, len(signals)):
            other = signals[j]
            length = min(len(one.time), len(other.time))
            if (
                one.target is None
                or other.target is None
                or not np.isclose(one.step, other.step, rtol=0.01)
                or one.target.shape[1] != other.target.shape[1]
            ):
                continue
            if length < 0.8 * max(len(one.time), len(other.time)):
                continue
            apart = one.target[:length] - other.target[:length]
            if not np.sqrt(np.nanmean(apart**2)) < SAME_TARGET:
                continue
            for key in sheets[i].keys() & sheets[j].keys():
                difference = (
                    sheets[i][key].residual[:length] - sheets[j][key].residual[:length]
                ) / np.sqrt(2)
                differences.setdefault((*key, "all"), []).append(difference)
                for regime, inside in sheets[i][key].regimes.items():
                    differences.setdefault((*key, regime), []).append(
                        np.where(inside[:length], difference, np.nan)
                    )
    return {key: _rms(np.concatenate(found)) for key, found in differences.items()}


def _regime_names(group: Sequence[_Sheet]) -> list[str]:
    names = dict.fromkeys(n for sheet in group for n in (*sheet.regimes, *sheet.bands))
    return ["all", *names]


def _values(sheet: _Sheet, regime: str) -> np.ndarray:
    """Residual in a regime, NaN elsewhere."""
    if regime == "all":
        return sheet.residual
    if regime in sheet.bands:
        return sheet.bands[regime]
    if regime in sheet.regimes:
        return np.where(sheet.regimes[regime], sheet.residual, np.nan)
    return np.full(sheet.residual.shape, np.nan)


def _rows(group: Sequence[_Sheet], floors: dict[tuple[str, str, str], np.ndarray]) -> list[Row]:
    first = group[0]
    key = (first.signal, first.kind)
    names = first.names
    default = floors.get((*key, "all"), np.zeros(len(names)))
    size = (
        np.sqrt(np.nanmean(np.square([s.size for s in group]), 0))
        if np.isfinite(group[0].size).any()
        else np.full(len(names), np.nan)
    )
    whole = 0.0
    squares: dict[str, np.ndarray] = {}
    rows: list[tuple[int, Row]] = []
    for regime in _regime_names(group):
        values = np.concatenate([_values(s, regime) for s in group])
        gap, floor, ticks = (
            _rms(values),
            np.nan_to_num(floors.get((*key, regime), default)),
            np.isfinite(values).sum(0),
        )
        if regime not in {n for s in group for n in s.bands}:
            squared = np.maximum(np.nan_to_num(gap) ** 2 - floor**2, 0.0) * ticks
        else:
            squared = np.nan_to_num(gap) ** 2 * ticks  # the floor of the whole is none of a band's
            floor = np.nan_to_num(floors.get((*key, regime), np.zeros(len(names))))
        if regime == "all":
            whole, squares["all"] = float(squared.sum()), squared
        with np.errstate(invalid="ignore", divide="ignore"):
            mean = np.where(ticks > 0, np.nansum(values, 0) / np.maximum(ticks, 1), np.nan)
            share = squared / whole if regime == "all" else squared / squares["all"]
        for k, name in enumerate(names):
            if not ticks[k]:
                continue
            part = float(min(share[k], 1.0)) if np.isfinite(share[k]) else 0.0
            rows.append(
                (
                    k,
                    Row(
                        first.signal,
                        first.unit,
                        first.kind,
                        name,
                        regime,
                        float(gap[k]),
                        float(floor[k]),
                        float(mean[k]),
                        part,
                        float(size[k]),
                        int(ticks[k]),
                    ),
                )
            )
    return [row for _, row in sorted(rows, key=lambda pair: pair[0])]


def _rms(values: np.ndarray) -> np.ndarray:
    """Root mean square of each column over its known ticks; NaN where there are none."""
    known = np.isfinite(values)
    count = known.sum(0)
    total = np.sum(np.where(known, values, 0.0) ** 2, 0)
    return np.where(count > 0, np.sqrt(total / np.maximum(count, 1)), np.nan)
