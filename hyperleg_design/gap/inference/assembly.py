"""From conditioned logs to channels: samples over their noise, nuisance parameters and discrepancy
shapes as columns, and the sums of their products.

Nuisance parameters are columns beside the shapes, each at its usual size, and belong to one
channel alone: a mass that is a little wrong may be so by another share at each joint, which costs
little and keeps the channels independent of each other given the causes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.inference import noise_model, nuisance
from hyperleg_design.gap.inference.channel import Channel
from hyperleg_design.gap.inference.discrepancy import load, shapes
from hyperleg_design.gap.inference.endogenous import Factor
from hyperleg_design.gap.inference.samples import gather
from hyperleg_design.gap.signals import filtering

if TYPE_CHECKING:
    from hyperleg_design.gap.inference.fit import Cause
    from hyperleg_design.gap.inference.rules import InferenceRules
    from hyperleg_design.gap.inference.samples import Samples
    from hyperleg_design.gap.inference.thresholds import Thresholds
    from hyperleg_design.gap.signals.filtering import FilteredLog
    from hyperleg_design.gap.signals.signals import Signals

MOST_BANDS = 5
"""Bands of a channel, see `filtering.EDGES`."""
SLOWEST_BANDS = 3
"""Bands of a channel whose load sizes its discrepancy: in faster ones it is mostly noise."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """What causes are judged on."""

    channels: tuple[Channel, ...]
    samples: Samples
    """Under test; causes act on these alone."""
    signals: tuple[Signals, ...]
    """Under test."""
    references: tuple[Signals, ...]
    moved: tuple[float, ...]
    """Share of the numbers of each channel in which its load is no noise."""

    def scaled(self, cause: Cause) -> Cause:
        """A cause that pays for scaling torques, in all channels that it shows in, as far as these
        torques are no noise.
        """
        factor = cause.factor
        if not isinstance(factor, Factor):
            return cause
        trace = cause.columns[factor.parameter]
        number = sum(
            share * float(self.samples.share[channel.samples].sum())
            for channel, share in zip(self.channels, self.moved, strict=True)
            if np.any(trace[channel.samples] != 0)
        )
        return replace(cause, factor=replace(factor, number=number))

    @property
    def weight(self) -> np.ndarray:
        """What a trace is multiplied by before products are taken `(S,)`."""
        return self.samples.weight


@dataclass(frozen=True, eq=False)
class _Set:
    """Logs under test, or references."""

    filtered_logs: list[FilteredLog]
    samples: Samples
    errors: np.ndarray
    """Columns of the nuisance parameters `(p, S)`."""
    tested: bool

    def row(self, key: tuple[str, int]) -> int | None:
        """Place of a channel among the samples' rows."""
        keys = [(row.residual_name, row.column) for row in self.samples.rows]
        return keys.index(key) if key in keys else None

    def shapes(self, key: tuple[str, int], waves: int) -> tuple[np.ndarray, np.ndarray, float]:
        """Columns `(k, S)`, mean squares of the shapes `(k,)` and of the load, over logs."""
        columns: np.ndarray | None = None
        squares, loads = [], []
        for filtered, places in zip(self.filtered_logs, self.samples.where, strict=True):
            keys = [(row.residual_name, row.column) for row in filtered.rows]
            if key not in keys:
                continue
            place = keys.index(key)
            raw = shapes(filtered.signals, *key, waves)
            if columns is None:
                columns = np.zeros((len(raw), len(self.samples.value)))
            columns[:, places[place]] = filtered.sample(place, raw)
            squares.append(np.mean(raw[:, filtered.mask[place]] ** 2, 1))
            own = filtered.sample(place, load(filtered.signals, *key)[None])[0]
            band = filtered.labels(place)[0]
            loads.append(
                sum(
                    float(np.mean(own[band == b] ** 2))
                    for b in range(SLOWEST_BANDS)
                    if (band == b).any()
                )
            )
        assert columns is not None
        return columns, np.mean(squares, 0), float(np.mean(loads))


def evidence_of(
    tests: Sequence[Signals],
    references: Sequence[Signals],
    rules: InferenceRules,
    thresholds: Thresholds,
) -> Evidence:
    """Channels of all logs.

    Args:
        tests: conditioned logs under test.
        references: conditioned logs of the healthy robot.
        rules: of the inference.
        thresholds: of the noise model.

    Raises:
        InputError: no log shows a residual.
    """
    subject = tests[0].subject
    errors = nuisance.nuisance_parameters(subject, tests[0].step, bool(references))
    sets = [_set(tests, errors, rules, thresholds, bool(references), tested=True)]
    if not len(sets[0].samples.value):
        raise InputError(
            tests[0].log.name,
            "",
            None,
            "has too few ticks of which torques and motion are known: log longer, or more signals",
        )
    if references:
        sets.append(_set(references, errors, rules, thresholds, True, tested=False))
    keys = [(row.residual_name, row.column) for row in sets[0].samples.rows]
    made = [_channel(key, sets, rules) for key in keys]
    return Evidence(
        tuple(channel for channel, _ in made),
        sets[0].samples,
        tuple(tests),
        tuple(references),
        tuple(moved for _, moved in made),
    )


