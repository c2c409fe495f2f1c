"""Prior probability of a set of causes at their values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import log_ndtr

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.hypothesis import EVERYWHERE
from hyperleg_design.gap.inference.prior_odds import prior_odds

if TYPE_CHECKING:
    from hyperleg_design.gap.inference.assembly import Evidence
    from hyperleg_design.gap.inference.fit import Cause
    from hyperleg_design.gap.inference.hypothesis import Candidate, Hypothesis
    from hyperleg_design.gap.inference.rules import InferenceRules


def log_prior(
    hypothesis: Hypothesis, evidence: Evidence, rules: InferenceRules, count: Mapping[str, int]
) -> float:
    """Log prior probability of a set of causes at their values [nat]: each effect is as likely
    as any other, but for one that acts at another place already, at each of its places, or at
    all of them.
    """
    own = rules.cause
    found, place = 0.0, 0
    acting: set[tuple[str, bool]] = set()
    for one in hypothesis.candidates:
        kind = one.effect, one.standing
        chance = own.probability * (own.again if kind in acting else 1 / len(count))
        if acting and kind not in acting:
            chance *= 1 - own.again
        acting.add(kind)
        found += float(np.log(chance))
        found -= float(np.log(count[one.effect] + (count[one.effect] > 1)))
        odds = []
        for cause in one.causes:
            values = hypothesis.values(place)
            odds.append(
                EFFECTS[cause.effect].odds(cause.location, evidence.signals[0].subject, values)
                + min(prior_odds(cause, values), 0.0)
                - _like_usual(cause, values, hypothesis.deviation(place), evidence, rules)
            )
            place += 1
        found += float(np.mean(odds))
        if one.location == EVERYWHERE:
            found += _one_way(one, hypothesis, place, rules)
    return found


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


def _like_usual(
    cause: Cause,
    values: np.ndarray,
    deviation: np.ndarray,
    evidence: Evidence,
    rules: InferenceRules,
) -> float:
    """Log odds against a cause that is no larger than the usual calibration error: the
    posterior probability that one of its parameters lies beyond `usual` deviations of that
    [nat]. What references tell has no such error.
    """
    if evidence.references and not cause.standing:
        return 0.0
    own, factor = rules.cause, rules.posterior.interval
    odds = []
    for place, (value, null) in enumerate(zip(values, cause.nulls, strict=True)):
        usual = own.usual * evidence.usual.get((cause.effect, cause.location, place), 0.0)
        if cause.shape[place] or value == null:
            continue
        if not usual:
            return 0.0
        over = (abs(value - null) - usual) / max(factor * deviation[place], 1e-300)
        odds.append(-float(log_ndtr(over)))
    return min(odds, default=0.0)
