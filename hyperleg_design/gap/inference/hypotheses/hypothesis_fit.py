"""The fit of a set of causes: their sizes, and the scales of the channels that they show in."""

from __future__ import annotations

import operator
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.inference.assembly import Evidence
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.channels.scale_fit import STEPS, first_scales, fitted
from hyperleg_design.gap.inference.channels.scales import Scales
from hyperleg_design.gap.inference.effect_traces import NotJudged, Traces
from hyperleg_design.gap.inference.hypotheses.cause_prior import log_prior
from hyperleg_design.gap.inference.hypotheses.hypothesis import (
    Candidate,
    Hypothesis,
    Name,
    Solution,
    shifted,
    solve,
)
from hyperleg_design.gap.inference.hypotheses.limited_scales import limited_scales
from hyperleg_design.gap.inference.hypotheses.proposals import Proposal
from hyperleg_design.gap.inference.hypotheses.stack import Stack
from hyperleg_design.gap.inference.interactions import Acting, acting_on, values_of
from hyperleg_design.gap.inference.interactions import beside as samples_beside
from hyperleg_design.gap.inference.linearisation import linearise
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.inference.samples import Samples
from hyperleg_design.gap.inference.threads import spread

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False)
class _Fitted:
    """Scales and the causes at them."""

    scales: tuple[Scales, ...]
    solution: Solution
    moved: np.ndarray
    """Rows of causes that have not converged yet `(k,)` of bool."""


