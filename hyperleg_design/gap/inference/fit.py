"""Fits by generalised least squares: causes linearised, nuisance parameters of each session as
random effects, noise scaled by group.

With samples over their floor, y = c + X phi + Z z_s + e, phi ~ N(0, WIDTH^2) in usual sizes, z_s ~
N(mean, covariance) of session s, e ~ N(0, scale_g^2). Scales are fitted along: scale_g^2 = (nu +
rss_g) / (nu + n_g), the floor counting for `nu` numbers. All fits work on sums of products, so that
one more costs little.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from hyperleg_design.gap.inference.base import Base, number_of
from hyperleg_design.gap.inference.endogenous import Factor, Shrinking
from hyperleg_design.gap.inference.samples import BLOCKS, Products, products
from hyperleg_design.gap.inference.sums import Sums

WIDTH = 4.0
"""Standard deviation of a cause's parameters over their usual distance from the null (assumed:
wide)."""
ROUNDS = 3
"""Fits between which the noise's scales are set anew."""
CLAMPS = 4
"""Fits in which nuisance parameters that would leave their limits are set to them."""
SINGULAR = 1e-13
"""Least eigenvalue, over the diagonal, of normal equations that are solved within bounds: less is
rounding."""
TRUST = 3.0
"""Standard deviations from the fit to all data within which causes that are not linear are taken as
linear on parts of them."""


@dataclass(frozen=True, eq=False)
class Cause:
    """One effect at one place, linearised at some values; its trace is `constant + columns phi`
    with phi = (values - nulls) / usual.
    """

    effect: str
    location: str
    values: np.ndarray
    """At which it is linearised `(k,)`."""
    nulls: np.ndarray
    usual: np.ndarray
    low: np.ndarray
    high: np.ndarray
    """Bounds `(k,)` each."""
    shape: np.ndarray
    """Parameters that only shape `(k,)` of bool."""
    columns: np.ndarray
    """`(k, S)` in the residual's unit."""
    constant: np.ndarray
    """`(S,)`; 0 where the trace is linear."""
    linear: bool
    declared: float = 0.0
    """Payload that the logs declare at its place [kg]."""
    factor: Factor | Shrinking | None = None
    """How it scales the torque that the residual trusts, or noise of accelerations."""
    unseen: bool = False
    """Whether no log has the signal that drives it, a voltage or a temperature, so that it is
    modelled."""
    unsettling: bool = False
    """Whether it can make control loops unstable, and a joint that it acts on chatters."""
    doubtful: bool = False
    """Whether it needs more evidence, see `Effect.doubtful`."""
    beyond: int = 1
    """Joints in a row that its link carries, see `Mechanism.beyond`."""
    odds: float = 0.0
    """Log odds for it by what logs tell beside their residuals, see `telling`, and by its values,
    see `Effect.odds`."""
    standing: bool = False
    """Whether it acts in all logs, reference logs included, not in those under test alone."""

    @property
    def name(self) -> tuple[str, str]:
        """Effect and location."""
        return self.effect, self.location

    @property
    def phi(self) -> np.ndarray:
        """`values` in usual sizes from the nulls."""
        return np.asarray((self.values - self.nulls) / self.usual)

    def trace(self, phi: np.ndarray) -> np.ndarray:
        """Its trace at some phi `(k,)`, in the residual's unit `(S,)`."""
        return np.asarray(phi @ self.columns + (0.0 if self.linear else self.constant))


def parts(causes: Sequence[Cause]) -> list[slice]:
    """Where each cause's parameters stand in the phi of all."""
    ends = np.cumsum([0, *(len(c.nulls) for c in causes)]).tolist()
    return [slice(start, stop) for start, stop in pairwise(ends)]


@dataclass(frozen=True, eq=False)
class Fit:
    """Result of a fit."""

    phi: np.ndarray
    """Of all causes one after the other."""
    covariance: np.ndarray
    """Of phi, nuisance parameters and noise's scale included."""
    errors: np.ndarray
    """Of each session `(sessions, p)`."""
    scale: np.ndarray
    """Variance over the floor's `(G,)`."""
    evidence: float
    """Laplace's log evidence, up to what all fits of the same samples share."""
    rss: np.ndarray
    """`(G,)`, over the floor."""
    implausible: float
    """Half the nuisance parameters' square in their own priors: what they cost."""


