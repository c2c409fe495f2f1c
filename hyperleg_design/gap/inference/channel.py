"""The probabilistic model of one residual channel, and its marginal likelihood in closed form.

A channel is one row of a residual (the torque of one joint, say) in all logs. Its samples y of
session s, over their expected noise, are

    y_s = x_s theta + C_s (w + delta_s) + e_s,
    w ~ N(0, a^2 I),   delta_s ~ N(0, d_s^2 I),   e_s ~ N(0, diag(noise of the band)),

with causes x theta, discrepancy columns C in units of their prior deviations, a standing
discrepancy w that all sessions share, and its change delta_s in one session. A session under test
may have a larger change than its reference logs (`new`): that is an unlisted effect. Only sums of
products of C, y and x are needed, so that the cost does not depend on the length of the logs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.linalg import solve_triangular

if TYPE_CHECKING:
    from hyperleg_design.gap.inference.rules import DiscrepancyRules, InferenceRules

STEPS = (1.2, 0.5, 0.2)
"""Steps of the search for a scale's logarithm, each halved about [-]."""
MOST_STEPS = 4
"""Of each of `STEPS`."""
ABSENT = 1e-3
"""Logarithm of `Scales.new` up to which nothing unlisted acts [-]."""


@dataclass(frozen=True, eq=False)
class Scales:
    """Hyperparameters of one channel."""

    noise: np.ndarray
    """Variance of the noise over what is expected, by band `(b,)` [-]."""
    standing: float = 0.0
    """Logarithm of the scale of the discrepancy that all sessions share."""
    change: float = 0.0
    """Logarithm of the scale of its change from session to session."""
    new: float = 0.0
    """Logarithm of how much larger the change is in sessions under test; 0 of a healthy robot."""


@dataclass(frozen=True, eq=False)
class Turned:
    """Products of one channel at given noise, each session's discrepancy columns turned to where
    they are apart, so that no scale needs a new decomposition of them.
    """

    values: np.ndarray
    """Products of the columns with themselves `(sessions, k)`."""
    axes: np.ndarray
    """`(sessions, k, k)`"""
    cross: np.ndarray
    """With the residual `(sessions, k)`."""
    square: float
    """Of the residual with itself, all sessions."""
    spread: float
    """Log determinant of the noise."""

    def log_likelihood(self, change: np.ndarray, standing: float) -> float:
        """As of `Channel.log_likelihood`.

        Args:
            change: scale of the change of each session `(sessions,)`.
            standing: logarithm of the scale of the standing discrepancy.
        """
        squares = change[:, None] ** 2
        shrunk = 1 / (1 + squares * self.values)
        left_own = self.axes * (shrunk * self.values)[:, None, :]
        whole = np.exp(2 * standing) * np.tensordot(left_own, self.axes, ((0, 2), (0, 2)))
        whole[np.diag_indices_from(whole)] += 1.0
        factor = np.linalg.cholesky(whole)
        cross = np.einsum("sij,sj->i", self.axes, shrunk * self.cross)
        taken = np.exp(standing) * solve_triangular(factor, cross, lower=True, check_finite=False)
        left = self.square - float(np.sum(squares * shrunk * self.cross**2)) - float(taken @ taken)
        determinant = 2 * float(np.log(np.diag(factor)).sum()) - float(np.log(shrunk).sum())
        return -0.5 * (left + determinant + self.spread)


