"""The columns that an effect at a place leaves in the residuals, linearised, and how clearly they
show.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array

from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.endogenous import factors_of
from hyperleg_design.gap.inference.samples import Samples
from hyperleg_design.gap.model.subject import Subject

SHOWN = 0.02
"""Root mean square of a trace over the expected noise, at its usual size in the group where it
shows most, below which these logs cannot show it [-]."""


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
    logs = [filtered.signals for filtered in samples.filtered_logs]
    low, high = effect.shown_bounds(logs, location)
    nulls = effect.nulls
    k = len(nulls)
    shape = np.array([p.shape for p in effect.parameters])
    if effect.linear:
        nulls = np.where(shape, values, nulls)
        low, high = np.where(shape, nulls, low), np.where(shape, nulls, high)
        settings, divide = nulls + np.diag(np.where(shape, 0.0, usual)), np.ones(k)
        traced = trace_columns(samples, effect, location, settings)
        if traced is None:
            return None
        columns, constant = traced, np.zeros(0)
    else:
        values = np.clip(values, low, high)
        fixed = effect.fixed(values)
        low, high = np.where(fixed, values, low), np.where(fixed, values, high)
        step = effect.steps(location, subject)
        tried = np.clip(np.where(values + step <= high, values + step, values - step), low, high)
        divide = (tried - values) / usual
        some = np.flatnonzero(divide)
        settings = np.concatenate([(values + np.diag(tried - values))[some], values[None]])
        traced = trace_columns(samples, effect, location, settings)
        if traced is None:
            return None
        columns = np.zeros((k, traced.shape[1]))
        columns[some] = (traced[:-1] - traced[-1]) / divide[some, None]
        constant = traced[-1] - ((values - nulls) / usual) @ columns
    payload = subject.declared.payload
    masses = (float(payload[at][0]) for at in payload if _same_place(subject, at, location))
    declared = max(masses, default=0.0)
    scaled = factors_of(samples, effect.identifier, location, usual, values)
    unseen = not any(effect.driven(signals) for signals in logs)
    return Cause(
        effect.identifier,
        location,
        values=values,
        nulls=nulls,
        usual=usual,
        low=low,
        high=high,
        shape=shape,
        compact=csr_array(columns),
        constant=constant,
        linear=effect.linear,
        declared=declared,
        factors=scaled,
        unseen=unseen,
        beyond=subject.tree.beyond(location),
    )


def trace_columns(
    samples: Samples, effect: Effect, location: str, values: np.ndarray
) -> np.ndarray | None:
    """Compute samples of an effect's traces at some values.

    Args:
        samples: of the logs.
        effect: the effect.
        location: its place.
        values: of its parameters `(k, parameters)`.

    Returns:
        As of `Samples.columns` `(k, S)`; None where no log shows any of them.
    """
    return samples.columns(
        lambda s: effect.trace(s, location, values), len(values), effect.inertial
    )


def _same_place(subject: Subject, first: str, other: str) -> bool:
    tree = subject.tree
    known = (*tree.links, *tree.joints)
    return first in known and other in known and tree.link(first) == tree.link(other)


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
    compact = cause.compact[:, : len(tests.value)]
    if reach(tests, compact.toarray()) < SHOWN:
        return None
    scaled = factors_of(tests, cause.effect, cause.location, cause.usual, cause.values)
    constant = cause.constant[: len(tests.value)]
    return replace(cause, compact=compact, constant=constant, factors=scaled)
