"""The probabilistic model of one residual channel, and its marginal likelihood in closed form.

A channel is one row of a residual (the torque of one joint, say) in all logs. Its samples y of
session s, over their expected noise, are

    y_s = x_s theta + C_s (w + delta_s) + e_s,
    w ~ N(0, a^2 I),   delta_s ~ N(0, d_s^2 J),   e_s ~ N(0, diag(noise of the band)),

with causes x theta, discrepancy columns C in units of their prior deviations, a standing
discrepancy w that all sessions share, and its change delta_s in one session, 0 of steady columns,
for which the diagonal of J is 0, not 1. Of the first `known` steady ones a is 1: no scale alters a
deviation that is known. A session under test may have a larger change than its reference logs
(`new`): that is an unlisted effect. Only sums of products of C, y and x are needed, so that the
cost does not depend on the length of the logs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from scipy.linalg.lapack import dtrtrs

from hyperleg_design.gap.inference.channels.cells import Cells
from hyperleg_design.gap.inference.channels.likelihood import Likelihood
from hyperleg_design.gap.inference.channels.residual import Residual
from hyperleg_design.gap.inference.channels.scales import Scales, log_prior_of_scales
from hyperleg_design.gap.inference.channels.spectrum import Spectrum
from hyperleg_design.gap.inference.rules import InferenceRules

NOISES = 3
"""Noises of a channel whose spectra are kept."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Channel(Cells):
    """Sums of products of one channel, by cell, and what they say of causes."""

    residual: str
    column: int
    name: str
    """Joint, motor, foot and axis, or axis of the base."""
    products: np.ndarray
    """Of the k discrepancy columns and the residual `(cells, k + 1, k + 1)`."""
    steady: int = 0
    """Number of discrepancy columns, the first ones, that are the same in all sessions."""
    known: int = 0
    """Number of these, the first ones, whose deviation is known."""

    @property
    def columns(self) -> int:
        """Number K of columns of the discrepancy model."""
        return self.products.shape[1] - 1

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
        """Compare noise of a healthy robot with noise of something unlisted.

        Args:
            noise: variance over the expected one, by band `(b,)`.
            rules: of the inference.

        Returns:
            Log prior densities of the noise under test, if the robot is healthy, and if something
            unlisted makes noise; the prior probabilities of both included [nat].
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

    @cached_property
    def whole_residual(self) -> Residual:
        """Products of the residual as it is."""
        return Residual(self.products[:, :-1, -1], self.products[:, -1, -1])

    def left(self, cross: np.ndarray, own: np.ndarray, theta: np.ndarray) -> Residual:
        """Products of what is left of the residual without a trace.

        Args:
            cross: products with the trace's columns, as of `crossed` `(cells, k + 1, m)`.
            own: among themselves `(cells, m, m)`.
            theta: the trace over these columns `(m,)`.
        """
        taken = cross @ theta
        square = self.whole_residual.square - 2 * taken[:, -1] + own @ theta @ theta
        return Residual(self.whole_residual.cross - taken[:, :-1], square)

    def without(self, trace: np.ndarray) -> Channel:
        """Subtract a trace from the residual.

        Args:
            trace: weighted as the residual `(S,)`.

        Returns:
            The channel with what is left as its residual.
        """
        white = list(self.whitened)
        for cell, place in enumerate(self.places):
            if trace[place].any():
                white[cell] = white[cell].copy()
                white[cell][-1] -= trace[place]
        cross, own = self.crossed(trace[None])
        k = self.columns
        products = self.products.copy()
        products[:, :k, k] -= cross[:, :k, 0]
        products[:, k, :k] -= cross[:, :k, 0]
        products[:, k, k] += own[:, 0, 0] - 2 * cross[:, k, 0]
        return replace(self, products=products, whitened=tuple(white))

    @cached_property
    def _spectra(self) -> Callable[[bytes], Spectrum]:
        """Spectra at the noise that some bytes hold."""
        products = np.ascontiguousarray(self.products[:, :-1, :-1])
        tested, band, steady, known = self.tested, self.band, self.steady, self.known
        sessions = self.session == np.arange(len(tested))[:, None]

        @lru_cache(maxsize=NOISES)
        def spectrum(noise: bytes) -> Spectrum:
            share = sessions / np.frombuffer(noise)[band]
            return Spectrum(np.tensordot(share, products, 1), tested, steady, known)

        return spectrum

    def spectrum(self, noise: np.ndarray) -> Spectrum:
        """Decompose the discrepancy columns of each session, once for all scales of the
        discrepancy.

        Args:
            noise: variance over the expected one, by band `(b,)`.
        """
        return self._spectra(np.ascontiguousarray(noise, float).tobytes())

    def change_scales(self, scales: Scales) -> np.ndarray:
        """Compute the scale d_s of the change in each session.

        Args:
            scales: hyperparameters.

        Returns:
            `(sessions,)`; 0 where there is a single session, which shows no change.
        """
        if not self.changes:
            return np.zeros(len(self.tested))
        return np.exp(scales.change + np.where(self.tested, scales.new, 0.0))

    def reduced(
        self, scales: Scales, cross: np.ndarray | None = None, own: np.ndarray | None = None
    ) -> np.ndarray:
        """Integrate the discrepancy out.

        Args:
            scales: hyperparameters.
            cross: products of the discrepancy columns and the residual with m further columns, as
                of `crossed` `(cells, k + 1, m)`; none by default.
            own: of these among themselves `(cells, m, m)`.

        Returns:
            Products of the residual and these columns in the metric of the marginal covariance
            `(m + 1, m + 1)`.
        """
        weight = 1 / scales.noise[self.band]
        right = self.whole_residual.cross[:, :, None]
        rest = np.full((1, 1), weight @ self.whole_residual.square)
        if cross is not None and own is not None:
            right = np.concatenate([right, cross[:, :-1]], -1)
            m = own.shape[1]
            beside, rest = weight @ cross[:, -1], np.pad(rest, (0, m))
            rest[0, 1:], rest[1:, 0] = beside, beside
            rest[1:, 1:] = (weight @ own.reshape(len(own), -1)).reshape(m, m)
        taken = self.taken(scales, right)
        return np.asarray(rest - taken.T @ taken)

    def taken(self, scales: Scales, cross: np.ndarray) -> np.ndarray:
        """What the discrepancy takes of columns, as vectors: of the products of two columns over
        the noise, it takes that of their vectors.

        Args:
            scales: hyperparameters.
            cross: products of the discrepancy columns with m others `(cells, k, m)`.

        Returns:
            `(sessions (k - steady) + k, m)`.
        """
        spectrum, change = self.spectrum(scales.noise), self.change_scales(scales)
        cross = self.summed(scales.noise, cross)
        turned, shrunk = spectrum.turned(cross), spectrum.shrunk(change)
        shared, _ = dtrtrs(
            spectrum.factor(change, scales.standing),
            spectrum.standing_scales(scales.standing)[:, None]
            * spectrum.left(change, cross, turned),
            lower=1,
        )
        alone = (change[:, None] * np.sqrt(shrunk))[:, :, None] * turned
        return np.concatenate([alone.reshape(-1, cross.shape[-1]), shared])

    def likelihood(self, noise: np.ndarray, residual: Residual | None = None) -> Likelihood:
        """Marginal log-likelihood of a residual at some noise, as a function of the scales.

        Args:
            noise: by band `(b,)`.
            residual: as it is by default.
        """
        residual = self.whole_residual if residual is None else residual
        spectrum = self.spectrum(noise)
        cross = self.summed(noise, residual.cross)[:, :, None]
        square = float(residual.square @ (1 / noise[self.band]))
        return Likelihood(spectrum, cross, square, float(self.numbers @ np.log(noise)))

    def log_likelihood(self, scales: Scales, residual: Residual | None = None) -> float:
        """Marginal log-likelihood of a residual, up to what all models share [nat].

        Args:
            scales: hyperparameters.
            residual: as it is by default.
        """
        return self.likelihood(scales.noise, residual).at(
            self.change_scales(scales), scales.standing
        )

    def log_prior_of_noise(self, noise: np.ndarray, rules: InferenceRules) -> float:
        """Compute the log prior density of the noise, up to a constant [nat].

        Args:
            noise: variance over the expected one, by band `(b,)`.
            rules: of the inference.
        """
        taught = np.delete(noise, self.bands_tested)
        density = -0.5 * rules.noise.weight * float(np.sum(np.log(taught) + 1 / taught))
        return density + float(np.logaddexp(*self.noisy(noise, rules)))

    def log_prior_of_scales(self, scales: Scales, rules: InferenceRules) -> float:
        """Compute the log prior density of the scales of the discrepancy, up to a constant [nat].

        Args:
            scales: hyperparameters.
            rules: of the inference.
        """
        return log_prior_of_scales(scales, rules.discrepancy, self.referenced, self.changes)

    def log_posterior(
        self, scales: Scales, rules: InferenceRules, residual: Residual | None = None
    ) -> float:
        """Add up the log-likelihood of a residual and the log prior of the hyperparameters [nat].

        Args:
            scales: hyperparameters.
            rules: of the inference.
            residual: the channel's whole residual by default.
        """
        prior = self.log_prior_of_noise(scales.noise, rules)
        prior += self.log_prior_of_scales(scales, rules)
        return self.log_likelihood(scales, residual) + prior
