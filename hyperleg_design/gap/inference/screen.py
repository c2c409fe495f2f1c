"""Every effect at every place, linearised and fitted beside the nuisance parameters; the promising
ones refitted exactly.

An effect that is not linear is tried from each of its starts by a few Gauss-Newton steps within its
bounds, on the traces themselves.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from itertools import zip_longest
from typing import TYPE_CHECKING, TypeAlias, TypeVar
from weakref import WeakKeyDictionary

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.base import Base
from hyperleg_design.gap.inference.detectors import telling
from hyperleg_design.gap.inference.detectors.unsettled import UNSETTLING, shaking
from hyperleg_design.gap.inference.endogenous import factor
from hyperleg_design.gap.inference.fit import Cause, Design, Fit

if TYPE_CHECKING:
    from hyperleg_design.gap.effects.effect import Effect
    from hyperleg_design.gap.inference.samples import Samples
    from hyperleg_design.gap.model.subject import Subject
    from hyperleg_design.gap.signals.signals import Signals


SURE = 20.0
"""Log-likelihood of friction that explains what a joint holds."""
SURELY = 0.9
"""Share of what a joint holds that its breakaway friction has at least, where that is the cause."""

SHOWN = 0.02
"""Root mean square of a trace over the floor, at its usual size in the group where it shows most,
below which these logs cannot show it."""
UNEXCITED = "these logs do not excite it"
"""Why an effect at a place is not judged."""
STEPS = 8
"""Gauss-Newton steps a start in the screen."""
MOST_DESCENTS, DESCENTS, KINDS = 16, 2, 3
"""Effects that are not linear which are fitted exactly, starts of each, and of one with choices:
one of each of the best so many choices."""
MOST_STARTS = 18
"""Starts of an effect at a place whose traces are tried."""
PROMISING = 0.1
"""Gain of an effect by its starts' traces, over the best gain of any, from which it is fitted
exactly."""

BREAKAWAY = "stribeck_friction"
"""Effect of joints that stick."""
KEPT = 2**29
"""Memory for traces that further causes are tried with, too [byte]; what is more is traced anew."""
DRIVERS = {"voltage_sag": "voltage", "thermal_derating": "temperature"}
"""Signals of `Signals` that drive an effect."""

_TRACED: WeakKeyDictionary[Samples, dict[tuple[str, str], Traces]] = WeakKeyDictionary()

T = TypeVar("T")
R = TypeVar("R")


@dataclass(frozen=True, eq=False)
class Candidate:
    """An effect at a place and how well it does alone."""

    cause: Cause
    fit: Fit
    gain: float
    """Log evidence over that of no cause."""

    @property
    def name(self) -> tuple[str, str]:
        """Effect and location."""
        return self.cause.name


@dataclass(frozen=True)
class NotJudged:
    """An effect that these logs cannot show."""

    effect: str
    location: str
    reason: str


Traces: TypeAlias = NotJudged | list[Cause] | tuple[np.ndarray, np.ndarray]
"""Why an effect at a place is not judged; it linearised, in each variant; or starts `(s, k)` and
their traces `(s, S)`."""


def spread(job: Callable[[T], R], items: Sequence[T], threads: int) -> list[R]:
    """Results in the order of the items, whatever the number of threads."""
    if threads <= 1 or len(items) < 2:
        return [job(item) for item in items]
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(job, items))


def places(subject: Subject, effects: Iterable[str] | None = None) -> list[tuple[str, str]]:
    """Effects and where they can sit on a robot."""
    return [
        (name, place)
        for name in (EFFECTS if effects is None else effects)
        for place in EFFECTS[name].locations(subject)
    ]


def linearise(samples: Samples, effect: Effect, location: str, values: np.ndarray) -> Cause | None:
    """An effect linearised at some values `(k,)`; None where no log shows it."""
    subject = samples.filtered_logs[0].signals.subject
    usual = effect.usual(location, subject)
    low, high = effect.bounds(location, subject)
    holds = samples.holds
    if effect.identifier == BREAKAWAY and location in holds:
        low[0] = min(SURELY * holds[location], high[0])
    nulls = effect.nulls
    k = len(nulls)
    shape = np.array([p.shape for p in effect.parameters])
    if effect.linear:
        nulls = np.where(shape, values, nulls)
        low, high = np.where(shape, nulls, low), np.where(shape, nulls, high)
        settings, divide = nulls + np.diag(np.where(shape, 0.0, usual)), np.ones(k)
        found = samples.columns(lambda s: effect.trace(s, location, settings), k)
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
        settings = np.concatenate(
            [np.broadcast_to(values, (k, k)) + np.diag(tried - values), values[None]]
        )
        found = samples.columns(lambda s: effect.trace(s, location, settings), k + 1)
        if found is None:
            return None
        some = divide != 0
        columns = np.where(
            some[:, None], (found[:k] - found[k]) / np.where(some, divide, 1.0)[:, None], 0.0
        )
        constant = found[k] - ((values - nulls) / usual) @ columns
    declared = max(
        (
            float(kg[0])
            for place, kg in subject.declared.payload.items()
            if _same_place(subject, place, location)
        ),
        default=0.0,
    )
    scaled = factor(samples, effect.identifier, location, usual, values)
    driver = DRIVERS.get(effect.identifier)
    unseen = driver is not None and all(
        getattr(s.signals, driver) is None for s in samples.filtered_logs
    )
    shakes = effect.unsettles(values) and _unsettling(samples, effect, location)
    return Cause(
        effect.identifier,
        location,
        values,
        nulls,
        usual,
        low,
        high,
        shape,
        columns,
        constant,
        effect.linear,
        declared,
        scaled,
        unseen,
        shakes,
        effect.doubtful(values),
        subject.tree.beyond(location),
        effect.odds(location, subject, values)
        + telling.odds(effect.identifier, location, [s.signals for s in samples.filtered_logs]),
    )


def _unsettling(samples: Samples, effect: Effect, location: str) -> bool:
    """Whether a joint chatters that an effect could have made unstable, in any log."""
    shaken = set(shaking(samples)) if effect.identifier in UNSETTLING else set()
    subject = samples.filtered_logs[0].signals.subject
    if location in subject.motors and effect.kind == "motor":
        moves = subject.joint_from_motor[:, subject.motors.index(location)] != 0
        return any(
            joint in shaken for joint, moved in zip(subject.joints, moves, strict=True) if moved
        )
    return location in shaken if location in subject.joints else bool(shaken)


def at_rest(samples: Samples, effect: str, location: str) -> float:
    """Log-likelihood that breakaway friction gains by what its joint holds at rest, which is in no
    sample.
    """
    return SURE if effect == BREAKAWAY and location in samples.holds else 0.0


def _same_place(subject: Subject, one: str, other: str) -> bool:
    tree = subject.tree
    known = (*tree.links, *tree.joints)
    return one in known and other in known and tree.link(one) == tree.link(other)


def reach(samples: Samples, columns: np.ndarray) -> float:
    """Largest root mean square over the groups of columns `(k, S)` over the floor, summed over the
    columns.
    """
    square = np.bincount(
        samples.group, samples.share * np.square(columns / samples.floor).sum(0), samples.groups
    )
    number = np.bincount(samples.group, samples.share, samples.groups)
    return float(np.sqrt(np.max(square / np.maximum(number, 1e-9), initial=0.0)))


def screen(
    base: Base,
    nothing: Fit,
    wanted: Sequence[tuple[str, str]],
    threads: int = 1,
    beside: Sequence[Cause] = (),
) -> list[Candidate | NotJudged]:
    """Fit each effect alone, or beside causes that are known.

    Linear effects are fitted at once. Of the others each start's trace is fitted with a free size
    first; the best of them are then descended from.

    Args:
        base: residual and nuisance parameters.
        nothing: fit without any further cause.
        wanted: effects and locations.
        threads: that share the work; they change no result.
        beside: causes that are fitted along.
    """
    first = spread(lambda item: _tried(base, nothing, *item, beside), wanted, threads)
    rough = sorted(
        (i for i, one in enumerate(first) if isinstance(one, _Rough)),
        key=lambda i: (-first[i].gain, i),  # type: ignore[union-attr]
    )
    sure = max((one.gain for one in first if isinstance(one, Candidate)), default=0.0)
    top = max((first[i].gain for i in rough), default=0.0)  # type: ignore[union-attr]
    chosen = [
        i
        for rank, i in enumerate(rough)
        if rank < MOST_DESCENTS and first[i].gain > PROMISING * max(sure, top)  # type: ignore[union-attr]
    ]
    descended = dict(
        zip(
            chosen,
            spread(lambda i: _best(base, first[i], nothing, beside), chosen, threads),  # type: ignore[arg-type]
            strict=True,
        )
    )
    found: list[Candidate | NotJudged] = []
    for i, one in enumerate(first):
        if isinstance(one, _Rough):
            better = descended.get(i)
            if better is not None:
                found.append(better)
        else:
            found.append(one)
    return found


@dataclass(frozen=True, eq=False)
class _Rough:
    """An effect that is not linear, by the sizes that its starts' traces would have."""

    effect: str
    location: str
    starts: np.ndarray
    """Best first `(s, k)`."""
    gain: float


