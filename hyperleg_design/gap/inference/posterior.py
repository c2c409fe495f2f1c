"""From hypotheses and their evidence to a verdict: posterior probabilities, sets of causes that the
data cannot tell apart, and what remains.

| verdict | |
|---|---|
| `none` | nothing is the most probable, and no channel shows something unlisted |
| `explained` | a set of causes is, and accounts for the main part of the gap |
| `ambiguous` | the same, and rivals are as probable in the place of one of them |
| `unknown` | something unlisted acts, and no listed cause accounts for the main part |
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hyperleg_design.gap.effects import UNLISTED
from hyperleg_design.gap.inference.assembly import Evidence
from hyperleg_design.gap.inference.gap_size import GapSize
from hyperleg_design.gap.inference.hypotheses.cause_prior import beyond_usual
from hyperleg_design.gap.inference.hypotheses.hypothesis import (
    EVERYWHERE,
    Candidate,
    Hypothesis,
    Name,
)
from hyperleg_design.gap.inference.hypotheses.search import Result
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.inference.unlisted import unlisted


@dataclass(frozen=True, eq=False)
class Posterior:
    """What the hypotheses say together."""

    verdict: str
    hypothesis: Hypothesis
    """The most probable hypothesis."""
    order: tuple[int, ...]
    """Its candidates that are faults and no `standing` ones, the one that explains most first."""
    minor: tuple[int, ...]
    """Its candidates that are faults and no `standing` ones, but beside those in `order` are less
    probable than not, or close next to nothing of the gap."""
    standing: tuple[int, ...]
    """Its candidates that act in the references, too, likewise: what the model lacks."""
    shares: tuple[float, ...]
    """Of the gap, that each of its causes closes, see `GapSize.closed_by` [-]."""
    probability: dict[Name, float]
    """Of each candidate in any hypothesis."""
    rivals: tuple[tuple[Hypothesis, Candidate], ...]
    """Other candidates and the best hypothesis with each, most probable first."""
    alike: tuple[tuple[Name, ...], ...]
    """For each candidate in `order`, what cannot be told from it."""
    odd: tuple[int, ...]
    """Its candidates that are faults and not `listed`, `standing` ones, too."""
    closed: float
    """Share of the excess gap that the causes close."""
    remainder: float
    """Share of the gap that something unlisted makes."""


def changes_first(result: Result, rules: InferenceRules) -> Result:
    """Put a hypothesis first whose causes act in the logs under test alone, where one that is about
    as probable has the same causes in all logs: the references show nothing of them.

    Args:
        result: of the search.
        rules: of the inference.
    """
    best = result.best
    alike = [
        other
        for other in result.hypotheses
        if best.score - other.score < rules.posterior.alike
        and sorted(name[:2] for name in other.names) == sorted(name[:2] for name in best.names)
    ]
    first = min(alike, key=lambda other: (sum(name[2] for name in other.names), -other.score))
    others = (other for other in result.hypotheses if other is not first)
    return replace(result, hypotheses=(first, *others))


def posterior_of(
    result: Result, evidence: Evidence, size: GapSize, rules: InferenceRules
) -> Posterior:
    """Judge all hypotheses together.

    Args:
        result: of the search.
        evidence: what it was made on.
        size: of the gap with and without the most probable hypothesis.
        rules: of the inference.
    """
    own = rules.posterior
    scores = np.array([hypothesis.score for hypothesis in result.hypotheses])
    weights = np.exp(own.temperature * (scores - scores.max()))
    weights /= weights.sum()
    best, anywhere = result.best, untold(result)
    probability: dict[Name, float] = {}
    for hypothesis, weight in zip(result.hypotheses, weights.tolist(), strict=True):
        names = {name for candidate in hypothesis.candidates for name in _stated(candidate)}
        names |= {(*name[:2], False) for name in names if name in anywhere}
        for name in sorted(names):
            probability[name] = probability.get(name, 0.0) + weight
    highest = own.highest(bool(evidence.references))
    probability = {name: min(p, highest) for name, p in probability.items()}
    ranked = np.argsort(-np.array(_effects(best)), kind="stable").tolist()
    faults = _faults(best, evidence, rules)
    ranked = [place for place in ranked if best.candidates[place] in faults]
    odd = tuple(place for place in ranked if best.candidates[place].effect in UNLISTED)
    acting = any(
        unlisted(channel, scales, rules)
        for channel, scales in zip(evidence.channels, best.scales, strict=True)
    ) or any(not best.candidates[place].standing for place in odd)
    closed = size.closed
    remainder = float(np.clip(1 - closed, 0.0, 1.0)) if acting else 0.0
    ranked = [place for place in ranked if place not in odd]
    shares = tuple(
        size.closed_by(cause.trace(best.theta[part]), standing=cause.standing)
        for cause, part in zip(best.causes, best.parts, strict=True)
    )
    changes = [place for place in ranked if not best.candidates[place].standing]
    alike = {place: _alike(result, best, place, rules) for place in changes}
    certain = {
        place: probability[best.candidates[place].name] + sum(probability[a] for a in alike[place])
        for place in changes
    }
    order, minor = _main_causes(best, certain, shares, rules)
    standing = tuple(place for place in ranked if best.candidates[place].standing)
    rivals = _rivals(result, best)
    if not order:
        verdict = "unknown" if acting else "none"
        return Posterior(
            verdict, best, (), (), standing, shares, probability, rivals, (), odd, 0.0, remainder
        )
    sets = tuple(alike[place] for place in order)
    main = closed if acting else 1.0
    verdict = "ambiguous" if any(sets) else "explained"
    if main < own.main_part:
        verdict = "unknown"
    probability = {
        name: p * (1 - remainder if remainder >= own.remainder and not name[2] else 1.0)
        for name, p in probability.items()
    }
    return Posterior(
        verdict=verdict,
        hypothesis=best,
        order=order,
        minor=minor,
        standing=standing,
        shares=shares,
        probability=probability,
        rivals=rivals,
        alike=sets,
        odd=odd,
        closed=closed,
        remainder=remainder,
    )


def untold(result: Result) -> set[Name]:
    """Name the causes of the most probable hypothesis that act in all logs, and that the first one
    has in the logs under test alone, see `changes_first`.

    Args:
        result: of the search, as `changes_first` orders it.
    """
    likeliest = max(result.hypotheses, key=lambda hypothesis: hypothesis.score)
    return set(likeliest.names) - set(result.best.names)


def _main_causes(
    best: Hypothesis, certain: Mapping[int, float], shares: Sequence[float], rules: InferenceRules
) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Of some candidates those that are causes, and those that beside them are less probable than
    not, with what they cannot be told from, or close next to nothing.

    Args:
        best: the most probable hypothesis.
        certain: probability by place of each of its candidates that may be a cause.
        shares: that each of its causes closes of the gap.
        rules: of the inference.
    """
    own = rules.posterior
    closed = {
        place: max(
            share
            for (_, candidate), share in zip(expanded(best.candidates), shares, strict=True)
            if candidate is best.candidates[place]
        )
        for place in certain
    }
    main = tuple(
        place
        for place, probability in certain.items()
        if closed[place] >= own.least_closed and probability >= own.likely
    )
    if not main:
        return tuple(certain), ()
    return main, tuple(place for place in certain if place not in main)


