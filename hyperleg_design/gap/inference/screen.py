"""What every effect leaves in the residuals at every place: columns of a linear effect, or the
traces at which the search for the values of a nonlinear one begins.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from itertools import zip_longest
from typing import TypeAlias, TypeVar

import numpy as np

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.effects.spanned import SpannedEffect
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.endogenous import factors_of
from hyperleg_design.gap.inference.samples import Samples
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals

SHOWN = 0.02
"""Root mean square of a trace over the expected noise, at its usual size in the group where it
shows most, below which these logs cannot show it [-]."""
UNEXCITED = "these logs do not excite it"
"""Why an effect at a place is not judged."""
MOST_STARTS = 18
"""Starts of an effect at a place whose traces are tried."""

T = TypeVar("T")
R = TypeVar("R")


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
    """`(s, k)`"""
    columns: np.ndarray
    """Traces of which theirs are sums `(p, S)`."""
    weights: np.ndarray | None = None
    """How much of each trace those of the starts hold `(s, p)`; None where they are the columns."""

    @property
    def traces(self) -> np.ndarray:
        """Of the starts `(s, S)`."""
        return self.columns if self.weights is None else self.weights @ self.columns


Traces: TypeAlias = NotJudged | list[Cause] | Starts
"""Of an effect at a place: why it is not judged; its linearised variants; or where the searches for
its values begin."""


def spread(job: Callable[[T], R], items: Sequence[T], threads: int) -> list[R]:
    """Apply a function to items on several threads.

    Args:
        job: the function.
        items: its arguments.
        threads: that share the work.

    Returns:
        The results, in the order of the items.
    """
    if threads <= 1 or len(items) < 2:
        return [job(item) for item in items]
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(job, items))


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


def linearise(samples: Samples, effect: Effect, location: str, values: np.ndarray) -> Cause | None:
    """Linearise an effect at a place.

    Args:
        samples: of the logs.
        effect: the effect.
        location: its place.
        values: of its parameters, at which a nonlinear effect is linearised by differences; of a
            linear one, only those that shape its trace matter `(k,)`.

    Returns:
        The cause; None where no log shows it.
    """
    subject = samples.filtered_logs[0].signals.subject
    usual = effect.usual(location, subject)
    low, high = effect.bounds(location, subject)
    nulls = effect.nulls
    k = len(nulls)
    shape = np.array([p.shape for p in effect.parameters])
    if effect.linear:
        nulls = np.where(shape, values, nulls)
        low, high = np.where(shape, nulls, low), np.where(shape, nulls, high)
        settings, divide = nulls + np.diag(np.where(shape, 0.0, usual)), np.ones(k)
        found = _columns(samples, effect, location, settings)
        if found is None:
            return None
        columns, constant = found, np.zeros(found.shape[1])
    else:
        values = np.clip(values, low, high)
        fixed = effect.fixed(values)
        low, high = np.where(fixed, values, low), np.where(fixed, values, high)
        step = effect.steps(location, subject)
        tried = np.clip(np.where(values + step <= high, values + step, values - step), low, high)
        divide = (tried - values) / usual
        some = np.flatnonzero(divide)
        settings = np.concatenate([(values + np.diag(tried - values))[some], values[None]])
        found = _columns(samples, effect, location, settings)
        if found is None:
            return None
        columns = np.zeros((k, found.shape[1]))
        columns[some] = (found[:-1] - found[-1]) / divide[some, None]
        constant = found[-1] - ((values - nulls) / usual) @ columns
    payload = subject.declared.payload
    masses = (float(payload[at][0]) for at in payload if _same_place(subject, at, location))
    declared = max(masses, default=0.0)
    scaled = factors_of(samples, effect.identifier, location, usual, values)
    unseen = bool(effect.driver) and all(
        getattr(s.signals, effect.driver) is None for s in samples.filtered_logs
    )
    return Cause(
        effect.identifier,
        location,
        values=values,
        nulls=nulls,
        usual=usual,
        low=low,
        high=high,
        shape=shape,
        columns=columns,
        constant=constant,
        linear=effect.linear,
        declared=declared,
        factors=scaled,
        unseen=unseen,
        beyond=subject.tree.beyond(location),
    )


def _columns(
    samples: Samples, effect: Effect, location: str, values: np.ndarray
) -> np.ndarray | None:
    """Samples of an effect's traces at some values `(k, parameters)`, as of `Samples.columns`."""
    return samples.columns(
        lambda s: effect.trace(s, location, values), len(values), effect.inertial
    )


def _same_place(subject: Subject, one: str, other: str) -> bool:
    tree = subject.tree
    known = (*tree.links, *tree.joints)
    return one in known and other in known and tree.link(one) == tree.link(other)


def reach(samples: Samples, columns: np.ndarray) -> float:
    """Compute how clearly columns show: their root mean square over the expected noise, in the
    group of samples where it is largest.

    Args:
        samples: of the logs.
        columns: traces, whose squares are summed `(k, S)`.
    """
    squares = samples.share * np.einsum("ks,ks->s", columns, columns) / np.square(samples.floor)
    square = np.bincount(samples.group, squares, samples.groups)
    number = np.bincount(samples.group, samples.share, samples.groups)
    return float(np.sqrt(np.max(square / np.maximum(number, 1e-9), initial=0.0)))


def under_test(cause: Cause, tests: Samples) -> Cause | None:
    """Cut a linear cause to the logs under test.

    Args:
        cause: on the samples of all logs, those under test first.
        tests: samples of the logs under test.

    Returns:
        The cause on these alone; None where they do not show it.
    """
    columns = cause.columns[:, : len(tests.value)]
    if reach(tests, columns) < SHOWN:
        return None
    scaled = factors_of(tests, cause.effect, cause.location, cause.usual, cause.values)
    constant = cause.constant[: len(tests.value)]
    return replace(cause, columns=columns, constant=constant, factors=scaled)


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
        columns = _columns(samples, effect, location, starts)
    if columns is None:
        return unexcited
    begun = Starts(starts, columns, weights)
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
    found = np.concatenate([effect.variants(s.signals, location) for s in samples.filtered_logs])
    return np.unique(found, axis=0)


def _starts(samples: Samples, effect: Effect, location: str) -> np.ndarray:
    """Starts of all logs, each once; the first of every log before the second of any."""
    logs = [list(effect.starts(s.signals, location)) for s in samples.filtered_logs]
    found = np.array([start for turn in zip_longest(*logs) for start in turn if start is not None])
    _, first = np.unique(np.round(found, 12), axis=0, return_index=True)
    return found[np.sort(first)][:MOST_STARTS]