@dataclass(frozen=True, eq=False)
class Channel:
    """Sums of products of one channel, by cell: one band of one session."""

    residual: str
    column: int
    name: str
    """Joint, motor, foot and axis, or axis of the base."""
    products: np.ndarray
    """Of the k discrepancy columns and the residual `(cells, k + 1, k + 1)`."""
    number: np.ndarray
    """Independent numbers `(cells,)`."""
    session: np.ndarray
    """Of each cell `(cells,)`, from 0."""
    band: np.ndarray
    """Of each cell `(cells,)`, from 0; those of reference logs are others."""
    frequency: np.ndarray
    """Which band of the filter each band is `(b,)`."""
    tested: np.ndarray
    """Whether a session is under test `(sessions,)`."""
    places: tuple[np.ndarray, ...]
    """Which of the evidence's samples each cell holds."""
    whitened: tuple[np.ndarray, ...]
    """Discrepancy columns and residual of each cell `(k + 1, samples)`."""

    @property
    def columns(self) -> int:
        """K."""
        return self.products.shape[1] - 1

    @cached_property
    def numbers(self) -> np.ndarray:
        """Independent numbers by band `(b,)`."""
        return np.bincount(self.band, self.number)

    @cached_property
    def bands_tested(self) -> np.ndarray:
        """Bands of logs under test `(t,)`."""
        return np.unique(self.band[self.tested[self.session]])

    @cached_property
    def bands_alike(self) -> np.ndarray:
        """The band of references at the same frequency as each of `bands_tested`, -1 where there is
        none `(t,)`.
        """
        others = np.setdiff1d(self.band, self.bands_tested)
        place = {int(self.frequency[one]): int(one) for one in others}
        return np.array([place.get(int(self.frequency[one]), -1) for one in self.bands_tested])

    def usual_noise(self, noise: np.ndarray, rules: InferenceRules) -> np.ndarray:
        """Variance that noise of a healthy robot has in each of `bands_tested`: that of the
        references, else the expected one, but not less than `NoiseRules.least` `(t,)`.

        Args:
            noise: by band `(b,)`.
            rules: of the inference.
        """
        alike = self.bands_alike
        return np.maximum(np.where(alike >= 0, noise[alike], 1.0), rules.noise.least)

    def noisy(self, noise: np.ndarray, rules: InferenceRules) -> tuple[float, float]:
        """Log prior densities of the noise under test [nat]: of a healthy robot, and where
        something unlisted makes noise; the prior probabilities of both included.
        """
        own = rules.noise
        spread = np.where(self.bands_alike >= 0, own.spread, own.alone_spread)
        over = np.log(noise[self.bands_tested] / self.usual_noise(noise, rules)) / spread
        odds = rules.discrepancy.unlisted_probability
        shared = -float(np.log(spread).sum())
        healthy = shared - 0.5 * float(over @ over)
        farther = (over - own.unlisted) / own.unlisted_spread
        unlisted = shared - 0.5 * float(farther @ farther)
        unlisted -= len(over) * float(np.log(own.unlisted_spread))
        return float(np.log(1 - odds)) + healthy, float(np.log(odds)) + unlisted

    @property
    def referenced(self) -> bool:
        """Whether reference logs teach the standing discrepancy."""
        return not bool(self.tested.all())

    @property
    def changes(self) -> bool:
        """Whether more than one session tells a change from what stands."""
        return len(self.tested) > 1

    @cached_property
    def samples(self) -> np.ndarray:
        """All samples of this channel `(n,)`."""
        return np.sort(np.concatenate(self.places))

    @cached_property
    def under_test(self) -> np.ndarray:
        """Those of logs under test `(n,)`."""
        tested = self.tested[self.session]
        own = [place for place, mine in zip(self.places, tested, strict=True) if mine]
        return np.sort(np.concatenate(own))

    def start(self, rules: InferenceRules) -> Scales:
        """Scales to begin with: noise that explains everything."""
        count = len(self.numbers)
        square = np.bincount(self.band, self.products[:, -1, -1], count)
        weight = rules.noise.weight
        noise = np.maximum((weight + square) / (weight + self.numbers), 1.0)
        prior = rules.discrepancy
        standing = prior.referenced if self.referenced else prior.standing
        return Scales(noise, float(np.log(standing)), float(np.log(prior.change)))

    def crossed(self, columns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Sums of products with further columns.

        Args:
            columns: weighted as the residual `(m, S)`.

        Returns:
            With the discrepancy columns and the residual `(cells, k + 1, m)`, and among themselves
            `(cells, m, m)`.
        """
        m = len(columns)
        cross = np.zeros((len(self.number), self.columns + 1, m))
        own = np.zeros((len(self.number), m, m))
        for cell, (place, white) in enumerate(zip(self.places, self.whitened, strict=True)):
            mine = columns[:, place]
            if mine.any():
                cross[cell], own[cell] = white @ mine.T, mine @ mine.T
        return cross, own

    def without(self, trace: np.ndarray) -> Channel:
        """The channel whose residual lacks a trace `(S,)`, weighted as the residual."""
        white = list(self.whitened)
        for cell, place in enumerate(self.places):
            if trace[place].any():
                white[cell] = white[cell].copy()
                white[cell][-1] -= trace[place]
        cross, own = self.crossed(trace[None])
        k = self.columns
        found = self.products.copy()
        found[:, :k, k] -= cross[:, :k, 0]
        found[:, k, :k] -= cross[:, :k, 0]
        found[:, k, k] += own[:, 0, 0] - 2 * cross[:, k, 0]
        return replace(self, products=found, whitened=tuple(white))

    def stacked(self, cross: np.ndarray, own: np.ndarray) -> np.ndarray:
        """Products of discrepancy columns, residual and further columns, as of `crossed` `(cells, k
        + 1 + m, k + 1 + m)`.
        """
        size, m = self.columns + 1, own.shape[1]
        found = np.empty((len(self.number), size + m, size + m))
        found[:, :size, :size], found[:, :size, size:] = self.products, cross
        found[:, size:, :size], found[:, size:, size:] = cross.swapaxes(1, 2), own
        return found

    def summed(self, noise: np.ndarray, products: np.ndarray | None = None) -> np.ndarray:
        """Products over the noise, by session `(sessions, n, n)`."""
        products = self.products if products is None else products
        share = (self.session == np.arange(len(self.tested))[:, None]) / noise[self.band]
        return np.asarray(np.tensordot(share, products, 1))

    def change_scales(self, scales: Scales) -> np.ndarray:
        """D of each session `(sessions,)`; 0 where a single session cannot tell it."""
        if not self.changes:
            return np.zeros(len(self.tested))
        return np.exp(scales.change + np.where(self.tested, scales.new, 0.0))

    def reduced(self, scales: Scales, summed: np.ndarray) -> np.ndarray:
        """Integrate the discrepancy out.

        Args:
            scales: hyperparameters.
            summed: products by session, the k discrepancy columns first `(sessions, k + m, k + m)`.

        Returns:
            Products of the other m columns in the metric of the marginal covariance `(m, m)`.
        """
        k = self.columns
        change = self.change_scales(scales)[:, None, None] ** 2
        own, cross, rest = summed[:, :k, :k], summed[:, :k, k:], summed[:, k:, k:]
        eye = np.eye(k)
        solved = np.linalg.solve(eye + change * own, np.concatenate([cross, own], -1))
        cross_left, own_left = solved[..., : cross.shape[-1]].sum(0), solved[..., -k:].sum(0)
        taken = change * cross.swapaxes(1, 2) @ solved[..., : cross.shape[-1]]
        shared = np.exp(2 * scales.standing)
        whole = eye + shared * 0.5 * (own_left + own_left.T)
        left: np.ndarray = (rest - taken).sum(0)
        return left - shared * cross_left.T @ np.linalg.solve(whole, cross_left)

    def turned(self, noise: np.ndarray) -> Turned:
        """The products at some noise, in the axes in which each session's columns are apart."""
        summed, k = self.summed(noise), self.columns
        values, axes = np.linalg.eigh(summed[:, :k, :k])
        cross = (summed[:, None, k, :k] @ axes)[:, 0]
        spread = float(self.numbers @ np.log(noise))
        return Turned(np.maximum(values, 0.0), axes, cross, float(summed[:, k, k].sum()), spread)

    def log_likelihood(self, scales: Scales, turned: Turned | None = None) -> float:
        """Marginal log-likelihood of the residual, up to what all models share [nat].

        Args:
            scales: hyperparameters.
            turned: the products at the noise of these.
        """
        turned = self.turned(scales.noise) if turned is None else turned
        return turned.log_likelihood(self.change_scales(scales), scales.standing)

    def log_prior(self, scales: Scales, rules: InferenceRules) -> float:
        """Log prior density of the hyperparameters, up to a constant [nat]."""
        prior = rules.discrepancy
        taught = np.delete(scales.noise, self.bands_tested)
        noise = -0.5 * rules.noise.weight * float(np.sum(np.log(taught) + 1 / taught))
        noise += float(np.logaddexp(*self.noisy(scales.noise, rules)))
        if not self.referenced:
            found = noise + _mixed(scales.standing, prior)
        else:
            found = noise + _normal(scales.standing, prior.referenced, prior.referenced_spread)
            odds = prior.unlisted_probability
            found += (
                float(np.log(1 - odds))
                if scales.new <= ABSENT
                else float(np.log(odds))
                + _normal(scales.new, prior.unlisted, prior.unlisted_spread)
            )
        if self.changes:
            found += _normal(scales.change, prior.change, prior.change_spread)
        return found

    def log_posterior(
        self, scales: Scales, rules: InferenceRules, turned: Turned | None = None
    ) -> float:
        """Log-likelihood and log prior of the hyperparameters [nat]."""
        return self.log_likelihood(scales, turned) + self.log_prior(scales, rules)

    def discrepancy(self, scales: Scales) -> tuple[np.ndarray, np.ndarray]:
        """Posterior of w + delta_s: means `(sessions, k)` and covariances `(sessions, k, k)`."""
        k = self.columns
        summed = self.summed(scales.noise)
        own, right = summed[:, :k, :k], summed[:, :k, k]
        change = self.change_scales(scales) ** 2
        inverse = np.linalg.inv(np.eye(k) + change[:, None, None] * own)
        total = np.einsum("sij,sjk->ik", own, inverse)
        target = np.einsum("sji,sj->i", inverse, right)
        shared = np.linalg.inv(np.eye(k) * np.exp(-2 * scales.standing) + 0.5 * (total + total.T))
        mean = shared @ target
        spread = change[:, None, None] * inverse
        kept = np.eye(k) - spread @ own
        means = mean + np.einsum("sij,sj->si", spread, right - own @ mean)
        return means, spread + kept @ shared @ kept.swapaxes(1, 2)

    def fitted(
        self,
        scales: Scales,
        rules: InferenceRules,
        sweeps: int = 3,
        steps: tuple[float, ...] = STEPS,
    ) -> Scales:
        """Hyperparameters at the maximum of their posterior: noise by expectation maximisation,
        scales by a line search each.

        Args:
            scales: to begin with.
            rules: of the inference.
            sweeps: of noise and scales in turn.
            steps: of the searches for a scale's logarithm.
        """
        k, weight = self.columns, rules.noise.weight
        for _ in range(sweeps):
            means, covariances = self.discrepancy(scales)
            mean = np.concatenate([-means, np.ones((len(means), 1))], 1)[self.session]
            square = np.einsum("ci,cij,cj->c", mean, self.products, mean)
            square += np.einsum("cij,cji->c", self.products[:, :k, :k], covariances[self.session])
            left = np.bincount(self.band, np.maximum(square, 0.0), len(self.numbers))
            usual = np.ones(len(self.numbers))
            usual[self.bands_tested] = self.usual_noise(scales.noise, rules)
            scales = replace(scales, noise=(weight * usual + left) / (weight + self.numbers))
            turned = self.turned(scales.noise)
            scales = self._searched(scales, "standing", rules, turned, steps)
            if self.changes:
                scales = self._searched(scales, "change", rules, turned, steps)
        if self.referenced:
            turned = self.turned(scales.noise)
            healthy = replace(scales, new=0.0)
            begin = max(scales.new, float(np.log(rules.discrepancy.unlisted)) / 2)
            unlisted = self._searched(replace(scales, new=begin), "new", rules, turned, steps)
            scales = max(
                (healthy, unlisted), key=lambda one: self.log_posterior(one, rules, turned)
            )
        return scales

    def _searched(
        self,
        scales: Scales,
        name: str,
        rules: InferenceRules,
        turned: Turned,
        steps: tuple[float, ...],
    ) -> Scales:
        def moved(value: float) -> Scales:
            changes: dict[str, Any] = {name: value}
            return replace(scales, **changes)

        def score(value: float) -> float:
            return self.log_posterior(moved(value), rules, turned)

        lowest = 2 * ABSENT if name == "new" else -np.inf
        return moved(_climbed(score, float(getattr(scales, name)), lowest, steps))


def _climbed(
    score: Callable[[float], float], begin: float, lowest: float, steps: tuple[float, ...]
) -> float:
    """Where a function of one variable has a local maximum, by steps that shrink."""
    best, value = begin, score(begin)
    for step in steps:
        for _ in range(MOST_STEPS):
            for other in (best + step, max(best - step, lowest)):
                trial = score(other)
                if trial > value + 1e-9:
                    best, value = other, trial
                    break
            else:
                break
    return best


def _normal(logarithm: float, median: float, spread: float) -> float:
    """Log density of a scale's logarithm, without 2 pi."""
    return float(-0.5 * ((logarithm - np.log(median)) / spread) ** 2 - np.log(spread))


def _mixed(logarithm: float, prior: DiscrepancyRules) -> float:
    """Log density of the standing scale of a robot without references: healthy, or with something
    unlisted.
    """
    healthy = _normal(logarithm, prior.standing, prior.standing_spread)
    unlisted = _normal(logarithm, prior.unlisted, prior.unlisted_spread)
    odds = prior.unlisted_probability
    return float(np.logaddexp(np.log(1 - odds) + healthy, np.log(odds) + unlisted))
