"""How large the gap is with the nominal model, with the causes, and without anything but noise.

All three are root mean squares of what cross-validation leaves of the residuals under test, over
their expected noise, of the channels that count: of those in which causes or unlisted effects
show, or of all where there are no causes, those in the unit of the one with the largest excess over
the noise, as far as their own is not much smaller.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from hyperleg_design.gap.effects import UNLISTED
from hyperleg_design.gap.inference.assembly import Evidence
from hyperleg_design.gap.inference.cross_validation import Prediction
from hyperleg_design.gap.inference.hypotheses.hypothesis import Hypothesis
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.inference.unlisted import makes_noise
from hyperleg_design.gap.model.joint_units import unit_at
from hyperleg_design.gap.signals.signals import RESIDUALS

DRAWS = 400
"""Draws of the block bootstrap."""


@dataclass(frozen=True, eq=False)
class GapSize:
    """Size of the gap by the most probable hypothesis."""

    evidence: Evidence
    held: Prediction
    before: np.ndarray
    """Mean square of each channel without the causes, over its noise `(channels,)`."""
    after: np.ndarray
    """The same with the causes."""
    noise: np.ndarray
    """The same that no cause can go below."""
    odd: np.ndarray
    """Channels in which an effect that is not listed shows `(channels,)` of bool."""
    rules: InferenceRules

    @classmethod
    def of(
        cls, evidence: Evidence, hypothesis: Hypothesis, held: Prediction, rules: InferenceRules
    ) -> GapSize:
        """Measure the gap by a hypothesis.

        Args:
            evidence: channels.
            hypothesis: the most probable one.
            held: its prediction of held-out blocks.
            rules: of the inference.
        """
        before, after = mean_squares(evidence, held.before), mean_squares(evidence, held.after)
        lowest = _lowest_squares(evidence, hypothesis, held, rules)
        odd = np.zeros(len(evidence.channels), bool)
        for cause in hypothesis.causes:
            if cause.effect in UNLISTED and not cause.standing:
                columns = cause.columns
                odd |= [bool(channel.shows(columns).any()) for channel in evidence.channels]
        return cls(evidence, held, before, after, lowest, odd, rules)

    @cached_property
    def excess(self) -> np.ndarray:
        """Mean square of each channel beyond noise `(channels,)`."""
        return np.maximum(self.before - self.noise, 0.0)

    @cached_property
    def counts(self) -> np.ndarray:
        """Channels that count for the gap `(channels,)` of bool."""
        shown = self._shown(self.held.trace)
        shown = shown | self.odd if shown.any() else np.ones_like(shown)
        return self._largest(self.excess, shown)

    def _shown(self, trace: np.ndarray) -> np.ndarray:
        """Channels in which a trace `(S,)` shows under test `(channels,)` of bool."""
        return np.array([trace[each.under_test].any() for each in self.evidence.channels], bool)

    def _largest(self, excess: np.ndarray, shown: np.ndarray) -> np.ndarray:
        """Of the channels that are `shown`, those whose excess is not much smaller than the
        largest, all in its unit `(channels,)` of bool.
        """
        units = [RESIDUALS[channel.residual][1] for channel in self.evidence.channels]
        largest = int(np.argmax(np.where(shown, excess, -np.inf)))
        same = np.array([unit == units[largest] for unit in units])
        least = min(self.rules.posterior.counts * excess[largest], excess[largest])
        return shown & same & (excess >= least)

    @property
    def unit(self) -> str:
        """Of the channels that count; both units where joints that turn and that slide do."""
        subject = self.evidence.signals[0].subject
        units = set()
        for place in np.flatnonzero(self.counts).tolist():
            channel = self.evidence.channels[place]
            kind, unit = RESIDUALS[channel.residual]
            units.add(unit_at(subject, kind, channel.name, unit))
        return ", ".join(sorted(units))

    @property
    def expected(self) -> float:
        """Root mean square of the expected noise, in the unit of the channels that count."""
        return float(np.sqrt(self.total(self.squares(self.evidence.samples.floor**2))))

    @property
    def lowest(self) -> float:
        """Size that no cause can go below, over the expected noise."""
        return float(np.sqrt(min(self.total(self.noise), self.total(self.after))))

    @property
    def closed(self) -> float:
        """Share of the gap beyond `lowest` that the causes close; 0 where there is none."""
        return self._share(self.before, self.before, self.counts)

    def closed_by(self, trace: np.ndarray, *, standing: bool) -> float:
        """Compute the share of the gap that one of the causes closes, in the channels in which it
        closes most: the share that would stay open without it.

        Args:
            trace: what the cause leaves `(S,)`, in the residuals' units.
            standing: whether it acts in the references, too; then the gap is what is left where
                this cause alone is taken away.

        Returns:
            The share; 0 where there is no gap beyond noise.
        """
        alone = self.squares(self.held.before - (self.held.trace - trace))
        shown = self._shown(trace)
        counts = self._largest(alone - self.after, shown) if shown.any() else self.counts
        return self._share(alone, alone if standing else self.before, counts)

    def _share(self, before: np.ndarray, whole: np.ndarray, counts: np.ndarray) -> float:
        """Share of a gap that goes where mean squares shrink to those with the causes.

        Args:
            before: mean squares that shrink `(channels,)`.
            whole: those of the gap `(channels,)`.
            counts: channels that count `(channels,)` of bool.
        """
        shrinking, gap, after, noise = (
            float(np.mean(squares[counts])) for squares in (before, whole, self.after, self.noise)
        )
        beyond = np.sqrt(gap) - np.sqrt(min(noise, after))
        if beyond <= 1e-9 * np.sqrt(gap):
            return 0.0
        return float(min((np.sqrt(shrinking) - np.sqrt(after)) / beyond, 1.0))

    def drawn(self, seed: int) -> np.ndarray:
        """Share closed in bootstrap draws of blocks `(DRAWS,)`.

        Args:
            seed: of the draws.
        """
        samples = self.evidence.tests
        number = len(samples.value)
        count = int(samples.block.max(initial=0)) + 1
        rng = np.random.default_rng([seed, 20])
        draws = rng.multinomial(count, np.full(count, 1 / count), size=DRAWS).astype(float)
        chosen = np.zeros(number, bool)
        for place in np.flatnonzero(self.counts).tolist():
            chosen[self.evidence.channels[place].under_test] = True

        def summed(values: np.ndarray) -> np.ndarray:
            squares = ((values * self.evidence.weight)[:number] ** 2)[chosen]
            return np.asarray(draws @ np.bincount(samples.block[chosen], squares, count))

        before, after = np.sqrt(summed(self.held.before)), np.sqrt(summed(self.held.after))
        share = self.lowest**2 / max(self.total(self.squares(self.held.noise)), 1e-300)
        lowest = np.minimum(np.sqrt(share * summed(self.held.noise)), after)
        return np.minimum((before - after) / np.maximum(before - lowest, 1e-12), 1.0)

    def squares(self, values: np.ndarray) -> np.ndarray:
        """Mean square in each channel, over its noise `(channels,)`.

        Args:
            values: of all samples `(S,)`, in the residuals' units.
        """
        return mean_squares(self.evidence, values)

    def total(self, squares: np.ndarray) -> float:
        """Mean over the channels that count.

        Args:
            squares: of all channels `(channels,)`.
        """
        return float(np.mean(squares[self.counts]))


def mean_squares(evidence: Evidence, values: np.ndarray) -> np.ndarray:
    """Mean square under test over the expected noise, by channel `(channels,)`.

    Args:
        evidence: channels.
        values: of all samples `(S,)`, in the residuals' units.
    """
    square = (values * evidence.weight) ** 2
    own = [channel.under_test for channel in evidence.channels]
    counts = [max(float(evidence.samples.share[where].sum()), 1e-300) for where in own]
    return np.array([float(square[where].sum()) for where in own]) / np.array(counts)


def _lowest_squares(
    evidence: Evidence, hypothesis: Hypothesis, held: Prediction, rules: InferenceRules
) -> np.ndarray:
    """Mean square that no cause can go below, as of `mean_squares`: what is left, or where that is
    an unlisted effect's noise, a healthy robot's.
    """
    squares = mean_squares(evidence, held.noise)
    for place, (channel, scales) in enumerate(
        zip(evidence.channels, hypothesis.scales, strict=True)
    ):
        if makes_noise(channel, scales, rules):
            numbers = channel.numbers[channel.bands_tested]
            usual = channel.usual_noise(scales.noise, rules)
            squares[place] = min(squares[place], float(numbers @ usual / numbers.sum()))
    return squares
