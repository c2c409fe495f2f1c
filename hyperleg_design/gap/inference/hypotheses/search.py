"""The search for the hypotheses with the largest posterior probability: no cause, each effect at
each place, an effect at all of its places, and sets of them by forward and backward steps.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.inference.assembly import Evidence
from hyperleg_design.gap.inference.effect_traces import NotJudged, Traces, traces_of
from hyperleg_design.gap.inference.hypotheses.cause_prior import log_chance
from hyperleg_design.gap.inference.hypotheses.everywhere import at_all_places
from hyperleg_design.gap.inference.hypotheses.hypothesis import (
    EVERYWHERE,
    Candidate,
    Hypothesis,
    Name,
)
from hyperleg_design.gap.inference.hypotheses.hypothesis_fit import HypothesisFit, are_near
from hyperleg_design.gap.inference.hypotheses.limited_scales import limited_scales
from hyperleg_design.gap.inference.hypotheses.proposals import Proposal, Proposer
from hyperleg_design.gap.inference.hypotheses.relinearisation import on_other_evidence, relinearised
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.inference.threads import spread


@dataclass(frozen=True, eq=False)
class Result:
    """All hypotheses that were fitted, best first."""

    hypotheses: tuple[Hypothesis, ...]
    not_judged: tuple[NotJudged, ...]

    @property
    def best(self) -> Hypothesis:
        """The one with the largest posterior probability."""
        return self.hypotheses[0]


class Search:
    """Hypotheses on one body of evidence.

    Args:
        evidence: channels.
        rules: of the inference.
        places: effects and locations that are tried.
        threads: that share the work; they change no result.
        show: takes lines of progress.
        traces: of the effects, of a search on logs that differ in residuals alone.
    """

    def __init__(
        self,
        evidence: Evidence,
        rules: InferenceRules,
        places: Sequence[tuple[str, str]],
        threads: int = 1,
        show: Callable[[str], None] | None = None,
        traces: dict[Name, Traces] | None = None,
    ) -> None:
        self.show = show or (lambda _: None)
        self.evidence, self.rules, self.threads = evidence, rules, threads
        self.count = {name: sum(e == name for e, _ in places) for name, _ in places}
        self.traces = traces_of(evidence, places, threads) if traces is None else traces
        self.fits = HypothesisFit(evidence, rules, self.traces, self.count, threads)
        self.proposer = Proposer(evidence, rules, self.traces, threads)
        self.fitted: dict[tuple[Name, ...], Hypothesis] = {(): self.fits.null}
        """By the names of their candidates."""
        self._needed: dict[tuple[Name, ...], tuple[float, float]] = {}
        """Of causes that lowered the score when they were fitted last beside others at their place:
        the predicted change of the score that would have been enough, and the score of the
        hypothesis beside which they were fitted [nat]."""

    def result(self, begun: Hypothesis | None = None) -> Result:
        """Search forward until no further cause is worth its prior, dropping what is not, and put
        others in the place of each.

        Args:
            begun: the hypothesis that the search begins with; none by default.

        Returns:
            The hypotheses that were fitted.
        """
        self._grown(begun or self.fits.null, [])
        return self._result()

    def settled(self, best: Hypothesis) -> Result:
        """Compare the causes of what a search ended in with all rivals at their places, and go on
        from what is better.

        Args:
            best: the best hypothesis of `result`.

        Returns:
            The hypotheses that were fitted.
        """
        while True:
            better = self._with_rivals_at_each_place(best)
            if better is best:
                better = self._without_unlisted(best)
            if better is best:
                return self._result()
            best = self._grown(*self._without_needless(better))

    def _grown(self, current: Hypothesis, smaller: list[Hypothesis]) -> Hypothesis:
        """Extend a hypothesis, or put a cause in the place of another one, while it gains.

        Args:
            current: the hypothesis.
            smaller: those that lack one of its candidates each; empty where they are not known.
        """
        while True:
            best = self._improved(self.extended(current), current)
            if best is current and len(current.candidates) > 1:
                smaller = smaller or self._each_removed(current)
                for removed, rest in zip(current.candidates, smaller, strict=True):
                    best = self._improved(self.extended(rest, removed), best)
            if best is current:
                return current
            current, smaller = self._without_needless(best)

    def _without_needless(self, best: Hypothesis) -> tuple[Hypothesis, list[Hypothesis]]:
        """Drop a cause that is not worth its prior any more beside the last one; with the
        hypotheses that lack one cause each, where none is dropped.
        """
        self.show(f"causes so far: {', '.join(_in_words(c) for c in best.candidates)}")
        smaller = self._each_removed(best)
        fewer = self._improved(smaller[:-1], best)
        return (best, smaller) if fewer is best else (fewer, [])

    def _result(self) -> Result:
        """All hypotheses that were fitted, best first."""
        ranked = sorted(self.fitted.values(), key=lambda fitted: (-fitted.score, fitted.names))
        missing = tuple(
            traced
            for (*_, standing), traced in self.traces.items()
            if isinstance(traced, NotJudged) and not standing
        )
        return Result(tuple(ranked), missing)

    def begun_like(self, similar: Hypothesis) -> Hypothesis:
        """Fit the causes of a hypothesis on about the same evidence, and drop what is not worth its
        prior.

        Args:
            similar: the best hypothesis on the other evidence.

        Returns:
            The best hypothesis of some or all of these causes.
        """
        best = self._improved([on_other_evidence(self.fits, similar)], self.fits.null)
        while best.candidates:
            smaller = self._improved(self._each_removed(best), best)
            if smaller is best:
                break
            best = smaller
        return best

    def _improved(self, others: Sequence[Hypothesis], current: Hypothesis) -> Hypothesis:
        """The best of a current hypothesis and others. Others with a larger score are linearised
        again first; all are recorded.
        """
        for hypothesis in sorted(others, key=lambda other: -other.score):
            if hypothesis.score > current.score:
                hypothesis = relinearised(self.fits, hypothesis)
            self.fitted[hypothesis.names] = hypothesis
            current = max(current, hypothesis, key=lambda other: other.score)
        return current

    def _with_rivals_at_each_place(self, current: Hypothesis) -> Hypothesis:
        """Fit the other effects at the place of causes under test in their stead, the others as
        they are, so that rivals at one place are compared on the same footing; and beside the
        likeliest of them a second one there, as friction of two kinds may gain only together.
        """
        best = current
        places = [c.location for c in current.candidates if not c.standing]
        for place in dict.fromkeys(place for place in places if place != EVERYWHERE):
            there = [c for c in current.candidates if c.location == place and not c.standing]
            others = tuple(c for c in current.candidates if c not in there)
            rivals = self.extended(self._reduced(others, current), at=place)
            best = self._improved(rivals, best)
            taken = {c.name for c in there} if len(there) == 1 else set()
            likely = [rival for rival in rivals if not taken.intersection(rival.names)]
            likely.sort(key=lambda rival: (-rival.score, rival.names))
            for rival in likely[: self.rules.search.pairs]:
                pairs = self.extended(rival, at=place, flexible=False)
                best = self._improved(pairs, best)
        return best

    def _without_unlisted(self, current: Hypothesis) -> Hypothesis:
        """Search without the flexible effects of a hypothesis, which take what several causes of
        the catalogue leave together before any of these has been tried beside another.

        Args:
            current: the hypothesis.

        Returns:
            What the search ends in, if better; else the current hypothesis.
        """
        rest = tuple(c for c in current.candidates if not WEIGHED[c.effect].flexible)
        if len(rest) == len(current.candidates):
            return current
        best = self._known(rest) or self.fits.fit(rest, current.scales)
        while True:
            tried = self.extended(best, flexible=False)
            better = self._improved(tried, best)
            if better is best and tried:  # two causes may gain only beside one another
                likeliest = max(tried, key=lambda fitted: fitted.score)
                better = self._improved(self.extended(likeliest, flexible=False), best)
            if better is best:
                return max(current, best, key=lambda fitted: fitted.score)
            best = better

    def _each_removed(self, current: Hypothesis) -> list[Hypothesis]:
        """The hypotheses that lack one candidate of a hypothesis each."""
        some = current.candidates
        return [
            self._reduced(some[:place] + some[place + 1 :], current) for place in range(len(some))
        ]

    def _reduced(self, candidates: tuple[Candidate, ...], current: Hypothesis) -> Hypothesis:
        """The hypothesis of some of the candidates of another one, which is recorded."""
        smaller = self._known(candidates) or self.fits.fit(candidates, current.scales)
        self.fitted[smaller.names] = smaller
        return smaller

    def _known(self, candidates: Sequence[Candidate | Proposal]) -> Hypothesis | None:
        """The hypothesis of some candidates, where it was fitted before."""
        return self.fitted.get(tuple(sorted(candidate.name for candidate in candidates)))

    def extended(
        self,
        current: Hypothesis,
        instead: Candidate | None = None,
        at: str = "",
        flexible: bool = True,
    ) -> list[Hypothesis]:
        """Extend a hypothesis by each of the causes whose predicted gains are largest.

        Args:
            current: the hypothesis.
            instead: a candidate that they are to replace: only causes that gain more are fitted.
            at: location of the causes that are tried; by default all locations, and effects at
                all of their places together.
            flexible: whether effects that the catalogue lacks are among them.

        Returns:
            The extended hypotheses, fitted.
        """
        rules = self.rules.search
        proposals: dict[Name, list[Proposal]] = {}
        scales = limited_scales(self.evidence, current.scales, self.rules)
        for proposal in self.proposer.proposals(current.causes, scales, at):
            if self._may_grow(current, proposal.standing):
                proposals.setdefault(proposal.name, []).append(proposal)
        names = sorted(proposals, key=lambda name: (-proposals[name][0].gain, name))
        if not names:
            return []
        gains = {name: proposals[name][0].gain for name in names}
        groups = [] if at else at_all_places(self.fits, proposals, current)
        gains |= {group.name: gain for gain, group in groups}
        least = rules.least
        if instead is not None:
            least = max(least, gains.get(instead.name, least))
        promising = [name for name in names if gains[name] > least]
        unlisted = [name for name in promising if WEIGHED[name[0]].flexible]
        chosen = [name for name in promising if name not in unlisted][: rules.candidates]
        chosen += unlisted[: rules.flexible if flexible else 0]
        chosen = [name for name in chosen if self._worth_fitting(proposals[name], current)]
        fitted = spread(
            lambda name: self.best_start(proposals[name][: rules.starts], current),
            chosen,
            self.threads,
        )
        hypotheses = [hypothesis for hypothesis in fitted if hypothesis is not None]
        hypotheses += [
            self._known((*current.candidates, group))
            or self.fits.fit((*current.candidates, group), current.scales)
            for gain, group in groups[: rules.groups]
            if gain > least
        ]
        return hypotheses

    def _may_grow(self, current: Hypothesis, standing: bool) -> bool:
        """Whether a hypothesis may have one more cause in all logs, or under test alone."""
        most = self.rules.search.standing if standing else self.rules.search.causes
        return sum(c.standing == standing for c in current.candidates) < most

    def _worth_fitting(self, proposals: Sequence[Proposal], current: Hypothesis) -> bool:
        """Whether a cause that lowered the score when it was fitted last may raise it now: its
        predicted gain is larger than then, or the hypothesis has gained since what it lacked.
        """
        if self._known((*current.candidates, proposals[0])) is not None:
            return True
        enough, score = self._needed.get(_names_at_place(proposals[0], current), (-np.inf, 0.0))
        since = max(current.score - score, 0.0)
        return self._predicted_change(proposals[0], current) + since > enough

    def _predicted_change(self, proposal: Proposal, current: Hypothesis) -> float:
        """The predicted change of the score by a cause beside those of a hypothesis: its gain, and
        the prior probability that it acts there beside them [nat].
        """
        names = [candidate.name for candidate in current.candidates]
        chances = [
            log_chance(some, self.evidence, self.rules, self.count)
            for some in (names, sorted([*names, proposal.name]))
        ]
        return proposal.gain + chances[1] - chances[0]

    def best_start(self, proposals: Sequence[Proposal], current: Hypothesis) -> Hypothesis | None:
        """Fit an effect at a place beside a hypothesis from several starts.

        Args:
            proposals: the starts; of a linear effect the variants, of which the best are fitted,
                and one of a flexible function.
            current: the hypothesis.

        Returns:
            The best fit; None where no log shows the effect.
        """
        known = self._known((*current.candidates, proposals[0]))
        if known is not None:
            return known
        effect = WEIGHED[proposals[0].effect]
        if effect.linear:
            proposals = proposals[: 1 if effect.flexible else self.rules.search.starts]
        optima: list[Candidate] = []
        for proposal in proposals:
            candidate = self.fits.candidate(proposal, current)
            if candidate and not any(self._alike(candidate, other) for other in optima):
                optima.append(candidate)
        fits_of_starts = [
            self.fits.fit((*current.candidates, optimum), current.scales) for optimum in optima
        ]
        best = max(fits_of_starts, key=lambda fitted: fitted.score, default=None)
        self._needed.pop(_names_at_place(proposals[0], current), None)
        if best is not None and best.score < current.score:
            enough = self._predicted_change(proposals[0], current) + current.score - best.score
            self._needed[_names_at_place(proposals[0], current)] = enough, current.score
        return best

    def _alike(self, first: Candidate, second: Candidate) -> bool:
        """Whether an effect at a place is linearised at about the same values twice."""
        least = self.rules.search.converged
        return all(
            are_near(a.values, b.values, a.usual, least)
            for a, b in zip(first.causes, second.causes, strict=True)
        )


def _in_words(candidate: Candidate) -> str:
    place = "all places" if candidate.location == EVERYWHERE else candidate.location
    return f"{candidate.effect} at {place}{' (in all logs)' if candidate.standing else ''}"


def _names_at_place(proposal: Proposal, current: Hypothesis) -> tuple[Name, ...]:
    """Name of a cause, and those of a hypothesis at the same place."""
    return proposal.name, *(name for name in current.names if name[1] == proposal.location)
