"""Hypotheses: sets of causes, and the fit of their sizes at fixed scales of noise and
discrepancy.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.special import erfcx

from hyperleg_design.gap.inference.assembly import Evidence
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.channels.crossing import Crossing
from hyperleg_design.gap.inference.channels.scales import Scales
from hyperleg_design.gap.inference.endogenous import Factor
from hyperleg_design.gap.inference.hypotheses.bounded_least_squares import within_bounds
from hyperleg_design.gap.inference.interactions import Acting
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.inference.shrinking import Shrinking

Name = tuple[str, str, bool]
"""Effect, location, and whether it acts in all logs, references included."""
EVERYWHERE = "*"
"""Location of an effect that acts at all of its places."""
FREE = 1e3
"""Prior deviation with which a fit begins that is to find large sizes, in usual sizes [-]."""
ALIKE = 1e-12
"""Share of its own square by which a column differs from all others, at least [-]."""
ROUNDS = 3
"""Fits in turn with priors that are widened to the sizes of the fit before."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """An effect at one place, or at all of its places."""

    effect: str
    location: str
    """Name of the place, or `EVERYWHERE`."""
    causes: tuple[Cause, ...]

    @property
    def standing(self) -> bool:
        """Whether it acts in all logs, references included."""
        return self.causes[0].standing

    @property
    def name(self) -> Name:
        """Effect, location, and whether it stands in the references, too."""
        return self.effect, self.location, self.standing


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """A set of candidates, fitted."""

    candidates: tuple[Candidate, ...]
    theta: np.ndarray
    """Parameters of all causes, in usual sizes from their nulls `(k,)`."""
    covariance: np.ndarray
    """Posterior covariance of `theta` `(k, k)`."""
    scales: tuple[Scales, ...]
    """Fitted noise and discrepancy of each channel."""
    log_evidence: float
    """Over that of nothing wrong [nat]."""
    log_prior: float
    """Log prior probability of the causes and their sizes [nat]."""

    @property
    def score(self) -> float:
        """Unnormalised log posterior probability [nat]."""
        return self.log_evidence + self.log_prior

    @property
    def causes(self) -> tuple[Cause, ...]:
        """Causes of all candidates of the hypothesis."""
        return tuple(cause for candidate in self.candidates for cause in candidate.causes)

    @property
    def names(self) -> tuple[Name, ...]:
        """Of the candidates, sorted."""
        return tuple(sorted(candidate.name for candidate in self.candidates))

    @cached_property
    def parts(self) -> list[slice]:
        """Where the parameters of each cause stand."""
        ends = np.cumsum([0, *(len(c.nulls) for c in self.causes)]).tolist()
        return [slice(start, stop) for start, stop in pairwise(ends)]

    @property
    def acting(self) -> list[Acting]:
        """Its causes with their sizes."""
        return [
            Acting(cause.effect, cause.location, cause.standing, self.values(place))
            for place, cause in enumerate(self.causes)
        ]

    def values(self, place: int) -> np.ndarray:
        """Look up the values of one cause's parameters.

        Args:
            place: index of the cause among `causes`.

        Returns:
            `(k,)`, in the parameters' units.
        """
        cause = self.causes[place]
        return np.clip(
            cause.nulls + self.theta[self.parts[place]] * cause.usual, cause.low, cause.high
        )

    def deviation(self, place: int) -> np.ndarray:
        """Look up the posterior standard deviations of one cause's parameters.

        Args:
            place: index of the cause among `causes`.

        Returns:
            `(k,)`, in the parameters' units.
        """
        variance = np.diag(self.covariance)[self.parts[place]]
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)) * self.causes[place].usual)


def reduced(evidence: Evidence, scales: Sequence[Scales], columns: np.ndarray) -> np.ndarray:
    """Products of residual and columns in the metric of the marginal covariance, over all channels.

    Args:
        evidence: channels.
        scales: hyperparameters by channel.
        columns: weighted as the residual `(m, S)`.

    Returns:
        `(m + 1, m + 1)`, the residual first.
    """
    return Crossing.of(evidence.channels, columns).reduced(evidence.channels, scales)


@dataclass(frozen=True, eq=False)
class Solution:
    """Causes at the maximum of their posterior, at fixed scales of noise and discrepancy."""

    theta: np.ndarray
    covariance: np.ndarray
    gain: float
    """Log evidence over that of theta = 0, the discrepancy integrated out [nat]."""
    occam: float
    """The part of it that theta's own prior and uncertainty make [nat]."""