class HypothesisFit:
    """Fits of hypotheses to one body of evidence.

    Args:
        evidence: channels.
        rules: of the inference.
        traces: of each effect at each place.
        count: places of each effect that is tried.
        threads: that share the work; they change no result.
        only: 1 at the samples of the one log in which new causes act, 0 elsewhere `(S,)`; None
            where they act in all logs or in those under test.
    """

    def __init__(
        self,
        evidence: Evidence,
        rules: InferenceRules,
        traces: Mapping[Name, Traces],
        count: Mapping[str, int],
        threads: int = 1,
        only: np.ndarray | None = None,
    ) -> None:
        self.evidence, self.rules, self.threads = evidence, rules, threads
        self.traces, self.count, self.only = traces, count, only
        self._base = Stack.of((), evidence)
        """Causes beside which others were tried last."""
        self._left: dict[tuple[bool, bool], tuple[Any, Samples]] = {}
        """Samples of `_beside` by what shows in them, and the causes that leave them so."""

    @cached_property
    def null(self) -> Hypothesis:
        """The null hypothesis: no cause, noise and discrepancy alone."""
        channels, rules = self.evidence.channels, self.rules
        scales = spread(
            lambda channel: fitted(channel, first_scales(channel, rules), rules),
            channels,
            self.threads,
        )
        prior = float(np.log(1 - rules.cause.probability))
        return Hypothesis((), np.zeros(0), np.zeros((0, 0)), tuple(scales), 0.0, prior)

    @cached_property
    def null_log_posterior(self) -> np.ndarray:
        """Log posterior of each channel without any cause `(channels,)` [nat]."""
        channels = zip(self.evidence.channels, self.null.scales, strict=True)
        return np.array([each.log_posterior(scales, self.rules) for each, scales in channels])

    def candidate(
        self, proposal: Proposal, current: Hypothesis, steps: int | None = None
    ) -> Candidate | None:
        """Linearise an effect where it fits best beside a hypothesis, by Gauss-Newton steps at
        fixed scales, halved where they lead to worse.

        Args:
            proposal: the effect, its place, and where the steps begin.
            current: the hypothesis.
            steps: most steps; `SearchRules.steps` by default.

        Returns:
            The candidate; None where no log shows it.
        """
        traced = self.traces[proposal.name]
        if isinstance(traced, list):
            return Candidate(proposal.effect, proposal.location, (traced[proposal.variant],))
        assert not isinstance(traced, NotJudged)
        effect = WEIGHED[proposal.effect]
        values = np.array(proposal.values, float)
        scales: Sequence[Scales] = current.scales  # what changed must not bend what is lacking
        if not proposal.standing:
            scales = limited_scales(self.evidence, current.scales, self.rules)
        everywhere = proposal.standing or self.only is not None
        others = acting_on(effect, proposal.standing, current.acting)
        samples = self.beside(effect, everywhere, others)
        best: tuple[float, Cause] | None = None
        for _ in range(steps or self.rules.search.steps):
            cause = linearise(samples, effect, proposal.location, values)
            if cause is None:
                break
            cause = self.evidence.on_all_samples(cause, proposal.standing, self.only)
            cause = replace(cause, before=values_of(others))
            stack = self.stacked(current.causes, (cause,))
            reached = self._reached(stack, scales, cause)
            if best is None or reached > best[0]:
                best = reached, cause
                sizes = self.at_scales(stack, scales).theta[-len(cause.nulls) :]
                move = np.clip(cause.nulls + sizes * cause.usual, cause.low, cause.high) - values
            else:
                move = (best[1].values - values) / 2
            if np.max(np.abs(move) / cause.usual) < self.rules.search.converged:
                break
            values = values + move
        return None if best is None else Candidate(proposal.effect, proposal.location, (best[1],))

    def _reached(self, stack: Stack, scales: Sequence[Scales], cause: Cause) -> float:
        """What causes gain at fixed scales where the last of them has the values at which it is
        linearised, without what is known of sizes before [nat].
        """
        last = slice(len(stack.low) - len(cause.nulls), None)
        solution = self.at_scales(stack.held([(last, cause)]), scales)
        paid = sum(term.log(solution.theta[place]) for place, term in stack.groups)
        return solution.gain - solution.occam + paid

    def where_linearised(self, hypothesis: Hypothesis) -> Hypothesis:
        """Fit a hypothesis with its causes at the values at which they are linearised: far from
        there, what they leave over is not what a linear fit says.

        Args:
            hypothesis: fitted.

        Returns:
            The same where causes are linearised at their estimates.
        """
        causes, part = hypothesis.causes, hypothesis.parts
        least, place = self.rules.search.converged, range(len(hypothesis.causes))
        bent = [i for i in place if not causes[i].linear]
        if all(
            are_near(hypothesis.values(i), causes[i].values, causes[i].usual, least) for i in bent
        ):
            return hypothesis
        last = len(hypothesis.candidates[-1].causes)
        stack = self.stacked(causes[:-last], causes[-last:])
        stack = stack.held([(part[i], causes[i]) for i in bent])
        fit = self._first_round(stack, hypothesis.scales)
        reached = self._likelihood(stack, fit)
        own = replace(hypothesis, theta=fit.solution.theta, scales=fit.scales, log_evidence=reached)
        return replace(own, log_prior=log_prior(own, self.evidence, self.rules, self.count))

    def beside(self, effect: Effect, everywhere: bool, others: Sequence[Acting]) -> Samples:
        """Samples that show an effect, in all logs or in those under test, as others leave them;
        the last ones are kept, as many effects are tried beside one hypothesis.

        Args:
            effect: the effect.
            everywhere: whether it acts in all logs.
            others: causes that change what it acts on.
        """
        samples = self.evidence.samples if everywhere else self.evidence.tests
        if not others:
            return samples
        kind = everywhere, effect.by_load
        wanted = tuple(c[:3] for c in others), values_of(others)
        known, left = self._left.get(kind, (None, samples))
        if known != wanted:
            left = samples_beside(samples, effect, others, len(self.evidence.signals))
            self._left[kind] = wanted, left
        return left

    def stacked(self, known: tuple[Cause, ...], further: tuple[Cause, ...]) -> Stack:
        """Stack causes; the products of the known ones are kept, as many causes are tried beside
        one hypothesis.

        Args:
            known: causes of a hypothesis.
            further: causes beside them.
        """
        base = self._base
        if len(base.causes) != len(known) or any(map(operator.is_not, base.causes, known)):
            self._base = base = Stack.of(known, self.evidence)
        return base.extended(further, self.evidence) if further else base

    def at_scales(
        self,
        stack: Stack,
        scales: Sequence[Scales],
        near: np.ndarray | None = None,
    ) -> Solution:
        """Fit causes at fixed scales; the gain is over no cause at the same scales.

        Args:
            stack: of the causes.
            scales: by channel.
            near: theta at scales nearby.
        """
        products = stack.crossing.reduced(self.evidence.channels, scales)
        own = shifted(products, stack.constant_last)
        solution = solve(own, stack.low, stack.high, stack.shape, self.rules, stack.groups, near)
        change = -0.5 * float(own[0, 0] - products[0, 0])
        return replace(solution, gain=solution.gain + change)

    def fit(self, candidates: Sequence[Candidate], scales: Sequence[Scales]) -> Hypothesis:
        """Fit causes and the scales of the channels that they show in, in turn: from scales as they
        are, and from ones that do not hide what the causes explain.

        Args:
            candidates: of the hypothesis.
            scales: to begin with.
        """
        *known, last = candidates
        stack = self.stacked(tuple(c for each in known for c in each.causes), last.causes)
        beginnings = [self._first_round(stack, scales)]
        lacking = any(cause.standing for cause in stack.causes)
        limited = limited_scales(self.evidence, scales, self.rules, lacking)
        if any(
            len(rows) and (np.any(low.noise < own.noise) or low.standing < own.standing)
            for low, own, rows in zip(limited, scales, stack.crossing.shown, strict=True)
        ):
            beginnings.append(self._first_round(stack, limited))
        fit = max(beginnings, key=lambda begun: self._likelihood(stack, begun))
        for _ in range(self.rules.search.rounds - 1):
            if not fit.moved.any():
                break
            fit = self._round(stack, fit, 1, STEPS[-1:], again=True)
        likelihood = self._likelihood(stack, fit)
        sizes = fit.solution.theta, fit.solution.covariance
        hypothesis = Hypothesis(tuple(candidates), *sizes, fit.scales, likelihood, 0.0)
        prior = log_prior(hypothesis, self.evidence, self.rules, self.count)
        return replace(hypothesis, log_prior=prior)

    def _first_round(self, stack: Stack, scales: Sequence[Scales]) -> _Fitted:
        """Causes at given scales, and after one round."""
        solution = self.at_scales(stack, scales)
        begun = _Fitted(tuple(scales), solution, np.ones(stack.crossing.count, bool))
        return self._round(stack, begun, 2, STEPS)

    def _round(
        self,
        stack: Stack,
        begun: _Fitted,
        sweeps: int,
        steps: tuple[float, ...],
        again: bool = False,
    ) -> _Fitted:
        """Fit the scales of the channels in which a cause moved, then the causes, see `fitted`."""
        channels = self.evidence.channels
        left = stack.crossing.left(channels, stack.sizes(begun.solution.theta))
        scales = tuple(
            fitted(channel, own, self.rules, rest, sweeps, steps, again)
            if begun.moved[seen].any()
            else own
            for channel, own, rest, seen in zip(
                channels, begun.scales, left, stack.crossing.shown, strict=True
            )
        )
        before = begun.solution.theta
        solution = self.at_scales(stack, scales, before)
        deviation = np.sqrt(np.maximum(np.diag(solution.covariance), 1e-300))
        moved = np.zeros(stack.crossing.count, bool)
        moved[: len(before)] = (
            np.abs(solution.theta - before) >= self.rules.search.settled * deviation
        )
        return _Fitted(scales, solution, moved)

    def _likelihood(self, stack: Stack, fit: _Fitted) -> float:
        """Log evidence of causes at scales over that of no cause [nat]."""
        channels = self.evidence.channels
        left = stack.crossing.left(channels, stack.sizes(fit.solution.theta))
        each = zip(channels, fit.scales, left, self.null_log_posterior, strict=True)
        return fit.solution.occam + float(
            sum(
                channel.log_posterior(own, self.rules, rest) - null
                for channel, own, rest, null in each
            )
        )


def are_near(values: ArrayLike, others: ArrayLike, usual: ArrayLike, least: float) -> bool:
    """Tell whether values are as many and differ by less than a share of their usual sizes.

    Args:
        values: of some parameters `(k,)`.
        others: of the same.
        usual: their usual sizes `(k,)`.
        least: the share, `SearchRules.converged`.
    """
    first, second = np.asarray(values, float), np.asarray(others, float)
    if len(first) != len(second):
        return False
    return bool(np.all(np.abs(first - second) < least * np.asarray(usual)))