class Design:
    """Columns of some causes beside a base, ready for fits.

    Args:
        base: residual and nuisance parameters.
        causes: linearised.
        ridge: columns that belong to no cause, weighted `(k, S)`, with unit prior variance.
    """

    def __init__(
        self, base: Base, causes: Sequence[Cause] = (), ridge: np.ndarray | None = None
    ) -> None:
        self.base, self.causes = base, tuple(causes)
        self._kept: dict[tuple[int, int, int, bool], tuple[np.ndarray, np.ndarray]] = {}
        weight = base.samples.weight
        weighed = [c.columns * weight for c in causes] + ([] if ridge is None else [ridge])
        self.count = sum(len(w) for w in weighed)
        free = 0 if ridge is None else len(ridge)
        self.deviation = np.concatenate(
            [*(np.where(c.shape, 1.0, WIDTH) for c in causes), np.ones(free)]
        )
        self.sizes = np.concatenate([*(~c.shape for c in causes), np.zeros(free, bool)])
        self.low = np.concatenate(
            [*((c.low - c.nulls) / c.usual for c in causes), np.full(free, -np.inf)]
        )
        self.high = np.concatenate(
            [*((c.high - c.nulls) / c.usual for c in causes), np.full(free, np.inf)]
        )
        own = zip(parts(self.causes), self.causes, strict=True)
        self.factors = [
            (part.start + c.factor.parameter, c.factor) for part, c in own if c.factor is not None
        ]
        constant = np.zeros(len(weight))
        for c in causes:
            if not c.linear:
                constant = constant + c.constant
        self.constant = constant * weight
        self.shifted = bool(self.constant.any())
        self.columns = (
            np.concatenate([*weighed, self.constant[None]])
            if weighed
            else np.zeros((1, len(weight)))
        )
        self.empty = not (self.count or self.shifted)

    @cached_property
    def whole(self) -> Products:
        """Of its columns, by session."""
        return products(self.base.samples, self.columns, self.base.packed, whole=True)

    @cached_property
    def products(self) -> Products:
        """Of its columns, by part."""
        return products(self.base.samples, self.columns, self.base.packed)

    def widened(self, phi: np.ndarray) -> np.ndarray:
        """Prior deviation of phi near some values `(k,)`: an effect far larger than usual is
        unlikely, and not to be shrunk for it.
        """
        return (
            np.asarray(
                np.where(self.sizes, np.maximum(self.deviation, np.abs(phi)), self.deviation)
            )
            if self.count
            else self.deviation
        )

    def trust(self, fit: Fit) -> None:
        """Keep causes that are not linear where their linearisation holds: near a fit, within a few
        standard deviations.
        """
        for part, cause in zip(parts(self.causes), self.causes, strict=True):
            if not cause.linear:
                reach = TRUST * np.sqrt(np.maximum(np.diag(fit.covariance)[part], 0.0))
                self.low[part] = np.maximum(self.low[part], fit.phi[part] - reach)
                self.high[part] = np.minimum(self.high[part], fit.phi[part] + reach)

    def gathered(
        self, way: int, fold: int | None, session: int, inside: bool
    ) -> tuple[Sums, np.ndarray, np.ndarray]:
        """Sums of products of a fold, of all but it (`inside` False), or of everything (no fold),
        in one session.

        Returns:
            Of the base (p + 1 columns), of own columns `(G, k + 1, k + 1)`, between them `(G, k +
            1, p + 1)`.
        """
        base = self.base
        of_base = base.part(way, fold, session, inside)
        if self.empty:
            groups = base.samples.groups
            return of_base, np.zeros((groups, 1, 1)), np.zeros((groups, 1, base.layout.size))
        if fold is None:
            return of_base, self.whole.own[session], self.whole.cross[session]
        key = way, fold, session, inside
        if key not in self._kept:
            chosen = (base.samples.session == session) & (
                (base.samples.fold[way] == fold) == inside
            )
            self._kept[key] = self.products.own[chosen].sum(0), self.products.cross[chosen].sum(0)
        return of_base, *self._kept[key]

    def solve(
        self,
        weight: np.ndarray,
        way: int = BLOCKS,
        without: int | None = None,
        held: np.ndarray | None = None,
        near: np.ndarray | None = None,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """One fit at given weights of the groups `(G,)`.

        Args:
            weight: over the floor's.
            way: of holding out.
            without: fold held out.
            held: values of phi that are fixed, NaN where free `(k,)`.
            near: phi at which what scales torques is linearised, and the prior widened `(k,)`; 0 by
                default.

        Returns:
            phi `(k,)`, its covariance, errors `(sessions, p)`, and the log determinant that
            evidence needs.
        """
        from scipy.linalg import cho_factor, cho_solve

        base, k = self.base, self.count
        size = len(base.errors)
        most = base.prior.most
        sums = [
            self.gathered(way, without, session, False) for session in range(base.samples.sessions)
        ]
        weighed = []
        for session, (of_base, own, cross) in enumerate(sums):
            key = weight.tobytes() + bytes([session]) if without is None else None
            summed, factor, log = base.normal(of_base, weight, key)
            weighed.append(
                (summed, factor, log, np.tensordot(weight, own, 1), np.tensordot(weight, cross, 1))
            )
        clamped = np.zeros((len(sums), size))
        near = np.zeros(k) if near is None else near
        deviation = self.widened(near)
        part = (
            float(number_of(base, way, without, False).sum() / base.number.sum())
            if self.factors
            else 1.0
        )
        for attempt in range(CLAMPS):
            matrix, right, determinant, kept = np.diag(1 / deviation**2), np.zeros(k), 0.0, []
            for at, one in self.factors:
                first, second = one.slopes(float(near[at]))
                matrix[at, at] += part * second
                right[at] += part * (first + second * near[at])
            for session, (summed, factor, log, mine, between) in enumerate(weighed):
                fixed = clamped[session] != 0
                target, across = summed[:size, size] - between[k, :size], between[:k, :size]
                own_right = between[:k, size] - mine[:k, k]
                if fixed.any():
                    free = ~fixed
                    normal = summed[:size, :size] + base.prior.precision
                    target = target - normal[:, fixed] @ clamped[session, fixed]
                    own_right = own_right - across[:, fixed] @ clamped[session, fixed]
                    solved = np.zeros((size, k + 1))
                    factor = cho_factor(normal[np.ix_(free, free)], check_finite=False)
                    solved[free] = cho_solve(
                        factor,
                        np.concatenate([across[:, free], target[None, free]]).T,
                        check_finite=False,
                    )
                else:
                    solved = cho_solve(
                        factor, np.concatenate([across, target[None]]).T, check_finite=False
                    )
                matrix = matrix + mine[:k, :k] - across @ solved[:, :k]
                right = right + own_right - across @ solved[:, k]
                determinant += log
                kept.append(solved)
            phi, covariance = _bounded(matrix, right, self.low, self.high, held)
            errors = np.stack([solved[:, k] - solved[:, :k] @ phi for solved in kept]) + clamped
            beyond = np.abs(errors) > most * (1 + 1e-9)
            if not beyond.any() or attempt == CLAMPS - 1:
                break
            clamped = np.where(beyond, np.clip(errors, -most, most), clamped)
        errors = np.clip(errors, -most, most)
        if k:
            determinant += float(np.linalg.slogdet(matrix)[1]) + 2 * float(np.log(deviation).sum())
        return phi, covariance, errors, np.array(determinant)

    def rss(
        self,
        phi: np.ndarray,
        errors: np.ndarray,
        way: int = BLOCKS,
        fold: int | None = None,
        inside: bool = True,
    ) -> np.ndarray:
        """Squares left over by group `(G,)`, over the floor."""
        found = np.zeros(self.base.samples.groups)
        for session in range(self.base.samples.sessions):
            of_base, own, cross = self.gathered(way, fold, session, inside)
            u = np.append(errors[session], -1.0)
            found += of_base.square(u)
            if not self.empty:
                v = np.append(phi, 1.0)
                found += np.einsum("k,gkl,l->g", v, own, v) + 2 * np.einsum(
                    "k,gkp,p->g", v, cross, u
                )
        return np.maximum(found, 0.0)

    def fit(
        self,
        way: int = BLOCKS,
        without: int | None = None,
        scale: np.ndarray | None = None,
        rounds: int = ROUNDS,
    ) -> Fit:
        """Fit, with the noise's scales fitted along.

        Args:
            way: of holding out.
            without: fold held out.
            scale: to begin with `(G,)`.
            rounds: of setting the scales.
        """
        base = self.base
        number = number_of(base, way, without, False)
        if scale is None:
            # from large noise to small: nuisance parameters first take what their priors allow, not
            # all that they could
            scale, rounds = base.raw, 2 * rounds
        phi = np.zeros(self.count)
        for _ in range(max(rounds, 1)):
            phi, covariance, errors, determinant = self.solve(1 / scale, way, without, near=phi)
            rss = self.rss(phi, errors, way, without, without is None)
            if rounds:
                scale = (base.freedom + rss) / (base.freedom + number)
        cost = float(np.einsum("sp,pq,sq->", errors, base.prior.precision, errors))
        penalty = cost + (float(np.sum((phi / self.widened(phi)) ** 2)) if self.count else 0.0)
        evidence = (
            -0.5 * float(np.sum((base.freedom + number) * np.log(scale)))
            - 0.5 * penalty
            - 0.5 * float(determinant)
        )
        evidence += self.scaled(phi) * float(number.sum() / base.number.sum())
        return Fit(phi, covariance, errors, scale, evidence, rss, 0.5 * cost)

    def scaled(self, phi: np.ndarray, scale: np.ndarray | None = None) -> float:
        """Log-likelihood of all samples by which causes that scale torques pay for it.

        Args:
            phi: of all causes.
            scale: variance over the floor's by group `(G,)`; with it, were no noise less than its
                floor.
        """
        found = 0.0
        for at, one in self.factors:
            found += one.log(float(phi[at])) * (
                1.0 if scale is None else self._over(one.row, scale)
            )
        return found

    def _over(self, row: int, scale: np.ndarray) -> float:
        """Noise of a row, as far as it is less than the floor, over the floor: mean of its variance
        over the floor's, at most 1.
        """
        samples = self.base.samples
        own = samples.row == row
        return float(
            np.average(np.minimum(scale[samples.group[own]], 1.0), weights=samples.share[own])
        )

    def trace(self, phi: np.ndarray) -> np.ndarray:
        """What the causes leave in every sample, weighted `(S,)`."""
        return (
            np.asarray(phi @ self.columns[: self.count] + self.constant)
            if self.count
            else self.constant
        )

    def left(self, phi: np.ndarray, errors: np.ndarray) -> np.ndarray:
        """What is left of every sample, weighted `(S,)`; errors by session `(sessions, p)`."""
        base = self.base
        session = base.samples.session[base.samples.part]
        found = base.value - self.trace(phi)
        for s in range(base.samples.sessions):
            found = found - np.where(session == s, errors[s] @ base.errors, 0.0)
        return np.asarray(found)


def _bounded(
    matrix: np.ndarray,
    right: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    held: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Least squares within bounds, with what is held (else NaN) held, and the covariance without
    bounds.
    """
    phi = np.full(len(right), np.nan) if held is None else held.copy()
    phi = np.where(np.isnan(phi) & (low >= high), low, phi)
    free = np.isnan(phi)
    if free.any():
        inner, rest = (
            matrix[np.ix_(free, free)],
            right[free] - matrix[np.ix_(free, ~free)] @ phi[~free],
        )
        found = np.linalg.solve(inner, rest)
        if (found < low[free]).any() or (found > high[free]).any():
            found = _within(inner, rest, low[free], high[free])
        phi[free] = found
    return phi, np.linalg.inv(matrix) if len(right) else np.zeros((0, 0))


def _within(matrix: np.ndarray, right: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Where x matrix x / 2 - right x is least with low < x < high, all `(k,)`."""
    from scipy.optimize import lsq_linear

    size = np.sqrt(np.diag(matrix))
    square, axes = np.linalg.eigh(matrix / np.outer(size, size))
    root = np.sqrt(np.maximum(square, SINGULAR))
    found = lsq_linear(
        root[:, None] * axes.T,
        axes.T @ (right / size) / root,
        (low * size, high * size),
        method="bvls",
    )
    return np.where(
        found.active_mask < 0,
        low,
        np.where(found.active_mask > 0, high, np.clip(found.x / size, low, high)),
    )