def solve(
    products: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    shape: np.ndarray,
    rules: InferenceRules,
    groups: Sequence[tuple[list[int], Factor | Shrinking]] = (),
    near: np.ndarray | None = None,
) -> Solution:
    """Compute the posterior of causes by Laplace's method, which is exact where all are linear and
    within bounds.

    The prior of a size is normal with the width `rules.cause.width`; where the fit lies beyond
    that, the width follows the fit, and `occam` charges for it.

    Args:
        products: as of `reduced`.
        low: bounds of theta `(k,)`.
        high: the same.
        shape: parameters that only shape a trace; their prior deviation is 1 `(k,)`.
        rules: of the inference.
        groups: as of `Stack`.
        near: theta of a solution of about the same problem, of the first parameters `(j,)`; without
            it, small and large sizes are both looked for.
    """
    # columns that are alike to rounding must not make the normal equations singular
    normal = products[1:, 1:] * (1 + ALIKE * np.eye(len(low)))
    begin, wide = np.zeros(len(low)), np.full(len(low), FREE)
    firsts = [np.full(len(low), rules.cause.width), wide]
    if near is not None:
        begin[: len(near)] = near
        wide[: len(near)] = np.maximum(rules.cause.width, np.abs(near))
        firsts = [wide]
    squares = [(own, np.ix_(own, own), factor) for own, factor in groups]
    fits = [
        _solve(normal, products[1:, 0], low, high, shape, rules, squares, begin, first)
        for first in firsts
    ]
    theta, precision, gain, occam = max(fits, key=lambda fit: fit[2])
    covariance = np.linalg.inv(precision) if len(theta) else np.zeros((0, 0))
    return Solution(theta, covariance, gain, occam)


def _solve(
    normal: np.ndarray,
    right: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    shape: np.ndarray,
    rules: InferenceRules,
    groups: Sequence[tuple[list[int], Any, Factor | Shrinking]],
    theta: np.ndarray,
    first: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, float, float]:
    """As `solve`, from some theta and a first prior deviation of the sizes: theta, its precision,
    gain and occam.
    """
    deviation = np.where(shape, 1.0, first)
    for turn in range(ROUNDS):
        if turn:
            wider = np.where(shape, 1.0, np.maximum(rules.cause.width, np.abs(theta)))
            if not groups and np.array_equal(wider, deviation):
                break
            deviation = wider
        precision, target = normal + np.diag(1 / deviation**2), right.copy()
        for own, square, factor in groups:
            slope, bend = factor.slopes(theta[own])
            precision[square] += bend
            target[own] += slope + bend @ theta[own]
        theta = within_bounds(precision, target, low, high)
    occam = -0.5 * float(np.sum((theta / deviation) ** 2))
    occam -= float(np.sum(np.log(deviation))) + 0.5 * float(np.linalg.slogdet(precision)[1])
    occam += sum(factor.log(theta[own]) for own, _, factor in groups)
    occam += _beyond(theta, precision, target, low, high, shape)
    gain = float(right @ theta - 0.5 * theta @ normal @ theta)
    return theta, precision, gain + occam, occam


def _beyond(
    theta: np.ndarray,
    precision: np.ndarray,
    target: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    shape: np.ndarray,
) -> float:
    """Correct Laplace's method for sizes at their bounds, where the posterior falls off to one side
    [nat]: log of the integral of exp(-z t - t^2 / 2) over t > 0, over the integral of exp(-t^2 / 2)
    over all t, with the slope z at the bound in standard deviations.
    """
    slope = target - precision @ theta
    held = ~shape & (low < high)
    at_end = ((theta <= low) & (slope < 0)) | ((theta >= high) & (slope > 0))
    if not (held & at_end).any():
        return 0.0
    z = (np.abs(slope) / np.sqrt(np.diag(precision)))[held & at_end]
    return float(np.sum(np.log(0.5 * erfcx(z / np.sqrt(2)))))


def shifted(products: np.ndarray, last: bool) -> np.ndarray:
    """Take a constant trace off the residual, in products of both.

    Args:
        products: of residual, columns and the constant trace, as of `reduced`.
        last: whether the last column is a constant trace.

    Returns:
        Products of what is left of the residual and of the columns.
    """
    if not last:
        return products
    shifted_products = products.copy()
    shifted_products[0] -= products[-1]
    shifted_products[:, 0] -= shifted_products[:, -1]
    return shifted_products[:-1, :-1]
