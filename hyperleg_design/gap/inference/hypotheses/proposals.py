"""The log evidence that every effect at every place would gain beside a
hypothesis at fixed scales, by which the search chooses what is worth a full fit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import block_diag

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.effects.spanned import SpannedEffect
from hyperleg_design.gap.inference.assembly import Evidence
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.channels.crossing import Crossing
from hyperleg_design.gap.inference.channels.scales import Scales
from hyperleg_design.gap.inference.effect_traces import NotJudged, Starts, Traces
from hyperleg_design.gap.inference.endogenous import Factor, factors_of, held_back_in_all, joined
from hyperleg_design.gap.inference.hypotheses.hypothesis import ALIKE, Name, Solution, solve
from hyperleg_design.gap.inference.hypotheses.stack import Stack
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.inference.shrinking import Shrinking
from hyperleg_design.gap.inference.threads import spread

LARGEST = 10.0
"""Size of a start's trace that is tried, over the start's own [-]."""


@dataclass(frozen=True, eq=False)
class Proposal:
    """An effect at a place, in one variant or from one start, and what it gains at fixed scales."""

    effect: str
    location: str
    standing: bool
    variant: int
    gain: float
    """Log evidence that the cause is predicted to gain [nat]."""
    values: tuple[float, ...] = ()
    """Values of its parameters at the start of a fit."""

    @property
    def name(self) -> Name:
        """Effect, location, and whether it acts in all logs."""
        return self.effect, self.location, self.standing


@dataclass(frozen=True, eq=False)
class _Beside:
    """A hypothesis beside which effects are tried, at its scales."""

    stack: Stack
    scales: tuple[Scales, ...]
    products: np.ndarray
    """Of the residual, the columns, and the constant trace where there is one."""
    parts: tuple[list[np.ndarray], ...]
    """Columns and constant trace by channel and cell, weighted twice, over the noise; see
    `Channel.over_noise`."""
    taken: tuple[np.ndarray, ...]
    """Of residual, columns and constant trace by channel, see `Channel.taken`."""
    solution: Solution | None
    """Of the hypothesis alone."""

    @property
    def gain(self) -> float:
        """Of the hypothesis alone [nat]."""
        return 0.0 if self.solution is None else self.solution.gain


class Proposer:
    """Computes the gains of all effects at all places beside hypotheses on one body of evidence.

    Args:
        evidence: channels.
        rules: of the inference.
        traces: of each effect at each place.
        threads: that share the work; they change no result.
    """

    def __init__(
        self,
        evidence: Evidence,
        rules: InferenceRules,
        traces: Mapping[Name, Traces],
        threads: int = 1,
    ) -> None:
        self.evidence, self.rules, self.threads = evidence, rules, threads
        self.traces = traces
        self._crossings: dict[Name, Crossing] = {}
        self._scaling: dict[Name, Sequence[Sequence[Factor | Shrinking]]] = {}

    def options(self, name: Name) -> tuple[list[Cause | None], list[np.ndarray]]:
        """List the variants of a linear effect at a place, or the columns of a nonlinear one's
        starts.

        Args:
            name: of the effect and place.

        Returns:
            Causes, None for starts, and their columns, unweighted `(k, S)` each, or shorter where
            they end with the logs under test; none where the logs do not show the effect.
        """
        traced = self.traces[name]
        if isinstance(traced, NotJudged):
            return [], []
        if isinstance(traced, list):
            return list(traced), [cause.columns for cause in traced]
        return [None] * len(traced.columns), list(traced.columns[:, None])

    def scaling(self, name: Name) -> Sequence[Sequence[Factor | Shrinking]]:
        """Compute how each option of an effect at a place scales the torques that residuals are
        made of.

        Args:
            name: of the effect and place.

        Returns:
            Terms of the likelihood, by option.
        """
        if name not in self._scaling:
            traced = self.traces[name]
            assert not isinstance(traced, NotJudged)
            self._scaling[name] = (
                [cause.factors for cause in traced]
                if isinstance(traced, list)
                else self._of_starts(name, traced)
            )
        return self._scaling[name]

    def _of_starts(self, name: Name, starts: Starts) -> Sequence[Sequence[Factor]]:
        """As `scaling`, of the sizes of starts."""
        effect, location, standing = WEIGHED[name[0]], name[1], name[2]
        if not (effect.scales or effect.holds_back):
            return [()] * len(starts.values)
        samples = self.evidence.samples if standing else self.evidence.tests
        scaled: list[list[Factor]] = [[] for _ in starts.values]
        if effect.scales:
            usual = effect.usual(location, self.evidence.signals[0].subject)
            sizes = (starts.values[:, 0] - effect.nulls[0]) / usual[0]
            for whole in factors_of(samples, effect.identifier, location, usual):
                if isinstance(whole, Factor):
                    for own, size in zip(scaled, sizes, strict=True):
                        own.append(replace(whole, slope=size * whole.slope))
        else:
            scaled = [
                held_back_in_all(samples, effect, location, values) for values in starts.values
            ]
        return [
            [self.evidence.with_numbers(factor, trace, standing) for factor in own]
            for own, trace in zip(scaled, starts.traces, strict=True)
        ]

    def crossing(self, name: Name) -> Crossing:
        """Compute the products of the columns of all options of an effect at a place with the
        channels.

        Args:
            name: of the effect and place.
        """
        if name not in self._crossings:
            weight = self.evidence.weight
            options = self.options(name)[1]
            weighted, at = np.zeros((sum(map(len, options)), len(weight))), 0
            for columns in options:
                count = columns.shape[1]
                weighted[at : at + len(columns), :count] = columns * weight[:count]
                at += len(columns)
            self._crossings[name] = Crossing.of(self.evidence.channels, weighted)
        return self._crossings[name]

    def proposals(
        self, causes: Sequence[Cause], scales: tuple[Scales, ...], at: str = ""
    ) -> list[Proposal]:
        """Gain of every effect at every place beside some causes, best first.

        Args:
            causes: of a hypothesis.
            scales: by channel.
            at: the only place that is tried; all by default.
        """
        base = self._base(causes, scales)
        taken = {(c.effect, c.location, c.standing) for c in causes}
        names = [
            name
            for name, traced in self.traces.items()
            if name not in taken and at in ("", name[1]) and not isinstance(traced, NotJudged)
        ]
        by_name = spread(lambda name: self._of(name, base), names, self.threads)
        proposals = [proposal for some in by_name for proposal in some]
        return sorted(
            proposals, key=lambda proposal: (-proposal.gain, *proposal.name, proposal.variant)
        )

    def information(self, name: Name, scales: tuple[Scales, ...]) -> np.ndarray:
        """Fisher information of the size of each column of an effect at a place, at some scales.

        Args:
            name: of the effect and place.
            scales: by channel.

        Returns:
            Of each column of a linear effect, else of each start `(m,)`.
        """
        products = self.crossing(name).reduced(self.evidence.channels, scales)[1:, 1:]
        traced = self.traces[name]
        if isinstance(traced, Starts) and traced.weights is not None:
            products = traced.weights @ products @ traced.weights.T
        return np.diag(products)

    def _base(self, causes: Sequence[Cause], scales: tuple[Scales, ...]) -> _Beside:
        channels, stack = self.evidence.channels, Stack.of(causes, self.evidence)
        crossing, rows = stack.crossing, stack.rows
        taken = []
        for channel, own, some, cross in zip(
            channels, scales, crossing.shown, crossing.cross, strict=True
        ):
            whole = np.zeros((*channel.whole_residual.cross.shape, 1 + len(rows)))
            whole[:, :, 0] = channel.whole_residual.cross
            if len(some):
                whole[:, :, 1 + some] = cross[:, :-1]
            taken.append(channel.taken(own, whole))
        products = crossing.reduced(channels, scales)
        twice = rows * self.evidence.weight
        parts = tuple(
            channel.over_noise(own.noise, twice)
            for channel, own in zip(channels, scales, strict=True)
        )
        base = _Beside(stack, scales, products, parts, tuple(taken), None)
        if causes:
            base = replace(base, solution=self._solved(base, products, np.zeros(0, int)))
        return base

    def _of(self, name: Name, base: _Beside) -> list[Proposal]:
        """All options of an effect at a place."""
        crossing = self.crossing(name)
        options, columns = self.options(name)
        rows = len(base.products)
        products = np.zeros((rows + crossing.count,) * 2)
        products[:rows, :rows] = base.products
        for channel, scales, known, parts, some, cross, own in zip(
            self.evidence.channels,
            base.scales,
            base.taken,
            base.parts,
            crossing.shown,
            crossing.cross,
            crossing.own,
            strict=True,
        ):
            if not len(some):
                continue
            weight = 1 / scales.noise[channel.band]
            mine = channel.taken(scales, cross[:, :-1])
            beside = -known.T @ mine
            beside[0] += weight @ cross[:, -1]
            if rows > 1:
                beside[1:] += channel.between(parts, columns)[:, some]
            at = rows + some
            products[:rows, at] += beside
            products[np.ix_(at, at)] += np.tensordot(weight, own, 1) - mine.T @ mine
        products[rows:, :rows] = products[:rows, rows:].T
        traced = self.traces[name]
        if isinstance(traced, Starts):
            return self._of_values(name, base, products, traced)
        proposed, at = [], rows
        each = zip(options, columns, self.scaling(name), self._odds(name, options), strict=True)
        for variant, (cause, own_columns, scaled, less) in enumerate(each):
            place = np.arange(at, at + len(own_columns))
            gain = self._solved(base, products, place, cause, scaled).gain - base.gain
            proposed.append(Proposal(*name, variant, gain + float(less)))
            at += len(own_columns)
        return proposed

    def _odds(self, name: Name, options: Sequence[Cause | None]) -> np.ndarray:
        """Log prior odds of the variants of a linear effect, over the likeliest `(v,)` [nat]."""
        if len(options) < 2:
            return np.zeros(len(options))
        effect, subject = WEIGHED[name[0]], self.evidence.signals[0].subject
        odds = [effect.odds(name[1], subject, o.nulls) if o else 0.0 for o in options]
        return np.array(odds) - max(odds)

    def _of_values(
        self, name: Name, base: _Beside, products: np.ndarray, starts: Starts
    ) -> list[Proposal]:
        """All starts of an effect at a place, and where a linear fit of its span leads.

        Args:
            name: of the effect and place.
            base: the hypothesis beside which they are tried.
            products: of the residual, its rows, and the columns of the starts.
            starts: of the effect.
        """
        rows, values = len(base.products), starts.values
        scaling = list(self.scaling(name))
        effect = WEIGHED[name[0]]
        if isinstance(effect, SpannedEffect) and starts.weights is not None:
            span = rows + np.arange(len(starts.columns))
            sizes = self._solved(base, products, span, free=True).theta[-len(span) :]
            subject = self.evidence.signals[0].subject
            nearest = effect.nearest(name[1], subject, sizes)
            values = np.concatenate([nearest, values])
            weights = np.concatenate([effect.in_span(name[1], subject, nearest), starts.weights])
            turn = block_diag(np.eye(rows), weights)
            products, scaling = turn @ products @ turn.T, [()] * len(values)
        rules, plain = self.rules.search, np.array([not scaled for scaled in scaling])
        worth = self._worth(base, products, rows + np.arange(len(values)))
        if plain.all() and worth.max() <= rules.least:
            return []
        promising = np.argsort(np.where(plain, -worth, -np.inf), kind="stable")
        promising = promising[: max(2 * rules.starts, int((~plain).sum()))]
        proposals = []
        for number in sorted(promising.tolist()):
            solution = self._solved(
                base, products, np.array([rows + number]), None, scaling[number]
            )
            gain = solution.gain - base.gain
            proposals.append(Proposal(*name, number, gain, tuple(values[number].tolist())))
        return proposals

    @staticmethod
    def _worth(base: _Beside, products: np.ndarray, place: np.ndarray) -> np.ndarray:
        """What single columns gain at most beside the hypothesis, where they scale no torque.

        Args:
            base: the hypothesis.
            products: of the residual, its rows, and the columns.
            place: of these.
        """
        right, square = products[place, 0].copy(), np.diag(products)[place].copy()
        if base.solution is not None:
            known = len(base.stack.low)
            if base.stack.constant_last:
                right -= products[place, 1 + known]
            own = np.arange(1, 1 + known)
            between = products[np.ix_(own, place)]
            right -= base.solution.theta @ between
            square -= np.sum(between * (base.solution.covariance @ between), axis=0)
        square = np.maximum(square, ALIKE * np.diag(products)[place])
        size = np.clip(right / np.maximum(square, np.finfo(float).tiny), 0.0, LARGEST)
        return np.asarray(right * size - 0.5 * square * size**2)

    def _solved(
        self,
        base: _Beside,
        products: np.ndarray,
        place: np.ndarray,
        cause: Cause | None = None,
        scaled: Sequence[Factor | Shrinking] = (),
        free: bool = False,
    ) -> Solution:
        """One option's columns beside those of the hypothesis.

        Args:
            base: the hypothesis.
            products: of the residual, its rows, and the option's columns.
            place: of these columns.
            cause: of the option; None for a start.
            scaled: how its parameters, or the size of the start, scale torques.
            free: whether sizes of starts may be anything.
        """
        stack, known = base.stack, len(base.stack.low)
        some = np.r_[0 : 1 + known, place]
        own = products[np.ix_(some, some)]
        if stack.constant_last:
            constant = products[1 + known]
            own[0] -= constant[some]
            own[:, 0] -= constant[some]
            own[0, 0] += constant[1 + known]
        stacks = [(stack.low, stack.high, stack.shape)]
        if cause is not None:
            low, high = ((end - cause.nulls) / cause.usual for end in (cause.low, cause.high))
            stacks.append((low, high, cause.shape))
        elif len(place):
            low, high = (-np.inf, np.inf) if free else (0.0, LARGEST)
            count = len(place)
            stacks.append((np.full(count, low), np.full(count, high), np.zeros(count, bool)))
        groups = stack.groups
        if scaled:
            own_terms = ((known + term.parameter, term) for term in scaled)
            groups = joined([*stack.factors, *own_terms])
        low, high, shape = (np.concatenate([s[i] for s in stacks]) for i in range(3))
        near = None if base.solution is None else base.solution.theta
        return solve(own, low, high, shape.astype(bool), self.rules, groups, near)
