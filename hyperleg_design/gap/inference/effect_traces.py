"""What every effect leaves in the residuals at every place: columns of a linear effect, or the
traces at which the search for the values of a nonlinear one begins.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest
from typing import TypeAlias

import numpy as np
from scipy.sparse import csr_array

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.effects.spanned import SpannedEffect
from hyperleg_design.gap.inference.assembly import Evidence
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.hypotheses.hypothesis import Name
from hyperleg_design.gap.inference.linearisation import (
    SHOWN,
    linearise,
    reach,
    trace_columns,
    under_test,
)
from hyperleg_design.gap.inference.samples import Samples
from hyperleg_design.gap.inference.threads import spread
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals

UNEXCITED = "these logs do not excite it"
"""Why an effect at a place is not judged."""
MOST_STARTS = 18
"""Starts of an effect at a place whose traces are tried."""


@dataclass(frozen=True)
class NotJudged:
    """An effect that these logs cannot show."""

    effect: str
    location: str
    reason: str


@dataclass(frozen=True, eq=False)
class Starts:
    """Where searches for the values of a nonlinear effect at a place begin."""

    values: np.ndarray
    """Values of the parameters at each start `(s, k)`."""
    compact: csr_array
    """`columns`, without their zeros."""
    weights: np.ndarray | None = None
    """How much of each trace those of the starts hold `(s, p)`; None where they are the columns."""

    @property
    def columns(self) -> np.ndarray:
        """Traces of which theirs are sums `(p, S)`."""
        return np.asarray(self.compact.toarray())

    @property
    def traces(self) -> np.ndarray:
        """Of the starts `(s, S)`."""
        return self.columns if self.weights is None else self.weights @ self.columns


Traces: TypeAlias = NotJudged | list[Cause] | Starts
"""Of an effect at a place: why it is not judged; its linearised variants; or where the searches for
its values begin."""


def places(subject: Subject, effects: Iterable[str] | None = None) -> list[tuple[str, str]]:
    """List the effects, each at every place where it can sit on a robot.

    Args:
        subject: the robot.
        effects: identifiers; all that compete by default.
    """
    return [
        (name, place)
        for name in (WEIGHED if effects is None else effects)
        for place in WEIGHED[name].locations(subject)
    ]


def traces_of(
    evidence: Evidence, places: Sequence[tuple[str, str]], threads: int
) -> dict[Name, Traces]:
    """What each effect leaves at each place in the logs under test and, with references, in all
    logs.

    Args:
        evidence: channels.
        places: effects and locations.
        threads: that share the work.
    """
    traced = spread(lambda place: _traced(evidence, place), places, threads)
    by_name: dict[Name, Traces] = {}
    for (effect, location), both in zip(places, traced, strict=True):
        for standing, traces in zip((False, True), both, strict=False):
            by_name[effect, location, standing] = traces
    return by_name


def _traced(evidence: Evidence, place: tuple[str, str]) -> list[Traces]:
    """In the logs under test and, with references, in all logs."""
    flexible = WEIGHED[place[0]].flexible
    samples = evidence.tests if flexible else evidence.samples
    whole = trace(samples, WEIGHED[place[0]], place[1])
    if isinstance(whole, NotJudged):
        return [whole] * (2 if evidence.references and not flexible else 1)
    count = len(evidence.tests.value)
    own: Traces
    if isinstance(whole, list):
        own = [
            evidence.on_all_samples(cut, False)
            for cause in whole
            if (cut := under_test(cause, evidence.tests)) is not None
        ]
        whole = [evidence.on_all_samples(cause, True) for cause in whole]
    else:
        own = replace(whole, compact=whole.compact[:, :count])
        if reach(evidence.tests, own.traces) < SHOWN:
            own = []
    if not own:
        own = NotJudged(*place, UNEXCITED)
    return [own, whole] if evidence.references and not flexible else [own]


def trace(samples: Samples, effect: Effect, location: str) -> Traces:
    """Compute what an effect leaves at a place, or why these samples cannot show it.

    Args:
        samples: of the logs.
        effect: the effect.
        location: its place.
    """
    missing = lacking(effect, location, [s.signals for s in samples.filtered_logs])
    if missing:
        return NotJudged(effect.identifier, location, missing)
    unexcited = NotJudged(effect.identifier, location, UNEXCITED)
    if effect.linear:
        causes = [
            linearise(samples, effect, location, values)
            for values in _variants(samples, effect, location)
        ]
        return [
            c for c in causes if c is not None and reach(samples, c.columns) >= SHOWN
        ] or unexcited
    starts = _starts(samples, effect, location)
    weights = None
    if isinstance(effect, SpannedEffect):
        subject = samples.filtered_logs[0].signals.subject
        weights = effect.in_span(location, subject, starts)
        count, span = weights.shape[1], effect.span
        columns = samples.columns(lambda s: span(s, location), count, effect.inertial)
    else:
        columns = trace_columns(samples, effect, location, starts)
    if columns is None:
        return unexcited
    begun = Starts(starts, csr_array(columns), weights)
    return unexcited if reach(samples, begun.traces) < SHOWN else begun


def lacking(effect: Effect, location: str, signals: Sequence[Signals]) -> str:
    """Say what logs lack to show an effect at all.

    Args:
        effect: the effect.
        location: its place.
        signals: of the logs.

    Returns:
        The reason; empty where they lack nothing.
    """
    subject = signals[0].subject
    values = effect.example(location, subject)[None]
    residual_names = set().union(*(effect.trace(s, location, values) for s in signals))
    if not residual_names:
        return "these logs lack the signals that would show it"
    if not residual_names & set().union(*(s.residual for s in signals)):
        return (
            f"these logs lack the residuals in which it shows: {', '.join(sorted(residual_names))}"
        )
    return ""


def _variants(samples: Samples, effect: Effect, location: str) -> np.ndarray:
    """Of all logs, each once."""
    variants = np.concatenate([effect.variants(s.signals, location) for s in samples.filtered_logs])
    return np.unique(variants, axis=0)


def _starts(samples: Samples, effect: Effect, location: str) -> np.ndarray:
    """Starts of all logs, each once; the first of every log before the second of any."""
    logs = [list(effect.starts(s.signals, location)) for s in samples.filtered_logs]
    starts = np.array([start for turn in zip_longest(*logs) for start in turn if start is not None])
    _, first = np.unique(np.round(starts, 12), axis=0, return_index=True)
    return starts[np.sort(first)][:MOST_STARTS]
