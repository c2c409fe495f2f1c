"""The search for the hypotheses with the largest posterior probability: nothing, each effect at
each place, an effect at all of its places, and sets of them by forward and backward steps.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.inference import screen
from hyperleg_design.gap.inference.assembly import Evidence
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.cause_prior import log_chance
from hyperleg_design.gap.inference.channels.crossing import Crossing
from hyperleg_design.gap.inference.channels.scales import Scales
from hyperleg_design.gap.inference.endogenous import Factor
from hyperleg_design.gap.inference.hypothesis import EVERYWHERE, Candidate, Hypothesis, Name, Stack
from hyperleg_design.gap.inference.hypothesis_fit import CLOSE, HypothesisFit, eased
from hyperleg_design.gap.inference.promises import Promise, Promises
from hyperleg_design.gap.inference.rules import InferenceRules


@dataclass(frozen=True, eq=False)
class Result:
    """All hypotheses that were fitted, best first."""

    hypotheses: tuple[Hypothesis, ...]
    not_judged: tuple[screen.NotJudged, ...]

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
    """

    def __init__(
        self,
        evidence: Evidence,
        rules: InferenceRules,
        places: Sequence[tuple[str, str]],
        threads: int = 1,
    ) -> None:
        self.evidence, self.rules, self.threads = evidence, rules, threads
        self.count = {name: sum(e == name for e, _ in places) for name, _ in places}
        self.traces = traces_of(evidence, places, threads)
        self.fits = HypothesisFit(evidence, rules, self.traces, self.count, threads)
        self.promises = Promises(evidence, rules, self.traces, threads)
        self.fitted: dict[tuple[Name, ...], Hypothesis] = {(): self.fits.nothing}
        """By the names of their candidates."""
        self._short: dict[tuple[Name, ...], tuple[float, float]] = {}
        """Of causes that were worse than none when they were fitted last beside others at their
        place: the promise that would have been enough, and the score of the hypothesis beside
        which they were fitted [nat]."""

    def result(self) -> Result:
        """Search forward until no further cause is worth its prior, drop what is not, and put
        others in the place of each.
        """
        current = self.fits.nothing
        fewer: list[Hypothesis] = []
        while True:
            best = self._better(self.further(current), current)
            if best is current and len(current.candidates) > 1:
                fewer = fewer or self._fewer(current)
                for one, rest in zip(current.candidates, fewer, strict=True):
                    best = self._better(self.further(rest, one), best)
            if best is current:
                best = self._beside_rivals(current)
            if best is current:
                best = self._listed(current)
            if best is current:
                break
            current, fewer = best, self._fewer(best)
            best = self._better(fewer[:-1], current)
            if best is not current:
                current, fewer = best, []
        ranked = sorted(self.fitted.values(), key=lambda one: (-one.score, one.names))
        missing = tuple(
            traced
            for (*_, standing), traced in self.traces.items()
            if isinstance(traced, screen.NotJudged) and not standing
        )
        return Result(tuple(ranked), missing)

    def _better(self, found: Sequence[Hypothesis], current: Hypothesis) -> Hypothesis:
        """The best of some hypotheses, if better than a current one; all are kept. What would be
        better is settled first.
        """
        for hypothesis in sorted(found, key=lambda any_: -any_.score):
            if hypothesis.score > current.score:
                hypothesis = self.fits.settled(hypothesis)
            self.fitted[hypothesis.names] = hypothesis
            current = max(current, hypothesis, key=lambda any_: any_.score)
        return current

    def _beside_rivals(self, current: Hypothesis) -> Hypothesis:
        """Fit what else may act where each cause under test does, the others as they are, so that
        rivals at its place are compared on the same footing.
        """
        best = current
        for one, rest in zip(current.candidates, self._fewer(current), strict=True):
            if not one.standing and one.location != EVERYWHERE:
                best = self._better(self.further(rest, at=one.location), best)
        return best

    def _listed(self, current: Hypothesis) -> Hypothesis:
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
            tried = self.further(best, flexible=False)
            more = self._better(tried, best)
            if more is best and tried:  # two causes may gain only beside one another
                likeliest = max(tried, key=lambda any_: any_.score)
                more = self._better(self.further(likeliest, flexible=False), best)
            if more is best:
                return max(current, best, key=lambda any_: any_.score)
            best = more

    def _fewer(self, current: Hypothesis) -> list[Hypothesis]:
        """A hypothesis without each of its candidates."""
        smaller = []
        for place in range(len(current.candidates)):
            rest = current.candidates[:place] + current.candidates[place + 1 :]
            smaller.append(self._known(rest) or self.fits.fit(rest, current.scales))
            self.fitted[smaller[-1].names] = smaller[-1]
        return smaller

    def _known(self, candidates: Sequence[Candidate | Promise]) -> Hypothesis | None:
        """The hypothesis of some candidates, where it was fitted before."""
        return self.fitted.get(tuple(sorted(one.name for one in candidates)))

    def further(
        self,
        current: Hypothesis,
        instead: Candidate | None = None,
        at: str = "",
        flexible: bool = True,
    ) -> list[Hypothesis]:
        """Fit the most promising causes beside those of a hypothesis.

        Args:
            current: the hypothesis.
            instead: a candidate whose place they are to take: only those that promise more.
            at: location of those that are tried; all by default, and effects at all of theirs.
            flexible: whether effects that the catalogue lacks are among them.
        """
        rules = self.rules.search
        promises: dict[Name, list[Promise]] = {}
        scales = eased(self.evidence, current.scales, self.rules)
        for one in self.promises.beside(current.causes, scales):
            if self._room(current, one.standing):
                promises.setdefault(one.name, []).append(one)
        names = sorted(promises, key=lambda name: (-promises[name][0].gain, name))
        if not names:
            return []
        gains = {name: promises[name][0].gain for name in names}
        groups = [] if at else self.everywhere(promises, current)
        gains |= {one.name: gain for gain, one in groups}
        least = rules.least
        if instead is not None:
            least = max(least, gains.get(instead.name, least))
        promising = [name for name in names if gains[name] > least and at in ("", name[1])]
        unlisted = [name for name in promising if WEIGHED[name[0]].flexible]
        chosen = [name for name in promising if name not in unlisted][: rules.candidates]
        chosen += unlisted[: rules.flexible if flexible else 0]
        chosen = [name for name in chosen if self._hopeful(promises[name], current)]
        fitted = screen.spread(
            lambda name: self.best_of(promises[name][: rules.starts], current), chosen, self.threads
        )
        hypotheses = [one for one in fitted if one is not None]
        hypotheses += [
            self._known((*current.candidates, one))
            or self.fits.fit((*current.candidates, one), current.scales)
            for gain, one in groups[: rules.groups]
            if gain > least
        ]
        return hypotheses

    def _room(self, current: Hypothesis, standing: bool) -> bool:
        """Whether a hypothesis may have one more cause in all logs, or under test alone."""
        most = self.rules.search.standing if standing else self.rules.search.causes
        return sum(one.standing == standing for one in current.candidates) < most

    def _hopeful(self, promises: Sequence[Promise], current: Hypothesis) -> bool:
        """Whether a cause that was worse than none when it was fitted last may be worth its prior
        now: it promises more than then, or what has been gained since is what it lacked.
        """
        if self._known((*current.candidates, promises[0])) is not None:
            return True
        enough, score = self._short.get(_at_place(promises[0], current), (-np.inf, 0.0))
        return self._promised(promises[0], current) + max(current.score - score, 0.0) > enough

    def _promised(self, promise: Promise, current: Hypothesis) -> float:
        """What a cause promises beside those of a hypothesis, with the chance that it acts there
        beside them [nat].
        """
        names = [candidate.name for candidate in current.candidates]
        chances = [
            log_chance(some, self.evidence, self.rules, self.count)
            for some in (names, sorted([*names, promise.name]))
        ]
        return promise.gain + chances[1] - chances[0]

    def best_of(self, promises: Sequence[Promise], current: Hypothesis) -> Hypothesis | None:
        """Fit an effect at a place beside a hypothesis from several starts.

        Args:
            promises: the starts, or the best variant of a linear effect.
            current: the hypothesis.

        Returns:
            The best fit; None where no log shows the effect.
        """
        known = self._known((*current.candidates, promises[0]))
        if known is not None:
            return known
        linear = WEIGHED[promises[0].effect].linear
        apart: list[Candidate] = []
        for promise in promises[: 1 if linear else None]:
            candidate = self.fits.candidate(promise, current)
            if candidate and not any(_alike(candidate, other) for other in apart):
                apart.append(candidate)
        fits_of_starts = [
            self.fits.fit((*current.candidates, one), current.scales) for one in apart
        ]
        best = max(fits_of_starts, key=lambda one: one.score, default=None)
        self._short.pop(_at_place(promises[0], current), None)
        if best is not None and best.score < current.score:
            enough = self._promised(promises[0], current) + current.score - best.score
            self._short[_at_place(promises[0], current)] = enough, current.score
        return best

    def everywhere(
        self, promises: Mapping[Name, Sequence[Promise]], current: Hypothesis
    ) -> list[tuple[float, Candidate]]:
        """Join linear effects at all of their places, and compute what they gain beside a
        hypothesis at its scales.

        Args:
            promises: of effects at single places.
            current: the hypothesis.

        Returns:
            Gains [nat] and candidates, best first.
        """
        scales = eased(self.evidence, current.scales, self.rules)
        acting = {(one.effect, one.standing) for one in current.candidates}
        start, joined_effects = 0.0, []
        if current.causes:
            start = self._gain(current.causes, scales)
        for effect, standing in sorted({(name[0], name[2]) for name in promises} - acting):
            effect_tried = WEIGHED[effect]
            if not effect_tried.linear or effect_tried.flexible or self.count[effect] < 2:
                continue
            own = sorted(name for name in promises if (name[0], name[2]) == (effect, standing))
            causes = [self.fits.candidate(promises[name][0], current) for name in own]
            joined = tuple(ungaining(c) for one in causes if one is not None for c in one.causes)
            if len(joined) < 2:
                continue
            one = Candidate(effect, EVERYWHERE, joined)
            joined_effects.append((self._gain((*current.causes, *joined), scales) - start, one))
        return sorted(joined_effects, key=lambda entry: (-entry[0], *entry[1].name))

    def _gain(self, causes: Sequence[Cause], scales: Sequence[Scales]) -> float:
        """What causes gain at fixed scales [nat]."""
        stack = Stack.of(causes, self.evidence.weight)
        crossing = Crossing.of(self.evidence.channels, stack.rows)
        return self.fits.at_scales(stack, crossing, scales).gain