def under_test(cause: Cause, tests: Samples) -> Cause | None:
    """A linear cause in the first of its samples; None where these do not show it."""
    columns = cause.columns[:, : len(tests.value)]
    if reach(tests, columns) < SHOWN:
        return None
    scaled = factor(tests, cause.effect, cause.location, cause.usual, cause.values)
    constant = cause.constant[: len(tests.value)]
    return replace(cause, columns=columns, constant=constant, factor=scaled)


def traced(base: Base, effect: Effect, location: str) -> Traces:
    """What an effect at a place leaves, whatever is beside it; kept, up to `KEPT`."""
    kept = _TRACED.setdefault(base.samples, {})
    name = effect.identifier, location
    if name in kept:
        return kept[name]
    found = _trace(base, effect, location)
    if sum(map(_size, kept.copy().values())) + _size(found) <= KEPT:
        kept[name] = found
    return found


def _size(traced: Traces) -> int:
    """Memory that traces take [byte]."""
    if isinstance(traced, NotJudged):
        return 0
    return (
        sum(c.columns.nbytes + c.constant.nbytes for c in traced)
        if isinstance(traced, list)
        else sum(a.nbytes for a in traced)
    )


def _trace(base: Base, effect: Effect, location: str) -> Traces:
    missing = lacking(effect, location, [s.signals for s in base.samples.filtered_logs])
    if missing:
        return NotJudged(effect.identifier, location, missing)
    unexcited = NotJudged(effect.identifier, location, UNEXCITED)
    if effect.linear:
        causes = [
            linearise(base.samples, effect, location, values)
            for values in _variants(base, effect, location)
        ]
        return [
            c for c in causes if c is not None and reach(base.samples, c.columns) >= SHOWN
        ] or unexcited
    starts = _starts(base, effect, location)
    columns = base.samples.columns(lambda s: effect.trace(s, location, starts), len(starts))
    return (
        unexcited if columns is None or reach(base.samples, columns) < SHOWN else (starts, columns)
    )


