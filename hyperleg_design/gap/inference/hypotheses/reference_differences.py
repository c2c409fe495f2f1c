"""Reference logs that differ from one another by an effect of the catalogue, and references without
what sets one apart.

Each reference is looked at as if it were under test: an effect that acts in it alone is fitted
beside the best hypothesis and those that are about as probable. (The best may say that the model
lacks what tests and this reference share.) Effects that scale torques are not tried: their
likelihood is that of the logs under test.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.effect_traces import Starts, Traces
from hyperleg_design.gap.inference.hypotheses.hypothesis import Hypothesis, Name
from hyperleg_design.gap.inference.hypotheses.hypothesis_fit import HypothesisFit
from hyperleg_design.gap.inference.hypotheses.limited_scales import limited_scales
from hyperleg_design.gap.inference.hypotheses.proposals import Proposer
from hyperleg_design.gap.inference.hypotheses.search import Result, Search
from hyperleg_design.gap.inference.linearisation import SHOWN, reach
from hyperleg_design.gap.signals.signals import Signals

FEWEST = 2
"""References that can differ."""


@dataclass(frozen=True, eq=False)
class Difference:
    """An effect that acts in one reference and not in the others."""

    reference: int
    """Place among the references."""
    log: str
    """Name of the reference log."""
    cause: Cause
    values: np.ndarray
    """Of the effect's parameters."""
    deviation: np.ndarray
    """Standard deviations of the values."""
    odds: float
    """Log posterior odds of the best hypothesis with it over the best without [nat]."""

    def taken_out(self, references: Sequence[Signals]) -> list[Signals]:
        """References without what this effect leaves in one of them.

        Args:
            references: all of them, in their order.

        Returns:
            The same, one of them changed.
        """
        odd = references[self.reference]
        effect = WEIGHED[self.cause.effect]
        traces = odd.shown(effect.trace(odd, self.cause.location, self.values[None]))
        residual = {
            name: rows - traces[name][0] if name in traces else rows
            for name, rows in odd.residual.items()
        }
        before, after = references[: self.reference], references[self.reference + 1 :]
        return [*before, replace(odd, residual=residual), *after]


def differences(search: Search, result: Result) -> list[Difference]:
    """Find what sets references apart from the others.

    Args:
        search: on tests and references.
        result: of the search.

    Returns:
        At most one difference of each reference, the most probable first.
    """
    evidence = search.evidence
    if len(evidence.references) < FEWEST:
        return []
    odd, best = [], result.best.score
    least = best - search.rules.posterior.alike
    likely = [hypothesis for hypothesis in result.hypotheses if hypothesis.score >= least]
    for number in range(len(evidence.references)):
        log = len(evidence.signals) + number
        only = (evidence.samples.log[evidence.samples.part] == log).astype(float)
        traces = _traces_in(search, only)
        proposer = Proposer(evidence, search.rules, traces, search.threads)
        fits = HypothesisFit(evidence, search.rules, traces, search.count, search.threads, only)
        beside = [
            difference
            for hypothesis in (likely if traces else ())
            if (difference := _beside(search, proposer, fits, hypothesis, number)) is not None
        ]
        odd += sorted(beside, key=lambda difference: -difference.odds)[:1]
    odd = [replace(difference, odds=difference.odds - best) for difference in odd]
    odd.sort(key=lambda difference: (-difference.odds, difference.reference))
    return [difference for difference in odd if difference.odds > 0]


def _beside(
    search: Search, proposer: Proposer, fits: HypothesisFit, hypothesis: Hypothesis, number: int
) -> Difference | None:
    """Fit the most promising effect in one reference beside a hypothesis.

    Args:
        search: on tests and references.
        proposer: of effects that act in the reference alone.
        fits: of effects that act in the reference alone.
        hypothesis: about tests and references.
        number: place among the references.

    Returns:
        The difference, with the log posterior probability of both [nat] as its odds; None where
        nothing shows there.
    """
    evidence = search.evidence
    scales = limited_scales(evidence, hypothesis.scales, search.rules)
    proposal = next(iter(proposer.proposals(hypothesis.causes, scales)), None)
    if proposal is None:
        return None
    candidate = fits.candidate(proposal, hypothesis)
    if candidate is None:
        return None
    fitted = search.fits.fit((*hypothesis.candidates, candidate), hypothesis.scales)
    place = len(fitted.causes) - 1
    tried = len(search.count) * search.count[proposal.effect] * len(evidence.references)
    chance = float(np.log(search.rules.cause.changed / tried))
    together = fitted.log_evidence + hypothesis.log_prior + chance
    log = evidence.references[number].log.name
    cause = fitted.causes[place]
    return Difference(number, log, cause, fitted.values(place), fitted.deviation(place), together)


def _traces_in(search: Search, only: np.ndarray) -> dict[Name, Traces]:
    """Effects that act in one log alone, where this log shows them."""
    evidence = search.evidence
    traces: dict[Name, Traces] = {}
    for (effect, location, standing), traced in search.traces.items():
        weighed = WEIGHED[effect]
        if not standing or weighed.flexible or weighed.built:
            continue
        own: Traces
        if isinstance(traced, list):
            own = [evidence.on_all_samples(c, False, only) for c in traced if not c.factors]
            shown = [cause.columns for cause in own]
        elif isinstance(traced, Starts) and not (weighed.scales or weighed.holds_back):
            own = cut = replace(traced, compact=traced.compact.multiply(only[None]).tocsr())
            shown = [cut.traces]
        else:
            continue
        if any(reach(evidence.samples, columns) >= SHOWN for columns in shown):
            traces[effect, location, False] = own
    return traces
