"""The search for the hypotheses with the largest posterior probability: nothing, each effect at
each place, an effect at all of its places, and sets of them by forward and backward steps.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.stats import norm

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference import screen
from hyperleg_design.gap.inference.channel import STEPS
from hyperleg_design.gap.inference.endogenous import Factor
from hyperleg_design.gap.inference.hypothesis import (
    EVERYWHERE,
    Candidate,
    Hypothesis,
    Name,
    Solution,
    Stack,
    reduced,
    shifted,
    solve,
)
from hyperleg_design.gap.inference.prior_odds import prior_odds

if TYPE_CHECKING:
    from hyperleg_design.gap.inference.assembly import Evidence
    from hyperleg_design.gap.inference.channel import Scales
    from hyperleg_design.gap.inference.fit import Cause
    from hyperleg_design.gap.inference.rules import InferenceRules
    from hyperleg_design.gap.inference.samples import Samples

CLOSE = 0.02
"""Step of a nonlinear fit, over usual sizes, from which it has converged [-]."""
WHOLE_STEPS = 3
"""Gauss-Newton steps before they are halved."""
EASED = 2.0
"""Noise under test over a healthy robot's, in variance, at most where a fit begins [-]."""
TOGETHER = 16
"""Promises whose columns are multiplied with each other, though only each alone is asked for."""
LARGEST = 10.0
"""Size of a start's trace that is tried, over the start's own [-]."""


