"""Prior probability of a set of causes at their values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.special import log_ndtr

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.effects.families import FRICTION
from hyperleg_design.gap.inference.assembly import Evidence
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.hypotheses.hypothesis import (
    EVERYWHERE,
    Candidate,
    Hypothesis,
    Name,
)
from hyperleg_design.gap.inference.rules import InferenceRules


def log_prior(
    hypothesis: Hypothesis, evidence: Evidence, rules: InferenceRules, count: Mapping[str, int]
) -> float:
    """Compute the log prior probability of a set of causes at their values.

    It is that of their effects and places, and that of their sizes. A cause whose size is a usual
    calibration error is unlikely to be a fault (`beyond_usual`); but one that acts in the
    references, too, may be as small as that, since it is in the hypothesis so that no change takes
    its place.

    Args:
        hypothesis: the set, with values.
        evidence: channels.
        rules: of the inference.
        count: places of each effect that is tried.

    Returns:
        The log probability, up to a constant [nat].
    """
    names = [candidate.name for candidate in hypothesis.candidates]
    total, place = log_chance(names, evidence, rules, count), 0
    for candidate in hypothesis.candidates:
        odds = []
        for cause in candidate.causes:
            values = hypothesis.values(place)
            odds.append(
                WEIGHED[cause.effect].odds(cause.location, evidence.signals[0].subject, values)
                + min(prior_odds(cause, values, rules), 0.0)
                + (0.0 if cause.standing else beyond_usual(hypothesis, place, evidence, rules))
            )
            place += 1
        total += float(np.mean(odds))
        if candidate.location == EVERYWHERE:
            total += _one_way(candidate, hypothesis, place, rules)
    return total


def log_chance(
    names: Sequence[Name], evidence: Evidence, rules: InferenceRules, count: Mapping[str, int]
) -> float:
    """Compute the log prior probability that some effects act at their places, of whatever sizes.

    Each effect is as likely as any other, at each of its places, or at all of them. Likelier are an
    effect that acts at another place already, and friction of another kind where a joint has some
    already, which is no further change.

    Args:
        names: effects, places and whether they stand in all logs, in the order of the effects.
        evidence: channels.
        rules: of the inference.
        count: places of each effect that is tried.

    Returns:
        The log probability [nat].
    """
    own, total = rules.cause, 0.0
    acting: set[tuple[str, bool]] = set()
    rubbing: set[tuple[str, bool]] = set()
    for effect, location, standing in names:
        changed = bool(evidence.references) and not standing
        chance = own.changed if changed else own.probability
        places = count[effect] + (count[effect] > 1)
        if effect in FRICTION and (location, standing) in rubbing:
            chance = own.again / (len(FRICTION) - 1)
        elif (effect, standing) in acting:
            chance *= own.again / places
        else:
            chance *= (1 - own.again if acting else 1.0) / (len(count) * places)
        acting.add((effect, standing))
        if effect in FRICTION:
            rubbing.add((location, standing))
        total += float(np.log(chance))
    return total


def _one_way(
    candidate: Candidate, hypothesis: Hypothesis, end: int, rules: InferenceRules
) -> float:
    """Log posterior probability that all sizes of an effect at all of its places have one sign, as
    what acts everywhere acts the same way at each [nat].

    Args:
        candidate: the effect.
        hypothesis: that it is in.
        end: place of the cause after its own.
        rules: of the inference.
    """
    clear = np.zeros(len(candidate.causes))
    for i, cause in enumerate(candidate.causes):
        part = hypothesis.parts[end - len(candidate.causes) + i]
        size = np.flatnonzero(~cause.shape)[0]
        variance = max(float(np.diag(hypothesis.covariance)[part][size]), 1e-300)
        deviation = rules.posterior.interval * np.sqrt(variance)
        clear[i] = hypothesis.theta[part][size] / deviation
    return float(np.logaddexp(log_ndtr(clear).sum(), log_ndtr(-clear).sum()))


def beyond_usual(
    hypothesis: Hypothesis, place: int, evidence: Evidence, rules: InferenceRules
) -> float:
    """Log posterior probability that one of a cause's parameters lies beyond `usual` deviations of
    the usual calibration error [nat]: of one that does not, nothing is wrong.

    Args:
        hypothesis: that it is in.
        place: of the cause among those of the hypothesis.
        evidence: channels.
        rules: of the inference.
    """
    cause = hypothesis.causes[place]
    values, deviation = hypothesis.values(place), hypothesis.deviation(place)
    factor = rules.posterior.interval
    odds = []
    for i, (value, null) in enumerate(zip(values, cause.nulls, strict=True)):
        if cause.shape[i] or value == null:
            continue
        key = cause.effect, cause.location, i
        usual = usual_error(evidence, rules, key, cause.standing)
        if not usual:
            return 0.0
        over = (abs(value - null) - usual) / max(factor * deviation[i], 1e-300)
        odds.append(float(log_ndtr(over)))
    return max(odds, default=0.0)


def usual_error(
    evidence: Evidence,
    rules: InferenceRules,
    parameter: tuple[str, str, int],
    standing: bool = False,
) -> float:
    """Size up to which a parameter of an effect is a usual calibration error: `CauseRules.usual`
    deviations; of one that changed since the references, as far as such errors change from session
    to session, steady ones not at all.

    Args:
        evidence: channels.
        rules: of the inference.
        parameter: effect, location, and place among the effect's parameters.
        standing: whether it acts in the references, too.

    Returns:
        The size, in the parameter's unit; 0 where no error is usual.
    """
    share = 1.0
    if evidence.references and not standing:
        share = 0.0 if WEIGHED[parameter[0]].inertial else rules.discrepancy.change
    return share * rules.cause.usual * evidence.usual.get(parameter, 0.0)


def prior_odds(cause: Cause, values: np.ndarray, rules: InferenceRules) -> float:
    """State log prior odds of a cause over those of any other cause in its place.

    Args:
        cause: the effect and its place.
        values: of its parameters `(k,)`.
        rules: of the inference.

    Returns:
        The log odds: what each free parameter costs, and what the effect itself states
        (`Effect.rare`, `Effect.unseen`, `Effect.size_odds`) [nat].
    """
    free = int((~cause.shape).sum() if cause.linear else (cause.high > cause.low).sum())
    effect = WEIGHED[cause.effect]
    odds = effect.rare if effect.flexible else -rules.cause.parameter * free + effect.rare
    if cause.unseen:
        odds += effect.unseen
    if effect.described and values[0] < rules.cause.missing_from * cause.low[0] < 0:
        odds -= rules.cause.missing
    return odds + effect.size_odds(values, cause.usual, cause.declared, cause.beyond)
