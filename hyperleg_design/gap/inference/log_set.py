"""Logs under test, or references: their samples, with nuisance parameters and discrepancy shapes as
columns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.inference import noise_model, nuisance, nuisance_traces
from hyperleg_design.gap.inference.channels.discrepancy import load, shapes
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.inference.samples import SLOWEST_BANDS, Samples, gather
from hyperleg_design.gap.inference.zeros import Zeros
from hyperleg_design.gap.signals import filtering, resting
from hyperleg_design.gap.signals.filtering import FilteredLog, place_of
from hyperleg_design.gap.signals.signals import Signals


@dataclass(frozen=True, eq=False)
class LogSet:
    """Logs under test, or references."""

    filtered_logs: list[FilteredLog]
    samples: Samples
    floors: list[list[np.ndarray]]
    """Expected noise of each log and row."""
    errors: np.ndarray
    """Columns of the nuisance parameters, steady ones first `(p, S)`."""
    known: int
    """Number of columns, the first ones, whose deviation is known."""
    steady: int
    """Number of columns of parameters that are the same in all sessions, those included."""
    tested: bool

    def row(self, key: tuple[str, int]) -> int | None:
        """Look up a channel among the samples' rows.

        Args:
            key: name and column of its residual.

        Returns:
            Its index; None where no log of this set has the channel.
        """
        return place_of(self.samples.rows, *key)

    def shapes(self, key: tuple[str, int], waves: int) -> tuple[np.ndarray, np.ndarray, float]:
        """Compute the discrepancy shapes of a channel and their sizes.

        Args:
            key: name and column of the channel's residual.
            waves: random cosine features beside the named shapes.

        Returns:
            Samples of the shapes `(k, S)`, their mean squares `(k,)`, and the mean square of the
            channel's load in slow bands, over the logs.
        """
        columns: np.ndarray | None = None
        squares, loads = [], []
        for filtered, places in zip(self.filtered_logs, self.samples.where, strict=True):
            place = place_of(filtered.rows, *key)
            if place is None:
                continue
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


def log_set(
    signals: Sequence[Signals],
    errors: Sequence[nuisance.NuisanceParameter],
    zeros: Zeros,
    rules: InferenceRules,
    tested: bool,
) -> LogSet:
    """Filter some logs into samples, and compute the columns of their usual errors.

    Args:
        signals: conditioned logs.
        errors: nuisance parameters, known ones first, then steady ones.
        zeros: of encoders that are set where joints hang.
        rules: of the inference.
        tested: whether these are the logs under test.

    Returns:
        The set.
    """
    filtered_logs = [filtering.filtered_log(signal, resting.sticking(signal)) for signal in signals]
    floors = [noise_model.expected(filtered, rules.noise) for filtered in filtered_logs]
    names = [signal.log.metadata.session or f"\0{i}" for i, signal in enumerate(signals)]
    order = list(dict.fromkeys(names))
    sessions = [order.index(name) for name in names]
    samples = gather(filtered_logs, floors, sessions, rules.noise.information)
    apart = zeros.columns(filtered_logs, samples, tested)
    columns = np.zeros((len(errors), len(samples.value)))
    for filtered, places in zip(filtered_logs, samples.where, strict=True):
        for row, traces in nuisance_traces.columns(filtered, errors).items():
            columns[:, places[row]] = traces
    columns[[error.inertial for error in errors]] *= samples.felt
    known = len(apart) + sum(error.known for error in errors)
    steady = len(apart) + sum(error.steady for error in errors)
    columns = np.concatenate([apart, columns])
    return LogSet(filtered_logs, samples, floors, columns, known, steady, tested)