@dataclass(frozen=True, eq=False)
class Promise:
    """An effect at a place and what it gains at fixed scales, by its columns or by one start."""

    effect: str
    location: str
    standing: bool
    variant: int
    gain: float
    """[nat]"""

    @property
    def name(self) -> Name:
        """Effect, location, and whether it acts in all logs."""
        return self.effect, self.location, self.standing


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
        self.places = tuple(places)
        self.count = {name: sum(e == name for e, _ in places) for name, _ in places}

    @cached_property
    def nothing(self) -> Hypothesis:
        """No cause: noise and discrepancy alone."""
        scales = tuple(
            screen.spread(
                lambda one: one.fitted(one.start(self.rules), self.rules),
                self.evidence.channels,
                self.threads,
            )
        )
        prior = float(np.log(1 - self.rules.cause.probability))
        return Hypothesis((), np.zeros(0), np.zeros((0, 0)), scales, 0.0, prior)

    @cached_property
    def ground(self) -> np.ndarray:
        """Log posterior of each channel without any cause `(channels,)` [nat]."""
        return np.array(
            [
                channel.log_posterior(scales, self.rules)
                for channel, scales in zip(self.evidence.channels, self.nothing.scales, strict=True)
            ]
        )

    @cached_property
    def traces(self) -> dict[Name, screen.Traces]:
        """What each effect leaves at each place in the logs under test and, with references, in all
        logs.
        """
        traced = screen.spread(self._traced, self.places, self.threads)
        found: dict[Name, screen.Traces] = {}
        for (effect, location), both in zip(self.places, traced, strict=True):
            for standing, one in zip((False, True), both, strict=False):
                found[effect, location, standing] = one
        return found

    def _traced(self, place: tuple[str, str]) -> list[screen.Traces]:
        """In the logs under test and, with references, in all logs."""
        whole = screen.trace(self.evidence.samples, EFFECTS[place[0]], place[1])
        if isinstance(whole, screen.NotJudged):
            return [whole] * (2 if self.evidence.references else 1)
        count = len(self.evidence.tests.value)
        own: screen.Traces
        if isinstance(whole, list):
            own = [
                self.evidence.acting(cut, False)
                for one in whole
                if (cut := screen.under_test(one, self.evidence.tests)) is not None
            ]
            whole = [self.evidence.acting(one, True) for one in whole]
        else:
            own = whole[0], whole[1][:, :count]
            if screen.reach(self.evidence.tests, own[1]) < screen.SHOWN:
                own = []
        if not own:
            own = screen.NotJudged(*place, screen.UNEXCITED)
        return [own, whole] if self.evidence.references else [own]

    def _samples(self, standing: bool) -> Samples:
        return self.evidence.samples if standing else self.evidence.tests

    def result(self) -> Result:
        """Search forward until no further cause is worth its prior, drop what is not, and put
        others in the place of each.
        """
        fitted: dict[tuple[Name, ...], Hypothesis] = {(): self.nothing}
        current = self.nothing
        most = self.rules.search.causes * (1 + bool(self.evidence.references))
        fewer: list[Hypothesis] = []
        while True:
            best = current
            if len(current.candidates) < most:
                best = self._better(self.further(current), current, fitted)
            if best is current and len(current.candidates) > 1:
                fewer = fewer or self._fewer(current, fitted)
                for one, rest in zip(current.candidates, fewer, strict=True):
                    best = self._better(self.further(rest, one), best, fitted)
            if best is current:
                break
            current, fewer = best, self._fewer(best, fitted)
            best = max((current, *fewer[:-1]), key=lambda one: one.score)
            if best is not current:
                current, fewer = best, []
        ranked = sorted(fitted.values(), key=lambda one: (-one.score, one.names))
        missing = tuple(
            traced
            for (*_, standing), traced in self.traces.items()
            if isinstance(traced, screen.NotJudged) and not standing
        )
        return Result(tuple(ranked), missing)

    def _better(
        self,
        found: Sequence[Hypothesis],
        current: Hypothesis,
        fitted: dict[tuple[Name, ...], Hypothesis],
    ) -> Hypothesis:
        """The best of some hypotheses, if better than a current one; all are kept."""
        for one in found:
            before = fitted.get(one.names)
            if before is None or one.score > before.score:
                fitted[one.names] = one
            current = max(current, one, key=lambda any_: any_.score)
        return current

    def _fewer(
        self, current: Hypothesis, fitted: dict[tuple[Name, ...], Hypothesis]
    ) -> list[Hypothesis]:
        """A hypothesis without each of its candidates."""
        found = []
        for place in range(len(current.candidates)):
            rest = current.candidates[:place] + current.candidates[place + 1 :]
            found.append(self.fit(rest, current.scales) if rest else self.nothing)
            fitted.setdefault(found[-1].names, found[-1])
        return found

    def further(self, current: Hypothesis, instead: Candidate | None = None) -> list[Hypothesis]:
        """Fit the most promising causes beside those of a hypothesis.

        Args:
            current: the hypothesis.
            instead: a candidate whose place they are to take: only those that promise more.
        """
        rules = self.rules.search
        promises: dict[Name, list[Promise]] = {}
        for one in self.promises(current):
            promises.setdefault(one.name, []).append(one)
        names = sorted(promises, key=lambda name: (-promises[name][0].gain, name))
        if not names:
            return []
        gains = {name: promises[name][0].gain for name in names}
        groups = self.everywhere(promises, current)
        gains |= {one.name: gain for gain, one in groups}
        least = rules.least
        if instead is not None:
            least = max(least, gains.get(instead.name, least))
        chosen = [name for name in names if gains[name] > least][: rules.candidates]
        fitted = screen.spread(
            lambda name: self.best_of(promises[name][: rules.starts], current),
            chosen,
            self.threads,
        )
        found = [one for one in fitted if one is not None]
        found += [
            self.fit((*current.candidates, one), current.scales)
            for gain, one in groups[: rules.groups]
            if gain > least
        ]
        return found

    def everywhere(
        self, promises: Mapping[Name, Sequence[Promise]], current: Hypothesis
    ) -> list[tuple[float, Candidate]]:
        """Linear effects at all of their places, and what they gain beside a hypothesis at its
        scales, best first.
        """
        scales = eased(self.evidence, current.scales, self.rules)
        acting = {(one.effect, one.standing) for one in current.candidates}
        start, found = 0.0, []
        if current.causes:
            start = self._fitted(Stack.of(current.causes, self.evidence.weight), scales).gain
        for effect, standing in sorted({(name[0], name[2]) for name in promises} - acting):
            if not EFFECTS[effect].linear or self.count[effect] < 2:
                continue
            own = sorted(name for name in promises if (name[0], name[2]) == (effect, standing))
            causes = [self.candidate(promises[name][0], current) for name in own]
            joined = tuple(ungaining(c) for one in causes if one is not None for c in one.causes)
            if len(joined) < 2:
                continue
            stack = Stack.of((*current.causes, *joined), self.evidence.weight)
            one = Candidate(effect, EVERYWHERE, joined)
            found.append((self._fitted(stack, scales).gain - start, one))
        return sorted(found, key=lambda entry: (-entry[0], *entry[1].name))

    def promises(self, current: Hypothesis) -> list[Promise]:
        """Gain of every effect at every place beside a hypothesis, at its scales, best first; noise
        that hides what causes explain is left out of them.
        """
        beside, weight = current.causes, self.evidence.weight
        taken = {(c.effect, c.location, c.standing) for c in beside}
        base = Stack.of(beside, weight) if beside else None
        entries: list[tuple[Promise, int, Cause | None, np.ndarray]] = []
        size = len(weight)
        for name, traced in self.traces.items():
            if name in taken or isinstance(traced, screen.NotJudged):
                continue
            options: list[Any] = traced if isinstance(traced, list) else list(traced[1])
            for variant, option in enumerate(options):
                cause = option if not isinstance(option, np.ndarray) else None
                columns = option[None] if cause is None else option.columns
                entries.append((Promise(*name, variant, 0.0), len(columns), cause, columns))
        found: list[Promise] = []
        scales = eased(self.evidence, current.scales, self.rules)
        for first in range(0, len(entries), TOGETHER):
            some = entries[first : first + TOGETHER]
            blocks = [] if base is None else [base.columns, base.constant[None]]
            at = known = 0 if base is None else len(base.columns) + 1
            for *_, columns in some:
                own = columns.shape[1]
                blocks.append(np.pad(columns * weight[:own], ((0, 0), (0, size - own))))
            products = reduced(self.evidence, scales, np.concatenate(blocks))
            if base is not None:
                products[0] -= products[known]
                products[:, 0] -= products[:, known]
            start = self._solved(products, base, np.zeros(0, int), None).gain if base else 0.0
            for one, count, cause, _ in some:
                solution = self._solved(products, base, np.arange(at, at + count), cause)
                found.append(replace(one, gain=solution.gain - start))
                at += count
        return sorted(found, key=lambda one: (-one.gain, *one.name, one.variant))

    def _solved(
        self,
        products: np.ndarray,
        base: Stack | None,
        place: np.ndarray,
        cause: Cause | None,
    ) -> Solution:
        """One candidate's columns beside those of a base."""
        known = 0 if base is None else len(base.columns)
        some = np.r_[0, 1 + np.arange(known), 1 + place]
        none = np.zeros(0)
        stacks = [] if base is None else [(base.low, base.high, base.shape)]
        factors = [] if base is None else list(base.factors)
        if cause is not None:
            low, high = ((end - cause.nulls) / cause.usual for end in (cause.low, cause.high))
            stacks.append((low, high, cause.shape))
            if cause.factor is not None:
                factors.append((known + cause.factor.parameter, cause.factor))
        elif len(place):
            stacks.append((np.zeros(1), np.full(1, LARGEST), np.zeros(1, bool)))
        low, high, shape = (
            np.concatenate([s[i] for s in stacks]) if stacks else none for i in range(3)
        )
        return solve(
            products[np.ix_(some, some)], low, high, shape.astype(bool), self.rules, factors
        )

    def best_of(self, promises: Sequence[Promise], current: Hypothesis) -> Hypothesis | None:
        """The best fit of an effect at a place beside a hypothesis, from several starts."""
        linear = EFFECTS[promises[0].effect].linear
        found = [
            self.fit((*current.candidates, one), current.scales)
            for promise in promises[: 1 if linear else None]
            if (one := self.candidate(promise, current)) is not None
        ]
        return max(found, key=lambda one: one.score, default=None)

    def candidate(self, promise: Promise, current: Hypothesis) -> Candidate | None:
        """An effect linearised where it fits best, by Gauss-Newton steps at fixed scales."""
        traced = self.traces[promise.name]
        if isinstance(traced, list):
            return Candidate(promise.effect, promise.location, (traced[promise.variant],))
        assert not isinstance(traced, screen.NotJudged)
        effect = EFFECTS[promise.effect]
        subject = self.evidence.signals[0].subject
        low, high = effect.bounds(promise.location, subject)
        values = np.array(traced[0][promise.variant], float)
        scales = eased(self.evidence, current.scales, self.rules)
        best: tuple[float, Cause] | None = None
        for step in range(self.rules.search.steps):
            cause = screen.linearise(
                self._samples(promise.standing), effect, promise.location, values
            )
            if cause is None:
                break
            cause = self.evidence.acting(cause, promise.standing)
            stack = Stack.of((*current.causes, cause), self.evidence.weight)
            solution = self._fitted(stack, scales)
            if best is None or solution.gain > best[0]:
                best = solution.gain, cause
            wanted = cause.nulls + solution.theta[-len(cause.nulls) :] * cause.usual
            move = np.clip(wanted, low, high) - values
            if np.max(np.abs(move) / cause.usual) < CLOSE:
                break
            values = values + move * (1.0 if step < WHOLE_STEPS else 0.5)
        return None if best is None else Candidate(promise.effect, promise.location, (best[1],))

    def _fitted(self, stack: Stack, scales: Sequence[Scales]) -> Solution:
        """Causes at fixed scales; the gain is over no cause at these."""
        last = bool(stack.constant.any())
        columns = np.concatenate([stack.columns, stack.constant[None]]) if last else stack.columns
        products = reduced(self.evidence, scales, columns)
        own = shifted(products, last)
        solution = solve(own, stack.low, stack.high, stack.shape, self.rules, stack.factors)
        change = -0.5 * float(own[0, 0] - products[0, 0])
        return Solution(solution.theta, solution.covariance, solution.gain + change, solution.occam)

    def fit(self, candidates: Sequence[Candidate], scales: Sequence[Scales]) -> Hypothesis:
        """Fit causes and the scales of the channels that they show in, in turn: from scales as they
        are, and from ones whose noise does not hide what the causes explain.

        Args:
            candidates: of the hypothesis.
            scales: to begin with.
        """
        found = [self._fit(candidates, scales)]
        clear = eased(self.evidence, scales, self.rules)
        if any(np.any(one.noise < own.noise) for one, own in zip(clear, scales, strict=True)):
            found.append(self._fit(candidates, clear))
        return max(found, key=lambda one: one.score)

    def _fit(self, candidates: Sequence[Candidate], scales: Sequence[Scales]) -> Hypothesis:
        causes = [c for one in candidates for c in one.causes]
        stack = Stack.of(causes, self.evidence.weight)
        channels = self.evidence.channels
        shown = [
            bool(np.any(stack.columns[:, one.samples]) or np.any(stack.constant[one.samples]))
            for one in channels
        ]
        rules = self.rules.search
        found = list(scales)
        solution = self._fitted(stack, found)
        for turn in range(rules.rounds):
            trace = solution.theta @ stack.columns + stack.constant
            sweeps, steps = (2, STEPS) if turn == 0 else (1, STEPS[-1:])
            found = [
                channel.without(trace).fitted(own, self.rules, sweeps, steps) if seen else own
                for channel, own, seen in zip(channels, found, shown, strict=True)
            ]
            before, solution = solution.theta, self._fitted(stack, found)
            deviation = np.sqrt(np.maximum(np.diag(solution.covariance), 1e-300))
            if np.all(np.abs(solution.theta - before) < rules.settled * deviation):
                break
        trace = solution.theta @ stack.columns + stack.constant
        likelihood = solution.occam
        for place, (channel, own) in enumerate(zip(channels, found, strict=True)):
            left = channel.without(trace) if shown[place] else channel
            likelihood += left.log_posterior(own, self.rules) - self.ground[place]
        hypothesis = Hypothesis(
            tuple(candidates), solution.theta, solution.covariance, tuple(found), likelihood, 0.0
        )
        return Hypothesis(
            hypothesis.candidates,
            hypothesis.theta,
            hypothesis.covariance,
            hypothesis.scales,
            likelihood,
            self.log_prior(hypothesis),
        )

    def log_prior(self, hypothesis: Hypothesis) -> float:
        """Log prior probability of a set of causes at their values [nat]: each effect is as likely
        as any other, but for one that acts at another place already, at each of its places, or at
        all of them.
        """
        own = self.rules.cause
        found, place = 0.0, 0
        acting: set[tuple[str, bool]] = set()
        for one in hypothesis.candidates:
            kind = one.effect, one.standing
            chance = own.probability * (own.again if kind in acting else 1 / len(self.count))
            if acting and kind not in acting:
                chance *= 1 - own.again
            acting.add(kind)
            found += float(np.log(chance))
            found -= float(np.log(self.count[one.effect] + (self.count[one.effect] > 1)))
            odds = []
            for cause in one.causes:
                values = hypothesis.values(place)
                odds.append(
                    EFFECTS[cause.effect].odds(
                        cause.location, self.evidence.signals[0].subject, values
                    )
                    + min(prior_odds(cause, values), 0.0)
                    - self.like_usual(cause, values, hypothesis.deviation(place))
                )
                place += 1
            found += float(np.mean(odds))
        return found

    def like_usual(self, cause: Cause, values: np.ndarray, deviation: np.ndarray) -> float:
        """Log odds against a cause that is no larger than the usual calibration error: the
        posterior probability that one of its parameters lies beyond `usual` deviations of that
        [nat]. What references tell has no such error.
        """
        if self.evidence.references and not cause.standing:
            return 0.0
        own, factor = self.rules.cause, self.rules.posterior.interval
        odds = []
        for place, (value, null) in enumerate(zip(values, cause.nulls, strict=True)):
            usual = own.usual * self.evidence.usual.get((cause.effect, cause.location, place), 0.0)
            if cause.shape[place] or value == null:
                continue
            if not usual:
                return 0.0
            over = (abs(value - null) - usual) / max(factor * deviation[place], 1e-300)
            odds.append(-float(norm.logcdf(over)))
        return min(odds, default=0.0)


def ungaining(cause: Cause) -> Cause:
    """A cause that gains nothing by scaling torques up: where all torques are scaled, masses and
    friction may be, too, and all that is left to gain is noise nearer to the expected one.
    """
    if isinstance(cause.factor, Factor):
        return replace(cause, factor=replace(cause.factor, shows=0.0))
    return cause


def eased(
    evidence: Evidence, scales: Sequence[Scales], rules: InferenceRules
) -> tuple[Scales, ...]:
    """Scales whose noise under test is at most `EASED` times that of a healthy robot."""
    found = []
    for channel, one in zip(evidence.channels, scales, strict=True):
        noise, place = one.noise.copy(), channel.bands_tested
        noise[place] = np.minimum(noise[place], EASED * channel.usual_noise(one.noise, rules))
        found.append(replace(one, noise=noise))
    return tuple(found)