def _tried(
    base: Base, nothing: Fit, name: str, location: str, beside: Sequence[Cause]
) -> Candidate | NotJudged | _Rough:
    found = traced(base, EFFECTS[name], location)
    if isinstance(found, NotJudged):
        return found
    if isinstance(found, list):
        return max((_candidate(base, c, nothing, beside) for c in found), key=lambda c: c.gain)
    starts, columns = found
    gains = []
    none, one = np.zeros(0), np.zeros(1)
    for column in columns:
        whole = Cause(
            name,
            location,
            one,
            one,
            np.ones(1),
            np.zeros(1),
            np.full(1, 10.0),
            np.zeros(1, bool),
            column[None],
            none,
            True,
        )
        gains.append(_candidate(base, whole, nothing, beside).gain if np.any(column) else -np.inf)
    order = np.argsort(-np.array(gains), kind="stable")
    return _Rough(
        name, location, starts[order], gains[order[0]] + at_rest(base.samples, name, location)
    )


def _best(base: Base, rough: _Rough, nothing: Fit, beside: Sequence[Cause]) -> Candidate | None:
    best: Candidate | None = None
    for start in _unlike(EFFECTS[rough.effect], rough.starts):
        found = descend(base, EFFECTS[rough.effect], rough.location, start, nothing, STEPS, beside)
        if found is not None and (best is None or found.gain > best.gain):
            best = found
    return best


def _unlike(effect: Effect, starts: np.ndarray) -> np.ndarray:
    """The first starts of several choices, where there are any: a search does not get from one to
    another. Best first `(s, k)`.
    """
    choices = np.array([bool(p.choices) for p in effect.parameters])
    _, first = np.unique(starts[:, choices], axis=0, return_index=True)
    ahead = np.sort(first)[:KINDS].tolist() if choices.any() else []
    order = ahead + [i for i in range(len(starts)) if i not in ahead]
    return starts[order[: max(DESCENTS, len(ahead))]]


