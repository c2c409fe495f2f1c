"""Reference logs that differ from one another by an effect of the catalogue, and references without
what sets one apart.

Each reference is looked at as if it were under test: an effect that acts in it alone is fitted
beside the most probable hypotheses. Effects that scale torques are not tried: their likelihood is
that of the logs under test.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hyperleg_design.gap.effects import EFFECTS, WEIGHED
from hyperleg_design.gap.inference import screen
from hyperleg_design.gap.inference.assembly import Evidence
from hyperleg_design.gap.inference.channels.crossing import Crossing
from hyperleg_design.gap.inference.fit import Cause
from hyperleg_design.gap.inference.hypothesis import Candidate, Hypothesis, Name, Stack
from hyperleg_design.gap.inference.hypothesis_fit import eased
from hyperleg_design.gap.inference.promises import Promise, Promises
from hyperleg_design.gap.inference.search import Result, Search
from hyperleg_design.gap.signals.signals import Signals

FEWEST = 2
"""References that can differ."""
BESIDE = 4
"""Most probable hypotheses beside which references are looked at: where one has what the logs under
test have, the model may seem to lack it."""


@dataclass(frozen=True, eq=False)
class Difference:
    """An effect that acts in one reference and not in the others."""

    reference: int
    """Place among the references."""
    log: str
    """Its name."""
    effect: str
    location: str
    values: np.ndarray
    """Of the effect's parameters."""

    def taken_out(self, references: Sequence[Signals]) -> list[Signals]:
        """References without what this effect leaves in one of them.

        Args:
            references: all of them, in their order.

        Returns:
            The same, one of them changed.
        """
        odd = references[self.reference]
        traces = EFFECTS[self.effect].trace(odd, self.location, self.values[None])
        residual = {
            name: rows - traces[name][0] if name in traces else rows
            for name, rows in odd.residual.items()
        }
        before, after = references[: self.reference], references[self.reference + 1 :]
        return [*before, replace(odd, residual=residual), *after]

    @property
    def text(self) -> str:
        """Say so in one sentence."""
        numbers = zip(EFFECTS[self.effect].parameters, self.values.tolist(), strict=True)
        stated = ", ".join(
            f"{parameter.name} {value:.3g} {parameter.unit}".strip()
            for parameter, value in numbers
            if value != parameter.null and not parameter.shape
        )
        return (
            f"{self.log}: differs from the other reference logs by {self.effect} at "
            f"{self.location} ({stated}), which was taken out of it"
        )


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
    odd = []
    for number in range(len(evidence.references)):
        log = len(evidence.signals) + number
        mask = (evidence.samples.log[evidence.samples.part] == log).astype(float)
        traces = _traces_in(search, mask)
        promises = Promises(evidence, search.rules, traces, search.threads)
        beside = [
            _beside(search, promises, one, mask, number) for one in result.hypotheses[:BESIDE]
        ]
        own = [(score, difference) for pair in beside if pair for score, difference in [pair]]
        score, difference = max(own, key=lambda pair: pair[0], default=(-np.inf, None))
        if difference is not None and score > result.best.score:
            odd.append((score, difference))
    odd.sort(key=lambda pair: (-pair[0], pair[1].reference))
    return [difference for _, difference in odd]


def _beside(
    search: Search, promises: Promises, hypothesis: Hypothesis, mask: np.ndarray, number: int
) -> tuple[float, Difference] | None:
    """Fit the most promising effect in one reference beside a hypothesis.

    Args:
        search: on tests and references.
        promises: of effects that act in the reference alone.
        hypothesis: about tests and references.
        mask: 1 at the samples of the reference, 0 elsewhere `(S,)`.
        number: place among the references.

    Returns:
        Log posterior probability of both together [nat], and the difference; None where nothing
        shows there.
    """
    scales = eased(search.evidence, hypothesis.scales, search.rules)
    for promise in promises.beside(hypothesis.causes, scales)[:1] if promises.traces else ():
        cause = _linearised(search, hypothesis, promise, promises.traces[promise.name], mask)
        if cause is None:
            return None
        candidate = Candidate(promise.effect, promise.location, (cause,))
        fitted = search.fits.fit((*hypothesis.candidates, candidate), hypothesis.scales)
        values = fitted.values(len(fitted.causes) - 1)
        name = search.evidence.references[number].log.name
        difference = Difference(number, name, promise.effect, promise.location, values)
        tried = len(search.count) * search.count[promise.effect] * len(search.evidence.references)
        chance = float(np.log(search.rules.cause.changed / tried))
        return fitted.log_evidence + hypothesis.log_prior + chance, difference
    return None


def _traces_in(search: Search, mask: np.ndarray) -> dict[Name, screen.Traces]:
    """Effects that act in one log alone, where this log shows them."""
    evidence = search.evidence
    traces: dict[Name, screen.Traces] = {}
    for (effect, location, standing), traced in search.traces.items():
        weighed = WEIGHED[effect]
        if not standing or weighed.flexible:
            continue
        own: screen.Traces
        if isinstance(traced, list):
            own = [_cut(evidence, cause, mask) for cause in traced if not cause.factors]
            shown = [cause.columns for cause in own]
        elif isinstance(traced, screen.Starts) and not (weighed.scales or weighed.holds_back):
            own = cut = replace(traced, columns=traced.columns * mask)
            shown = [cut.traces]
        else:
            continue
        if any(screen.reach(evidence.samples, columns) >= screen.SHOWN for columns in shown):
            traces[effect, location, False] = own
    return traces


def _cut(evidence: Evidence, cause: Cause, mask: np.ndarray) -> Cause:
    """A cause in one log alone."""
    constant = cause.constant * mask if len(cause.constant) else cause.constant
    cut = replace(cause, columns=cause.columns * mask, constant=constant, factors=())
    return replace(evidence.acting(cut, False), factors=())


def _linearised(
    search: Search,
    hypothesis: Hypothesis,
    promise: Promise,
    traced: screen.Traces,
    mask: np.ndarray,
) -> Cause | None:
    """An effect in one log, linearised where it fits best beside a hypothesis."""
    if isinstance(traced, list):
        return traced[promise.variant]
    evidence, effect = search.evidence, WEIGHED[promise.effect]
    scales = eased(evidence, hypothesis.scales, search.rules)
    values, cause = np.array(promise.values), None
    for _ in range(search.rules.search.steps):
        linear = screen.linearise(evidence.samples, effect, promise.location, values)
        if linear is None:
            break
        cause = _cut(evidence, linear, mask)
        stack = Stack.of((*hypothesis.causes, cause), evidence.weight)
        crossing = Crossing.of(evidence.channels, stack.rows)
        sizes = search.fits.at_scales(stack, crossing, scales).theta[-len(cause.nulls) :]
        values = np.clip(cause.nulls + sizes * cause.usual, cause.low, cause.high)
    return cause