def _set(
    signals: Sequence[Signals],
    errors: Sequence[nuisance.NuisanceParameter],
    rules: InferenceRules,
    thresholds: Thresholds,
    calibrated: bool,
    tested: bool,
) -> _Set:
    filtered_logs = [filtering.filtered_log(one, filtering.sticking(one)) for one in signals]
    floors = [noise_model.expected(one, thresholds) for one in filtered_logs]
    names = [one.log.metadata.session or f"\0{i}" for i, one in enumerate(signals)]
    order = list(dict.fromkeys(names))
    sessions = [order.index(name) for name in names]
    samples = gather(filtered_logs, floors, sessions, rules.noise.information)
    columns = np.zeros((len(errors), len(samples.value)))
    for filtered, places in zip(filtered_logs, samples.where, strict=True):
        for row, found in nuisance.columns(filtered, errors, calibrated).items():
            columns[:, places[row]] = found
    return _Set(filtered_logs, samples, columns, tested)


def _channel(
    key: tuple[str, int], sets: Sequence[_Set], rules: InferenceRules
) -> tuple[Channel, float]:
    """A channel, and the share of its numbers under test in which its load is no noise."""
    parts = [(one, row) for one in sets if (row := one.row(key)) is not None]
    made = [one.shapes(key, rules.discrepancy.waves) for one, _ in parts]
    signals = sets[0].filtered_logs[0].signals
    size = np.mean([square for _, square, _ in made], 0)
    strength = float(np.mean([square for *_, square in made]))
    if key[0] == "motion":
        strength += float(signals.subject.coulomb[key[1]]) ** 2
    scale = rules.discrepancy.share * np.sqrt(strength / np.maximum(size, 1e-300))
    scale[size <= 0] = 0.0
    own_noise, moved = None, 1.0
    if key[0] == "motion":
        own_noise, moved = _feigned(key, sets)
    white, cells = [], []
    for number, ((one, row), (columns, *_)) in enumerate(zip(parts, made, strict=True)):
        samples = one.samples
        own = np.flatnonzero(samples.row == row)
        whole = np.concatenate(
            [
                one.errors[:, own],
                columns[:, own] * scale[:, None],
                *([] if own_noise is None else [own_noise[number][:, own]]),
                samples.value[None, own],
            ]
        )
        whole *= samples.weight[own]
        session = samples.session[samples.part[own]]
        band = samples.group_band[samples.group[own]]
        for s, b in sorted(set(zip(session.tolist(), band.tolist(), strict=True))):
            mine = (session == s) & (band == b)
            white.append(whole[:, mine])
            place = own[mine] if one.tested else np.zeros(0, int)
            cells.append(((number, s), (number, b), float(samples.share[own[mine]].sum()), place))
    sessions = sorted({cell[0] for cell in cells})
    bands = sorted({cell[1] for cell in cells})
    white = _rotated(white, rules.discrepancy.truncation)
    return Channel(
        key[0],
        key[1],
        parts[0][0].samples.rows[parts[0][1]].name,
        np.array([one @ one.T for one in white]),
        np.array([cell[2] for cell in cells]),
        np.array([sessions.index(cell[0]) for cell in cells]),
        np.array([bands.index(cell[1]) for cell in cells]),
        np.array([number == 0 for number, _ in sessions]),
        tuple(cell[3] for cell in cells),
        tuple(white),
    ), moved


def _feigned(key: tuple[str, int], sets: Sequence[_Set]) -> tuple[list[np.ndarray], float]:
    """Columns of the part of the load that is noise or vibration in each band, over all sets
    `(columns, S)` each.

    Such noise is in the residual and in every trace that holds the load or its derivatives. A cause
    must not gain by it: the load, and its second derivative, have a prior deviation of the share of
    the load that the expected noise is.
    """
    found = [np.zeros((2 * MOST_BANDS, len(one.samples.value))) for one in sets]
    whole, clean = 0.0, 0.0
    for one, columns in zip(sets, found, strict=True):
        for filtered, places in zip(one.filtered_logs, one.samples.where, strict=True):
            keys = [(row.residual_name, row.column) for row in filtered.rows]
            if key not in keys:
                continue
            place = keys.index(key)
            torque = load(filtered.signals, *key)
            step = filtered.signals.step
            twice = np.gradient(np.gradient(np.nan_to_num(torque), step), step)
            slow, fast = filtered.sample(place, np.stack([torque, twice]))
            _, rate = noise_model.of_acceleration(filtered, place)
            expected = one.samples.floor[places[place]] ** 2
            band = filtered.labels(place)[0]
            for b in np.unique(band).tolist():
                mine = band == b
                size = float(np.mean(slow[mine] ** 2))
                share = min(float(np.mean(expected[mine])) / max(size, 1e-300), 1.0)
                at = np.arange(places[place].start, places[place].stop)[mine]
                if one.tested:
                    number = float(one.samples.share[at].sum())
                    whole, clean = whole + number, clean + (1 - share) * number
                columns[2 * b, at] = share * slow[mine]
                columns[2 * b + 1, at] = share * fast[mine] / float(np.mean(rate[mine]))
    return found, clean / max(whole, 1e-300)


def _rotated(white: Sequence[np.ndarray], truncation: float) -> list[np.ndarray]:
    """Columns turned to the directions that the samples show, residual last; all have the same
    prior, which no rotation changes.
    """
    total = sum((one[:-1] @ one[:-1].T for one in white), np.zeros(()))
    values, axes = np.linalg.eigh(total)
    axes = axes[:, values > truncation]
    return [np.concatenate([axes.T @ one[:-1], one[-1:]]) for one in white]
