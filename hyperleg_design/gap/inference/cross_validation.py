"""What a hypothesis predicts of blocks of the logs that it was not fitted to."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hyperleg_design.gap.effects import UNLISTED
from hyperleg_design.gap.inference.assembly import Evidence
from hyperleg_design.gap.inference.channels.channel import Channel
from hyperleg_design.gap.inference.channels.discrepancy_posterior import discrepancy_posterior
from hyperleg_design.gap.inference.channels.scales import Scales
from hyperleg_design.gap.inference.hypotheses.hypothesis import (
    Hypothesis,
    reduced,
    shifted,
    solve,
)
from hyperleg_design.gap.inference.hypotheses.stack import Stack
from hyperleg_design.gap.inference.rules import InferenceRules


@dataclass(frozen=True, eq=False)
class Prediction:
    """Samples under test, each predicted without its own block; in the residuals' units."""

    before: np.ndarray
    """Residual less what a healthy robot's discrepancy and the causes that references show, too,
    explain of it `(S,)`."""
    trace: np.ndarray
    """What the other causes leave `(S,)`."""
    unlisted: np.ndarray
    """What only effects that are not listed, and a discrepancy larger than a healthy robot's,
    explain `(S,)`."""

    @property
    def after(self) -> np.ndarray:
        """Residual less that and the causes' traces `(S,)`."""
        return self.before - self.trace

    @property
    def noise(self) -> np.ndarray:
        """What neither causes nor any discrepancy predict `(S,)`."""
        return self.after - self.unlisted


def predicted(evidence: Evidence, hypothesis: Hypothesis, rules: InferenceRules) -> Prediction:
    """Cross-validate a hypothesis over blocks, its scales fixed.

    Args:
        evidence: channels.
        hypothesis: fitted to all samples.
        rules: of the inference.
    """
    samples, weight = evidence.samples, evidence.weight
    fold = samples.fold[samples.part]
    tested = np.arange(len(fold)) < len(evidence.tests.value)
    stack = Stack.of(hypothesis.causes, evidence) if hypothesis.causes else None
    before = np.zeros(len(fold))
    trace, unlisted = np.zeros(len(fold)), np.zeros(len(fold))
    for left_out in range(samples.folds):
        fitted = (fold != left_out) | ~tested
        channels = tuple(_without(channel, fitted) for channel in evidence.channels)
        left, own, odd = np.zeros((3, len(fold)))
        if stack is not None:
            part = replace(evidence, channels=channels)
            products = reduced(part, hypothesis.scales, stack.rows * fitted)
            products = shifted(products, stack.constant_last)
            solution = solve(products, stack.low, stack.high, stack.shape, rules, stack.groups)
            left = stack.sizes(solution.theta) @ stack.rows
            for piece, cause in zip(hypothesis.parts, hypothesis.causes, strict=True):
                if cause.standing:
                    continue
                if cause.effect in UNLISTED:
                    odd += cause.trace(solution.theta[piece]) * weight
                else:
                    own += cause.trace(solution.theta[piece]) * weight
        for whole, some, scales in zip(evidence.channels, channels, hypothesis.scales, strict=True):
            means, _ = discrepancy_posterior(some.without(left * fitted), scales)
            healthy = healthy_share(whole, scales, rules)
            for cell, (place, white) in enumerate(zip(whole.places, whole.whitened, strict=True)):
                mine = (fold[place] == left_out) & tested[place]
                if not mine.any():
                    continue
                at = place[mine]
                explained = means[whole.session[cell]] @ white[:-1, mine]
                standing = left[at] - own[at] - odd[at]
                before[at] = (white[-1, mine] - healthy * explained - standing) / weight[at]
                unlisted[at] = ((1 - healthy) * explained + odd[at]) / weight[at]
                trace[at] = own[at] / weight[at]
    return Prediction(before, trace, unlisted)


def healthy_share(channel: Channel, scales: Scales, rules: InferenceRules) -> float:
    """Compute the share of a channel's discrepancy that a healthy robot would have, too.

    Without references a discrepancy up to one deviation of its prior above the median is healthy;
    with references, all of it but its growth under test.

    Args:
        channel: of the evidence.
        scales: fitted hyperparameters.
        rules: of the inference.

    Returns:
        The share, from 0 to 1.
    """
    prior = rules.discrepancy
    if channel.referenced:
        return float(np.exp(-scales.new))
    most = np.log(prior.standing) + prior.standing_spread
    return float(np.exp(min(most - scales.standing, 0.0)))


def _without(channel: Channel, fitted: np.ndarray) -> Channel:
    """A channel whose samples are those of a mask `(S,)`."""
    white = tuple(
        cell * fitted[place] for cell, place in zip(channel.whitened, channel.places, strict=True)
    )
    return replace(channel, whitened=white, products=np.array([cell @ cell.T for cell in white]))