def _stated(candidate: Candidate) -> list[Name]:
    """What a candidate states: itself, and, of an effect at all places, that it acts at each."""
    own = ((cause.effect, cause.location, cause.standing) for cause in candidate.causes)
    return [candidate.name, *own]


def _faults(
    hypothesis: Hypothesis, evidence: Evidence, rules: InferenceRules
) -> tuple[Candidate, ...]:
    """Candidates that are not, more probably than not, a usual calibration error alone."""
    likely = float(np.log(rules.posterior.likely))
    likely_faults = (
        candidate
        for place, candidate in expanded(hypothesis.candidates)
        if beyond_usual(hypothesis, place, evidence, rules) > likely
    )
    return tuple(dict.fromkeys(likely_faults))


def _effects(hypothesis: Hypothesis) -> list[float]:
    """How far the causes of each candidate stand out of their uncertainty, squared."""
    effects, place = [], 0
    for candidate in hypothesis.candidates:
        total = 0.0
        for _ in candidate.causes:
            part = hypothesis.parts[place]
            theta = np.where(hypothesis.causes[place].shape, 0.0, hypothesis.theta[part])
            spread = np.diag(hypothesis.covariance)[part]
            total += float(np.sum(theta**2 / np.maximum(spread, 1e-300)))
            place += 1
        effects.append(total / len(candidate.causes))
    return effects


def _alike(result: Result, best: Hypothesis, place: int, rules: InferenceRules) -> tuple[Name, ...]:
    """Candidates that could stand in the place of one, about as probably."""
    rest = {candidate.name for i, candidate in enumerate(best.candidates) if i != place}
    names_alike = []
    for other in result.hypotheses:
        names = set(other.names)
        new = names - rest
        if len(new) != 1 or not rest <= names or best.candidates[place].name in new:
            continue
        (name,) = new
        listed = name[1] != EVERYWHERE and not name[2] and name[0] not in UNLISTED
        if best.score - other.score < rules.posterior.alike and listed:
            names_alike.append(name)
    return tuple(names_alike)


def _rivals(result: Result, best: Hypothesis) -> tuple[tuple[Hypothesis, Candidate], ...]:
    seen: dict[Name, tuple[Hypothesis, Candidate]] = {}
    known = {(cause.effect, cause.location, cause.standing) for cause in best.causes}
    for hypothesis in result.hypotheses:
        for candidate in hypothesis.candidates:
            if candidate.standing or candidate.effect in UNLISTED:
                continue
            if candidate.name in seen or known.issuperset(_stated(candidate)[1:]):
                continue
            if candidate.name not in best.names:
                seen[candidate.name] = (hypothesis, candidate)
    return tuple(seen.values())


def expanded(candidates: Sequence[Candidate]) -> list[tuple[int, Candidate]]:
    """Pair each cause of a hypothesis with its candidate.

    Args:
        candidates: of the hypothesis.

    Returns:
        Index of each cause among those of all candidates, and its candidate.
    """
    pairs, place = [], 0
    for candidate in candidates:
        for _ in candidate.causes:
            pairs.append((place, candidate))
            place += 1
    return pairs