def lacking(effect: Effect, location: str, signals: Sequence[Signals]) -> str:
    """What the logs lack to show an effect at all, or nothing."""
    subject = signals[0].subject
    values = effect.example(location, subject)[None]
    residual_names = set().union(*(effect.trace(s, location, values) for s in signals))
    if not residual_names:
        return "these logs lack the signals that would show it"
    if not residual_names & set().union(*(s.residual for s in signals)):
        return f"these logs have no balance in which it shows ({', '.join(sorted(residual_names))})"
    return ""


def _variants(base: Base, effect: Effect, location: str) -> np.ndarray:
    """Of all logs, each once."""
    found = np.concatenate(
        [effect.variants(s.signals, location) for s in base.samples.filtered_logs]
    )
    return np.unique(found, axis=0)


def _starts(base: Base, effect: Effect, location: str) -> np.ndarray:
    """Starts of all logs, each once; the first of every log before the second of any."""
    logs = [list(effect.starts(s.signals, location)) for s in base.samples.filtered_logs]
    found = np.array([start for turn in zip_longest(*logs) for start in turn if start is not None])
    _, first = np.unique(np.round(found, 12), axis=0, return_index=True)
    return found[np.sort(first)][:MOST_STARTS]


def _candidate(
    base: Base, cause: Cause, nothing: Fit, beside: Sequence[Cause], rounds: int = 1
) -> Candidate:
    fit = Design(base, [*beside, cause]).fit(scale=nothing.scale, rounds=rounds)
    return Candidate(cause, fit, fit.evidence - nothing.evidence)


def descend(
    base: Base,
    effect: Effect,
    location: str,
    start: np.ndarray,
    nothing: Fit,
    steps: int,
    beside: Sequence[Cause] = (),
) -> Candidate | None:
    """Gauss-Newton steps of a nonlinear effect, halved until they better the fit.

    Args:
        base: residual and nuisance parameters.
        effect: what is fitted.
        location: its place.
        start: values to begin with.
        nothing: fit without it.
        steps: at most.
        beside: causes that are fitted along.
    """
    cause = linearise(base.samples, effect, location, start)
    rests = at_rest(base.samples, effect.identifier, location)
    if cause is None:
        return None
    if (
        not rests
        and reach(
            base.samples,
            np.concatenate([cause.columns, (cause.constant + cause.phi @ cause.columns)[None]]),
        )
        < SHOWN
    ):
        return None
    before = sum(len(c.nulls) for c in beside)
    design = Design(base, [*beside, cause])
    scale = nothing.scale
    weight = 1 / scale
    value = _cost(design, weight, cause.phi, before)
    for _ in range(steps):
        phi, *_ = design.solve(weight, near=np.concatenate([np.zeros(before), cause.phi]))
        step = phi[before:] - cause.phi
        bettered = False
        for _ in range(4):
            values = np.clip(cause.nulls + (cause.phi + step) * cause.usual, cause.low, cause.high)
            found = linearise(base.samples, effect, location, values)
            if found is None:
                break
            tried = Design(base, [*beside, found])
            cost = _cost(tried, weight, found.phi, before)
            if cost < value:
                bettered = value - cost > 1e-3 * abs(value) * 0.1 + 0.05
                cause, design, value = found, tried, cost
                scale = design.fit(scale=scale, rounds=1).scale
                weight = 1 / scale
                value = _cost(design, weight, cause.phi, before)
                break
            step = step / 4
        if not bettered:
            break
    fit = design.fit(scale=scale, rounds=1)
    return Candidate(cause, fit, fit.evidence - nothing.evidence + rests)


def _cost(design: Design, weight: np.ndarray, phi: np.ndarray, before: int) -> float:
    """Squares left over with a cause's values where it is linearised, everything else fitted; prior
    included.
    """
    held = np.full(design.count, np.nan)
    held[before:] = phi
    found, _, errors, _ = design.solve(weight, held=held)
    paid = 2 * design.scaled(np.concatenate([found[:before], phi]))
    rss = float(weight @ design.rss(found, errors))
    precision = design.base.prior.precision
    deviation = design.widened(found)
    unlikely = float(np.sum((found / deviation) ** 2 + 2 * np.log(deviation / design.deviation)))
    return rss - paid + unlikely + float(np.einsum("sp,pq,sq->", errors, precision, errors))
