"""Judge conditioned logs: search for hypotheses, compare the references with one another, and make
the answer.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from hyperleg_design.gap.checks.check import Check
from hyperleg_design.gap.inference.assembly import evidence_of
from hyperleg_design.gap.inference.cross_validation import predicted
from hyperleg_design.gap.inference.detectable import detectable
from hyperleg_design.gap.inference.gap_size import GapSize
from hyperleg_design.gap.inference.hypotheses.hypothesis import Hypothesis
from hyperleg_design.gap.inference.hypotheses.reference_differences import (
    FEWEST,
    Difference,
    differences,
)
from hyperleg_design.gap.inference.hypotheses.search import Search
from hyperleg_design.gap.inference.posterior import changes_first, posterior_of
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.pipeline.answer import Answer
from hyperleg_design.gap.results.diagnosis import Diagnosis
from hyperleg_design.gap.signals.signals import Signals


def judge_signals(
    signals: Sequence[Signals],
    references: Sequence[Signals],
    places: Sequence[tuple[str, str]],
    rules: InferenceRules,
    *,
    seed: int = 0,
    threads: int = 1,
    checks: Sequence[Check] = (),
    show: Callable[[str], None] | None = None,
) -> Diagnosis:
    """Diagnose conditioned logs by the posterior of the hypotheses.

    Args:
        signals: of logs under test.
        references: of logs of the healthy robot.
        places: effects and locations that are tried.
        rules: of the inference.
        seed: of the bootstrap.
        threads: that share the work; they change no result.
        checks: of the logs, for remarks.
        show: takes lines of progress.

    Returns:
        The diagnosis.
    """
    say = show or (lambda _: None)
    search = Search(evidence_of(signals, references, rules), rules, places, threads, say)
    result = search.result()
    apart: list[Difference] = []
    while len(apart) < len(references) - 1 and (odd := differences(search, result)):
        say("one reference differs from the others: searching again without what it has")
        tried = []
        for difference in odd if len(references) == FEWEST else odd[:1]:
            own = evidence_of(signals, difference.taken_out(references), rules)
            other = Search(own, rules, places, threads, say, search.traces)
            tried.append((difference, other, other.begun_like(result.best)))
        # of two references that differ, either may be wrong: take the one without which the causes
        # under test gain less
        difference, search, begun = min(tried, key=lambda entry: _gain(*entry[1:]))
        result, references = search.result(begun), search.evidence.references
        apart.append(difference)
    result = search.settled(result.best)
    evidence, result = search.evidence, changes_first(result, rules)
    held = predicted(evidence, result.best, rules)
    size = GapSize.of(evidence, result.best, held, rules)
    posterior = posterior_of(result, evidence, size, rules)
    answer = Answer(evidence, result, posterior, size, rules, seed, apart)
    # a gap that causes explain hides no other fault, one that nothing explains does
    beside = search.fits.null if posterior.verdict == "unknown" else posterior.hypothesis
    sensitivity = tuple(entry.mapping() for entry in detectable(search, beside))
    return answer.diagnosis(checks, sensitivity)


def _gain(search: Search, hypothesis: Hypothesis) -> float:
    """What a hypothesis gains over the null hypothesis [nat]."""
    return hypothesis.score - search.fits.null.score
