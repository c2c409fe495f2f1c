"""What causes are fitted beside: residual and nuisance parameters of all samples, priors of the
errors, and the sums of their products.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, reduce
from operator import add

import numpy as np

from hyperleg_design.gap.inference.samples import BLOCKS, Packed, Samples, pack
from hyperleg_design.gap.inference.sums import Layout, Sums, layout_of

LIMIT = 2.5
"""Nuisance parameters are small: none goes beyond so many of its standard deviations."""


@dataclass(frozen=True, eq=False)
class Prior:
    """Of the nuisance parameters of a session, in usual sizes."""

    mean: np.ndarray
    """`(p,)`"""
    covariance: np.ndarray
    """`(p, p)`"""
    told: bool = False
    """Whether reference logs told it."""

    @cached_property
    def most(self) -> np.ndarray:
        """Largest errors, from the mean `(p,)`."""
        return np.asarray(LIMIT * np.sqrt(np.diag(self.covariance)))

    @cached_property
    def precision(self) -> np.ndarray:
        """`(p, p)`"""
        return np.linalg.inv(self.covariance)


@dataclass(frozen=True, eq=False)
class Base:
    """Residual and nuisance parameters of all samples, with their sums of products."""

    samples: Samples
    errors: np.ndarray
    """Columns of the p nuisance parameters, weighted `(p, S)`."""
    value: np.ndarray
    """Residual less the prior mean's share, weighted `(S,)`."""
    prior: Prior
    freedom: float
    """nu."""

    @cached_property
    def stacked(self) -> np.ndarray:
        """Errors, then value `(p + 1, S)`."""
        return np.concatenate([self.errors, self.value[None]])

    @cached_property
    def number(self) -> np.ndarray:
        """Independent numbers by part and group `(P, G)`."""
        found = np.zeros((len(self.samples.session), self.samples.groups))
        np.add.at(found, (self.samples.part, self.samples.group), self.samples.share)
        return found

    @cached_property
    def layout(self) -> Layout:
        """Which columns each row shows."""
        return layout_of(self.samples, self.stacked)

    @cached_property
    def packed(self) -> Packed:
        """`stacked` without what is nothing."""
        return pack(self.samples, self.stacked, self.layout.shown)

    @cached_property
    def sums(self) -> list[list[list[Sums]]]:
        """Products of `stacked` by way of holding out, fold and session."""
        samples = self.samples
        found = [
            [
                [self.layout.empty() for _ in range(samples.sessions)]
                for _ in range(samples.folds(way))
            ]
            for way in range(len(samples.fold))
        ]
        for piece in samples.pieces:
            session = samples.session[piece.part]
            self.layout.add(
                [found[way][fold][session] for way, fold in enumerate(samples.fold[:, piece.part])],
                self.stacked,
                piece,
            )
        return found

    @cached_property
    def total(self) -> list[Sums]:
        """Products of all samples by session."""
        return [reduce(add, own) for own in zip(*self.sums[BLOCKS], strict=True)]

    @cached_property
    def _parts(self) -> dict[tuple[int, int, int], Sums]:
        return {}

    def part(self, way: int, fold: int | None, session: int, inside: bool) -> Sums:
        """Products of a fold, of all but it, or of everything, in one session."""
        if fold is None:
            return self.total[session]
        if inside:
            return self.sums[way][fold][session]
        key = way, fold, session
        if key not in self._parts:
            self._parts[key] = self.total[session] - self.sums[way][fold][session]
        return self._parts[key]

    @cached_property
    def raw(self) -> np.ndarray:
        """Mean square of the residual by group `(G,)`, over the floor, the floor's own weight
        included.
        """
        samples = self.samples
        square = np.bincount(samples.group, self.value**2, samples.groups)
        return np.maximum((self.freedom + square) / (self.freedom + self.number.sum(0)), 1.0)

    @cached_property
    def _kept(self) -> dict[bytes, tuple[np.ndarray, tuple[np.ndarray, bool], float]]:
        return {}

    def normal(
        self, of_base: Sums, weight: np.ndarray, key: bytes | None
    ) -> tuple[np.ndarray, tuple[np.ndarray, bool], float]:
        """Weighted products of the base, the factor of the errors' normal equations, and its log
        determinant; kept under a key.
        """
        from scipy.linalg import cho_factor

        if key is not None and key in self._kept:
            return self._kept[key]
        size = len(self.errors)
        summed = of_base.weighed(weight)
        factor = cho_factor(summed[:size, :size] + self.prior.precision, check_finite=False)
        found = summed, factor, 2 * float(np.log(np.diag(factor[0])).sum())
        if key is not None and len(self._kept) < 64:
            self._kept[key] = found
        return found

    @cached_property
    def blocks(self) -> int:
        """Number of blocks of the bootstrap."""
        return int(self.samples.block.max(initial=-1)) + 1


def number_of(base: Base, way: int, fold: int | None, inside: bool) -> np.ndarray:
    """Independent numbers by group `(G,)`: of a fold, of all but it (`inside` False), or of
    everything (no fold).
    """
    if fold is None:
        return np.asarray(base.number.sum(0))
    return np.asarray(base.number[(base.samples.fold[way] == fold) == inside].sum(0))
