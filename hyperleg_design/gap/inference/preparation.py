"""From conditioned logs to what causes are fitted on: samples over their floor, and calibration
errors with priors from reference logs.

Reference logs calibrate the healthy robot: errors as wide as `nuisance.WIDE` are fitted to them,
what they leave over scales the floor, and the logs under test may differ from them by the usual
change from day to day.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.friction import FRICTION
from hyperleg_design.gap.inference import noise_model, nuisance, screen
from hyperleg_design.gap.inference.base import Base, Prior
from hyperleg_design.gap.inference.decide import shown_already
from hyperleg_design.gap.inference.detectors.holding import noticed
from hyperleg_design.gap.inference.detectors.imu_offset import PLACE, felt_upright
from hyperleg_design.gap.inference.detectors.unsettled import newly
from hyperleg_design.gap.inference.episodes import episodes
from hyperleg_design.gap.inference.fit import Design, Fit
from hyperleg_design.gap.inference.held_out import predict
from hyperleg_design.gap.inference.learned import Learned, learned, unsaid
from hyperleg_design.gap.inference.naming import AT_LIMITS
from hyperleg_design.gap.inference.samples import LOGS, Samples, gather
from hyperleg_design.gap.inference.screen import reach
from hyperleg_design.gap.signals import filtering

if TYPE_CHECKING:
    from hyperleg_design.gap.inference.model import Model
    from hyperleg_design.gap.inference.thresholds import Thresholds
    from hyperleg_design.gap.model.subject import Subject
    from hyperleg_design.gap.signals.filtering import FilteredLog
    from hyperleg_design.gap.signals.signals import Signals

MOST_SESSIONS = 4
"""Sessions told apart; more are dealt to these in turn."""
LEAST_SCALE, MOST_SCALE = 0.5, 400.0
"""Range of the variance of reference logs over the floor assumed without them that is believed."""
SPARE = 1.15
"""Of the floor from reference logs: other motions on another day fit a little worse (assumed)."""


@dataclass(frozen=True, eq=False)
class Prepared:
    """Ready for causes."""

    base: Base
    errors: tuple[nuisance.NuisanceParameter, ...]
    """Of the base's columns."""
    calibrated: bool
    """Whether reference logs were at hand."""
    learned: tuple[str, ...] = ()
    """What these show of effects of the catalogue, for people."""


def prepare(
    signals: Sequence[Signals],
    references: Sequence[Signals],
    thresholds: Thresholds,
    threads: int = 1,
) -> Prepared:
    """Samples, nuisance parameters and their priors.

    Args:
        signals: conditioned logs under test.
        references: conditioned logs of the healthy robot.
        thresholds: fixed rules.
        threads: that share the work.

    Raises:
        InputError: no log shows a residual.
    """
    signals = newly(signals, references)
    subject = signals[0].subject
    usual = nuisance.nuisance_parameters(subject, signals[0].step, bool(references))
    own = _columns(signals, usual, thresholds, sessions_of(signals), bool(references))
    if not len(own.samples.value):
        raise InputError(
            signals[0].log.name,
            "",
            None,
            "has too few ticks of which torques and motion are known: log longer, or more signals",
        )
    kept = _showing(own)
    if references:
        healthy = _columns(references, usual, thresholds, np.zeros(len(references), int), True)
        kept |= _showing(healthy)
        errors = [one for one, k in zip(usual, kept, strict=True) if k]
        base = healthy.base(kept, _felt(_wide(errors, subject), errors, references), thresholds)
        limits = [
            name
            for name in AT_LIMITS
            if name != "voltage_sag" or any(s.voltage is not None for s in references)
        ]
        before = shown_already(
            base, thresholds, [*screen.places(subject, limits), *unsaid(subject)], threads
        )
        prior = _felt(_after(base, before.fit, errors, subject), errors, signals)
        own, known = own.scaled(_scales(base, before)), learned(before)
        own = replace(own, holds=noticed(signals, references, known, errors, prior))
        return _with_learned(own, kept, prior, errors, known, thresholds)
    own = replace(own, holds=noticed(signals, ()))
    errors = [one for one, k in zip(usual, kept, strict=True) if k]
    prior = _felt(Prior(np.zeros(len(errors)), np.eye(len(errors))), errors, signals)
    return Prepared(own.base(kept, prior, thresholds), tuple(errors), False)


