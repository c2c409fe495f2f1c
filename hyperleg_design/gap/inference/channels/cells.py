"""Samples of one channel by cell, and sums of their products with columns over all samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True, eq=False, kw_only=True)
class Cells:
    """Samples of one channel, by cell: one band of one session."""

    number: np.ndarray
    """Independent numbers that each cell counts for `(cells,)`."""
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
        place = {int(self.frequency[band]): int(band) for band in others}
        return np.array([place.get(int(self.frequency[band]), -1) for band in self.bands_tested])

    @cached_property
    def referenced(self) -> bool:
        """Whether reference logs teach the standing discrepancy."""
        return not bool(self.tested.all())

    @cached_property
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

    @cached_property
    def _cuts(self) -> tuple[np.ndarray | slice, ...]:
        """`places`, as slices where they are one, so that no samples are copied."""
        return tuple(
            slice(int(place[0]), int(place[-1]) + 1)
            if len(place) and place[-1] - place[0] + 1 == len(place) and (np.diff(place) == 1).all()
            else place
            for place in self.places
        )

    def shows(self, columns: np.ndarray) -> np.ndarray:
        """Tell which columns are not zero everywhere in this channel `(m,)`.

        Args:
            columns: over all samples `(m, S)`.
        """
        shown = np.zeros(len(columns), bool)
        for cut in self._cuts:
            shown |= columns[:, cut].any(1)
        return shown

    def crossed(
        self, columns: np.ndarray, some: np.ndarray | slice = slice(None)
    ) -> tuple[np.ndarray, np.ndarray]:
        """Sums of products with further columns.

        Args:
            columns: weighted as the residual `(m, S)`.
            some: which of them `(n,)`; all by default.

        Returns:
            With the discrepancy columns and the residual `(cells, k + 1, n)`, and among themselves
            `(cells, n, n)`.
        """
        count = len(np.arange(len(columns))[some])
        cross = np.zeros((len(self.number), len(self.whitened[0]), count))
        own = np.zeros((len(self.number), count, count))
        for cell, (cut, white) in enumerate(zip(self._cuts, self.whitened, strict=True)):
            mine = columns[:, cut][some]
            if mine.any():
                cross[cell], own[cell] = white @ mine.T, mine @ mine.T
        return cross, own

    def crossed_with(
        self, columns: np.ndarray, some: np.ndarray, others: np.ndarray, of_others: np.ndarray
    ) -> np.ndarray:
        """Sums of products of columns with others.

        Args:
            columns: weighted as the residual `(m, S)`.
            some: which of them `(n,)`.
            others: weighted alike `(p, S)`.
            of_others: which of these `(q,)`.

        Returns:
            By cell `(cells, n, q)`.
        """
        products = np.zeros((len(self.number), len(some), len(of_others)))
        for cell, cut in enumerate(self._cuts if len(some) and len(of_others) else ()):
            theirs = others[:, cut][of_others]
            if theirs.any():
                products[cell] = (columns[:, cut] @ theirs.T)[some]  # no copy of many columns
        return products

    def over_noise(self, noise: np.ndarray, columns: np.ndarray) -> list[np.ndarray]:
        """Divide columns by the noise.

        Args:
            noise: by band `(b,)`.
            columns: weighted twice as the residual `(m, S)`.

        Returns:
            By cell `(m, samples)`; `(m, 0)` where all are zero.
        """
        parts = []
        for cut, over in zip(self._cuts, noise[self.band].tolist(), strict=True):
            mine = columns[:, cut] / over
            parts.append(mine if mine.any() else mine[:, :0])
        return parts

    def between(self, parts: Sequence[np.ndarray], others: Sequence[np.ndarray]) -> np.ndarray:
        """Sum over all cells of products of columns over the noise.

        Args:
            parts: of m columns, as of `over_noise`.
            others: unweighted, `(n, S)` each, or shorter where they end with the logs under test.

        Returns:
            `(m, n)`, all others one after the other.
        """
        products = np.zeros((len(parts[0]), sum(len(columns) for columns in others)))
        for cut, mine in zip(self._cuts, parts, strict=True):
            if mine.size:
                last = cut.stop - 1 if isinstance(cut, slice) else cut[-1]
                at = 0
                for columns in others:
                    if last < columns.shape[1]:
                        products[:, at : at + len(columns)] += mine @ columns[:, cut].T
                    at += len(columns)
        return products

    def summed(self, noise: np.ndarray, products: np.ndarray) -> np.ndarray:
        """Sum products over the noise by session.

        Args:
            noise: variance over the expected one, by band `(b,)`.
            products: by cell `(cells, ...)`.

        Returns:
            `(sessions, ...)`.
        """
        share = (self.session == np.arange(len(self.tested))[:, None]) / noise[self.band]
        return np.asarray(np.tensordot(share, products, 1))
