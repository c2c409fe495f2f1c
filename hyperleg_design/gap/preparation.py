"""From conditioned logs to what causes are fitted on: samples over their floor, and calibration errors with priors from reference logs.

Reference logs calibrate the healthy robot: errors as wide as `nuisance.WIDE` are fitted to them, what they leave over scales the
floor, and the logs under test may differ from them by the usual change from day to day.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap import filtering, floor, nuisance
from hyperleg_design.gap.base import Base, Prior
from hyperleg_design.gap.chatter import newly
from hyperleg_design.gap.episodes import episodes
from hyperleg_design.gap.fit import Design, Fit
from hyperleg_design.gap.samples import Samples, gather
from hyperleg_design.gap.screen import reach

if TYPE_CHECKING:
    from hyperleg_design.gap.filtering import Sieve
    from hyperleg_design.gap.signals import Signals
    from hyperleg_design.gap.thresholds import Thresholds

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
    errors: tuple[nuisance.Usual, ...]
    """Of the base's columns."""
    calibrated: bool
    """Whether reference logs were at hand."""


def prepare(signals: Sequence[Signals], references: Sequence[Signals], thresholds: Thresholds) -> Prepared:
    """Samples, calibration errors and their priors.

    Args:
        signals: conditioned logs under test.
        references: conditioned logs of the healthy robot.
        thresholds: fixed rules.

    Raises:
        InputError: no log shows a balance.
    """
    signals = newly(signals, references)
    subject = signals[0].subject
    usual = nuisance.usual_errors(subject, signals[0].step)
    own = _columns(signals, usual, thresholds, sessions_of(signals))
    if not len(own.samples.value):
        raise InputError(signals[0].log.name, "", None, "has too few ticks of which torques and motion are known: log longer, or more signals")
    kept = np.array([reach(own.samples, row[None]) > nuisance.LEAST for row in own.errors], bool)
    if references:
        healthy = _columns(references, usual, thresholds, np.zeros(len(references), int))
        kept |= np.array([reach(healthy.samples, row[None]) > nuisance.LEAST for row in healthy.errors], bool)
        errors = [one for one, k in zip(usual, kept, strict=True) if k]
        wide = np.diag(nuisance.spreads(errors, nuisance.WIDE) ** 2)
        base = healthy.base(kept, Prior(np.zeros(len(errors)), wide), thresholds)
        fit = Design(base).fit()
        prior = _after(base, fit, errors)
        scales = _scales(base, fit)
        own = own.scaled(scales)
    else:
        errors = [one for one, k in zip(usual, kept, strict=True) if k]
        prior = Prior(np.zeros(len(errors)), np.eye(len(errors)))
    return Prepared(own.base(kept, prior, thresholds), tuple(errors), bool(references))


def sessions_of(signals: Sequence[Signals]) -> np.ndarray:
    """Number of the session of each log; a log without one is a session of its own."""
    names = [s.log.metadata.session or f"\0{i}" for i, s in enumerate(signals)]
    order = list(dict.fromkeys(names))
    return np.array([order.index(name) % MOST_SESSIONS for name in names])


@dataclass(frozen=True, eq=False)
class _Columns:
    """Samples of some logs with the columns of all calibration errors."""

    sieves: list[Sieve]
    floors: list[list[np.ndarray]]
    """Of each log, of each of its rows `(samples,)`."""
    samples: Samples
    errors: np.ndarray
    """`(errors, S)`"""
    sessions: np.ndarray
    thresholds: Thresholds

    def scaled(self, scales: dict[tuple[str, int, int], float]) -> _Columns:
        """With the floor of each row and band scaled in variance."""
        floors = []
        usual = float(np.median(list(scales.values()))) if scales else 1.0
        for one, rows in zip(self.sieves, self.floors, strict=True):
            changed = []
            for place, values in enumerate(rows):
                row = one.rows[place]
                band, _, _ = one.labels(place)
                factor = np.array([scales.get((row.balance, row.column, int(b)), usual) for b in range(int(band.max(initial=-1)) + 1)])
                changed.append(values * SPARE * np.sqrt(factor[band]) if len(band) else values)
            floors.append(changed)
        return replace(self, floors=floors, samples=self.gathered(floors))

    def gathered(self, floors: list[list[np.ndarray]], apart: np.ndarray | None = None) -> Samples:
        """The samples anew, over other floors, or with episodes apart `(S,)`."""
        return gather(self.sieves, floors, self.sessions.tolist(), self.thresholds.information, apart)

    def base(self, kept: np.ndarray, prior: Prior, thresholds: Thresholds) -> Base:
        """Base without the errors that show nowhere, its episodes apart."""
        found = _base(self.samples, self.errors[kept], prior, thresholds)
        apart = episodes(found)
        if not apart.any():
            return found
        return _base(self.gathered(self.floors, apart), self.errors[kept], prior, thresholds)


def _columns(signals: Sequence[Signals], usual: Sequence[nuisance.Usual], thresholds: Thresholds, sessions: np.ndarray) -> _Columns:
    sieves = [filtering.sieve(s, filtering.sticking(s)) for s in signals]
    floors = [floor.expected(one, thresholds) for one in sieves]
    samples = gather(sieves, floors, sessions.tolist(), thresholds.information)
    errors = np.zeros((len(usual), len(samples.value)))
    for one, places in zip(sieves, samples.where, strict=True):
        for row, columns in nuisance.columns(one, usual).items():
            errors[:, places[row]] = columns
    return _Columns(sieves, floors, samples, errors, sessions, thresholds)


def _base(samples: Samples, errors: np.ndarray, prior: Prior, thresholds: Thresholds) -> Base:
    weight = samples.weight
    return Base(samples, errors * weight, (samples.value - prior.mean @ errors) * weight, prior, thresholds.floor_weight)


def _after(base: Base, fit: Fit, errors: Sequence[nuisance.Usual]) -> Prior:
    """What reference logs tell of another day."""
    weight = 1 / fit.scale
    size = len(errors)
    normal = base.total[0].weighed(weight)[:size, :size] + base.prior.precision
    known = np.linalg.inv(normal)
    mean = fit.errors[0]
    day = nuisance.spreads(errors, nuisance.DAY)
    friction = np.array([one.effect.endswith("_friction") and not one.effect.startswith("ground") for one in errors])
    day = np.hypot(day, np.where(friction, nuisance.ABOVE_CALIBRATED * np.abs(mean), 0.0))
    return Prior(mean, known + np.diag(day**2))


def _scales(base: Base, fit: Fit) -> dict[tuple[str, int, int], float]:
    """Variance over the floor by balance, column and band."""
    samples = base.samples
    number = base.number.sum(0)
    found = {}
    for group in np.flatnonzero(~samples.episodic).tolist():
        row = samples.rows[samples.group_row[group]]
        scale = (base.freedom + fit.rss[group]) / (base.freedom + number[group])
        found[row.balance, row.column, int(samples.group_band[group])] = float(np.clip(scale, LEAST_SCALE, MOST_SCALE))
    return found