def _with_learned(
    own: _Columns,
    kept: np.ndarray,
    prior: Prior,
    errors: list[nuisance.NuisanceParameter],
    known: Sequence[Learned],
    thresholds: Thresholds,
) -> Prepared:
    """Logs under test without what the healthy robot shows already, which stays open as far as its
    logs leave it open.
    """
    shown = [(one, columns) for one in known if (columns := one.columns(own.samples)) is not None]
    if not shown:
        return Prepared(own.base(kept, prior, thresholds), tuple(errors), True)
    trace = np.sum([t for _, (t, _) in shown], 0)
    more = np.concatenate([c for _, (_, c) in shown])
    open_errors = [error for one, _ in shown for error in one.errors()]
    size, added = len(errors), len(open_errors)
    covariance = np.eye(size + added)
    covariance[:size, :size] = prior.covariance
    wider = Prior(np.concatenate([prior.mean, np.zeros(added)]), covariance, told=True)
    whole = replace(own, errors=np.concatenate([own.errors, more]), known=trace)
    base = whole.base(np.concatenate([kept, np.ones(added, bool)]), wider, thresholds)
    return Prepared(base, (*errors, *open_errors), True, tuple(one.says for one, _ in shown))


def _showing(columns: _Columns) -> np.ndarray:
    """Which nuisance parameters show at all `(errors,)` of bool."""
    return np.array(
        [reach(columns.samples, row[None]) > nuisance.LEAST for row in columns.errors], bool
    )


def _wide(errors: Sequence[nuisance.NuisanceParameter], subject: Subject) -> Prior:
    """Of errors for life."""
    return Prior(np.zeros(len(errors)), np.diag(nuisance.for_life(errors, subject) ** 2))


def _felt(
    prior: Prior, errors: Sequence[nuisance.NuisanceParameter], signals: Sequence[Signals]
) -> Prior:
    """With what the base's motion tells of its accelerometer along the vertical: else its error
    hides loads.
    """
    told = felt_upright(signals)
    if told is None:
        return prior
    up, error, deviation = told
    names = [p.name for p in EFFECTS[PLACE[0]].parameters]
    axis = {names.index(f"accelerometer_{a}"): u for a, u in zip("xyz", up.tolist(), strict=True)}
    row = np.array(
        [
            axis.get(one.parameter, 0.0) * one.spread if one.effect == PLACE[0] else 0.0
            for one in errors
        ]
    )
    across = prior.covariance @ row
    spread = float(row @ across)
    if spread == 0:
        return prior
    share = across / (spread + deviation**2)
    mean = prior.mean + share * (error - float(row @ prior.mean))
    return Prior(mean, prior.covariance - np.outer(share, across), prior.told)


def sessions_of(signals: Sequence[Signals]) -> np.ndarray:
    """Number of the session of each log; a log without one is a session of its own."""
    names = [s.log.metadata.session or f"\0{i}" for i, s in enumerate(signals)]
    order = list(dict.fromkeys(names))
    return np.array([order.index(name) % MOST_SESSIONS for name in names])


@dataclass(frozen=True, eq=False)
class _Columns:
    """Samples of some logs with the columns of all nuisance parameters."""

    filtered_logs: list[FilteredLog]
    floors: list[list[np.ndarray]]
    """Of each log, of each of its rows `(samples,)`."""
    samples: Samples
    errors: np.ndarray
    """`(errors, S)`"""
    sessions: np.ndarray
    thresholds: Thresholds
    known: np.ndarray | None = None
    """Traces of what the healthy robot shows already `(S,)`; left out of the residual."""
    holds: Mapping[str, float] = field(default_factory=dict)
    """As of `Samples`."""

    def scaled(self, scales: dict[tuple[str, int, int], float]) -> _Columns:
        """With the floor of each row and band scaled in variance."""
        floors = []
        usual = float(np.median(list(scales.values()))) if scales else 1.0
        for one, rows in zip(self.filtered_logs, self.floors, strict=True):
            changed = []
            for place, values in enumerate(rows):
                row = one.rows[place]
                band, _, _ = one.labels(place)
                factor = np.array(
                    [
                        scales.get((row.residual_name, row.column, int(b)), usual)
                        for b in range(int(band.max(initial=-1)) + 1)
                    ]
                )
                changed.append(values * SPARE * np.sqrt(factor[band]) if len(band) else values)
            floors.append(changed)
        return replace(self, floors=floors, samples=self.gathered(floors))

    def gathered(self, floors: list[list[np.ndarray]], apart: np.ndarray | None = None) -> Samples:
        """The samples anew, over other floors, or with episodes apart `(S,)`."""
        return gather(
            self.filtered_logs, floors, self.sessions.tolist(), self.thresholds.information, apart
        )

    def base(self, kept: np.ndarray, prior: Prior, thresholds: Thresholds) -> Base:
        """Base without the errors that show nowhere, its episodes apart."""
        found = self._over(self.samples, kept, prior, thresholds)
        apart = episodes(found)
        return (
            self._over(self.gathered(self.floors, apart), kept, prior, thresholds)
            if apart.any()
            else found
        )

    def _over(
        self, samples: Samples, kept: np.ndarray, prior: Prior, thresholds: Thresholds
    ) -> Base:
        return _base(
            replace(samples, holds=self.holds), self.errors[kept], prior, thresholds, self.known
        )


