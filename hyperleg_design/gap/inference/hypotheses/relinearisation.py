"""Hypotheses whose causes are linearised where they are estimated, by damped Gauss-Newton steps.

A cause of a nonlinear effect is linearised at some values. A fit far from these says little: a
battery that sags, linearised at one line of its motors and estimated at another, may seem to gain
hundreds of nats that it does not. So hypotheses are compared where their causes are linearised.
"""

from __future__ import annotations

from dataclasses import replace

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.endogenous import Factor
from hyperleg_design.gap.inference.hypotheses.hypothesis import Candidate, Hypothesis
from hyperleg_design.gap.inference.hypotheses.hypothesis_fit import HypothesisFit, are_near
from hyperleg_design.gap.inference.hypotheses.limited_scales import limited_scales
from hyperleg_design.gap.inference.hypotheses.stack import Stack
from hyperleg_design.gap.inference.interactions import Acting, acting_on, values_of
from hyperleg_design.gap.inference.linearisation import linearise


def relinearised(fits: HypothesisFit, hypothesis: Hypothesis) -> Hypothesis:
    """Linearise the causes of a hypothesis again at their estimates, and beside the causes that
    change what they act on (`interactions`), until both agree: from the estimates as they are,
    and from those at limited scales.

    Args:
        fits: to the evidence.
        hypothesis: fitted to causes that are linearised elsewhere.
    """
    begun, limited = [hypothesis], _at_limited_scales(fits, hypothesis)
    for _ in range(fits.rules.search.steps):
        candidates = _relinearised_once(fits, limited)
        if candidates is None:
            break
        limited = _at_limited_scales(fits, replace(hypothesis, candidates=candidates))
    if limited.candidates is not hypothesis.candidates:
        begun.append(fits.fit(limited.candidates, hypothesis.scales))
    agreed = (_agreed(fits, beginning) for beginning in begun)
    return max(agreed, key=lambda hypothesis: hypothesis.score)


def on_other_evidence(fits: HypothesisFit, hypothesis: Hypothesis) -> Hypothesis:
    """Fit the causes of a hypothesis to other evidence, linearised at their estimates.

    Args:
        fits: to the evidence.
        hypothesis: fitted to evidence whose residuals alone are others.

    Returns:
        The hypothesis, without the causes that this evidence does not show.
    """
    candidates, acting = [], iter(hypothesis.acting)
    for candidate in hypothesis.candidates:
        causes = []
        for cause, own in zip(candidate.causes, acting, strict=False):
            effect = WEIGHED[cause.effect]
            samples = fits.beside(effect, cause.standing, ())
            if (again := linearise(samples, effect, cause.location, own.values)) is not None:
                causes.append(_instead(fits, cause, again, ()))
        if causes:
            candidates.append(replace(candidate, causes=tuple(causes)))
    if not candidates:
        return fits.null
    return relinearised(fits, fits.fit(candidates, hypothesis.scales))


def _agreed(fits: HypothesisFit, hypothesis: Hypothesis) -> Hypothesis:
    """A hypothesis that is fitted to causes linearised at their estimates, by steps that are
    halved where they lead to worse.
    """
    best, step = fits.where_linearised(hypothesis), 1.0
    for _ in range(fits.rules.search.steps):
        beside_others = _relinearised_once(fits, hypothesis, 0.0)
        if beside_others is not None:
            hypothesis = fits.fit(beside_others, hypothesis.scales)
            best = fits.where_linearised(hypothesis)
        candidates = _relinearised_once(fits, hypothesis, step)
        if candidates is None:
            break
        other = fits.fit(candidates, hypothesis.scales)
        reached = fits.where_linearised(other)
        if reached.score > best.score:
            hypothesis, best, step = other, reached, 1.0
        else:
            step /= 2
    return best


def _at_limited_scales(fits: HypothesisFit, hypothesis: Hypothesis) -> Hypothesis:
    """Sizes of a hypothesis at limited scales, at which nothing hides what causes explain."""
    scales = limited_scales(fits.evidence, hypothesis.scales, fits.rules, True)
    solution = fits.at_scales(Stack.of(hypothesis.causes, fits.evidence), scales)
    return replace(hypothesis, theta=solution.theta, covariance=solution.covariance)


def _relinearised_once(
    fits: HypothesisFit, hypothesis: Hypothesis, step: float = 1.0
) -> tuple[Candidate, ...] | None:
    """Candidates linearised at their estimates, on what others leave, or a part of the step to
    there; None where they are already.
    """
    moved = False
    acting, candidates, place = _towards(hypothesis, step), [], 0
    least = fits.rules.search.converged
    for candidate in hypothesis.candidates:
        causes = []
        for cause in candidate.causes:
            at = cause.values if cause.linear else acting[place].values
            place += 1
            effect = WEIGHED[cause.effect]
            others = acting_on(effect, cause.standing, acting)
            wanted = values_of(others)
            if are_near(at, cause.values, cause.usual, least) and are_near(
                wanted, cause.before, 1.0, least
            ):
                causes.append(cause)
                continue
            samples = fits.beside(effect, cause.standing, others)
            again = linearise(samples, effect, cause.location, at)
            if again is not None:
                cause, moved = _instead(fits, cause, again, wanted), True
            causes.append(cause)
        candidates.append(replace(candidate, causes=tuple(causes)))
    return tuple(candidates) if moved else None


def _towards(hypothesis: Hypothesis, step: float) -> list[Acting]:
    """Causes with values on the way from where they are linearised to their estimates."""
    return [
        cause
        if own.linear
        else cause._replace(values=own.values + step * (cause.values - own.values))
        for own, cause in zip(hypothesis.causes, hypothesis.acting, strict=True)
    ]


def _instead(fits: HypothesisFit, cause: Cause, again: Cause, before: tuple[float, ...]) -> Cause:
    """A cause as it is linearised again; where it gains nothing by scaling torques, so does
    this.
    """
    again = fits.evidence.on_all_samples(again, cause.standing)
    shows = {term.row: term.shows for term in cause.factors if isinstance(term, Factor)}
    factors = tuple(
        replace(term, shows=shows.get(term.row, term.shows)) if isinstance(term, Factor) else term
        for term in again.factors
    )
    return replace(again, factors=factors, before=before)