def _at_place(promise: Promise, current: Hypothesis) -> tuple[Name, ...]:
    """Name of a cause, and those of a hypothesis at the same place."""
    return promise.name, *(name for name in current.names if name[1] == promise.location)


def _alike(one: Candidate, other: Candidate) -> bool:
    """Whether an effect at a place is linearised at about the same values twice."""
    return all(
        bool(np.all(np.abs(a.values - b.values) < CLOSE * a.usual))
        for a, b in zip(one.causes, other.causes, strict=True)
    )


def traces_of(
    evidence: Evidence, places: Sequence[tuple[str, str]], threads: int
) -> dict[Name, screen.Traces]:
    """What each effect leaves at each place in the logs under test and, with references, in all
    logs.

    Args:
        evidence: channels.
        places: effects and locations.
        threads: that share the work.
    """
    traced = screen.spread(lambda place: _traced(evidence, place), places, threads)
    by_name: dict[Name, screen.Traces] = {}
    for (effect, location), both in zip(places, traced, strict=True):
        for standing, one in zip((False, True), both, strict=False):
            by_name[effect, location, standing] = one
    return by_name


def _traced(evidence: Evidence, place: tuple[str, str]) -> list[screen.Traces]:
    """In the logs under test and, with references, in all logs."""
    flexible = WEIGHED[place[0]].flexible
    samples = evidence.tests if flexible else evidence.samples
    whole = screen.trace(samples, WEIGHED[place[0]], place[1])
    if isinstance(whole, screen.NotJudged):
        return [whole] * (2 if evidence.references and not flexible else 1)
    count = len(evidence.tests.value)
    own: screen.Traces
    if isinstance(whole, list):
        own = [
            evidence.acting(cut, False)
            for one in whole
            if (cut := screen.under_test(one, evidence.tests)) is not None
        ]
        whole = [evidence.acting(one, True) for one in whole]
    else:
        own = replace(whole, columns=whole.columns[:, :count])
        if screen.reach(evidence.tests, own.traces) < screen.SHOWN:
            own = []
    if not own:
        own = screen.NotJudged(*place, screen.UNEXCITED)
    return [own, whole] if evidence.references and not flexible else [own]


def ungaining(cause: Cause) -> Cause:
    """Keep a cause from gaining by larger torques.

    Where an effect scales the torques at all of its places, masses and friction may be larger by as
    much, and the gain would be noise that is nearer to the expected one.

    Args:
        cause: the effect at one place.

    Returns:
        The cause, whose terms of the likelihood charge for smaller torques alone.
    """
    if not cause.factors:
        return cause
    factors = (
        replace(term, shows=0.0) if isinstance(term, Factor) else term for term in cause.factors
    )
    return replace(cause, factors=tuple(factors))