def _columns(
    signals: Sequence[Signals],
    usual: Sequence[nuisance.NuisanceParameter],
    thresholds: Thresholds,
    sessions: np.ndarray,
    calibrated: bool,
) -> _Columns:
    filtered_logs = [filtering.filtered_log(s, filtering.sticking(s)) for s in signals]
    floors = [noise_model.expected(one, thresholds) for one in filtered_logs]
    samples = gather(filtered_logs, floors, sessions.tolist(), thresholds.information)
    errors = np.zeros((len(usual), len(samples.value)))
    for one, places in zip(filtered_logs, samples.where, strict=True):
        for row, columns in nuisance.columns(one, usual, calibrated).items():
            errors[:, places[row]] = columns
    return _Columns(filtered_logs, floors, samples, errors, sessions, thresholds)


def _base(
    samples: Samples,
    errors: np.ndarray,
    prior: Prior,
    thresholds: Thresholds,
    known: np.ndarray | None = None,
) -> Base:
    weight = samples.weight
    value = samples.value if known is None else samples.value - known
    return Base(
        samples,
        errors * weight,
        (value - prior.mean @ errors) * weight,
        prior,
        thresholds.floor_weight,
    )


def _after(
    base: Base, fit: Fit, errors: Sequence[nuisance.NuisanceParameter], subject: Subject
) -> Prior:
    """What reference logs tell of another day; friction that they show turns over as nobody knows,
    as that of the model does.
    """
    weight = 1 / fit.scale
    size = len(errors)
    normal = base.total[0].weighed(weight)[:size, :size] + base.prior.precision
    known = np.linalg.inv(normal)
    mean = fit.errors[0]
    day = nuisance.spreads(errors, nuisance.DAY)
    friction = np.array([one.effect in FRICTION for one in errors])
    day = np.hypot(day, np.where(friction, nuisance.ABOVE_CALIBRATED * np.abs(mean), 0.0))
    day *= _turning(errors, mean, subject)
    return Prior(mean, known + np.diag(day**2), told=True)


def _turning(
    errors: Sequence[nuisance.NuisanceParameter], mean: np.ndarray, subject: Subject
) -> np.ndarray:
    """How many times as much friction as they stand for turns over, by reference logs, of such
    errors; 1 of others `(errors,)`.
    """
    shown = {
        e.location: float(m) * e.spread
        for e, m in zip(errors, mean, strict=True)
        if e.effect == "coulomb_friction"
    }
    unit = nuisance.turning(subject)
    rubs = {
        j: abs(own + shown.get(j, 0.0)) / of
        for j, own, of in zip(subject.joints, subject.coulomb, unit, strict=True)
    }
    return np.array(
        [max(rubs[e.location], 1.0) if e.effect == nuisance.TURNOVER else 1.0 for e in errors]
    )


def _scales(base: Base, model: Model) -> dict[tuple[str, int, int], float]:
    """Variance over the floor by residual, column and band: of reference logs, and of each that the
    others predict, if that is larger.
    """
    samples, fit = base.samples, model.fit
    number = base.number.sum(0)
    elsewhere = np.zeros(samples.groups)
    if samples.folds(LOGS) > 1:
        square = predict(Design(base, model.causes), LOGS, fit).square.sum(0)
        elsewhere = square / np.maximum(
            np.bincount(samples.group, samples.floor**2, samples.groups), 1e-300
        )
    found = {}
    for group in np.flatnonzero(~samples.episodic).tolist():
        row = samples.rows[samples.group_row[group]]
        scale = max(
            (base.freedom + fit.rss[group]) / (base.freedom + number[group]),
            float(elsewhere[group]),
        )
        found[row.residual_name, row.column, int(samples.group_band[group])] = float(
            np.clip(scale, LEAST_SCALE, MOST_SCALE)
        )
    return found
