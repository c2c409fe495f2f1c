"""Sums of products of the columns that fits are made of, by group of samples; columns that a row
does not show are left out.

A robot's row shows few of all nuisance parameters, so that most of these products are nothing: kept
whole, they would fill the memory, and reading them would be most of a diagnosis.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hyperleg_design.gap.inference.samples import Piece, Samples


@dataclass(frozen=True, eq=False)
class Layout:
    """Which groups each row has, and which columns it shows."""

    groups: tuple[np.ndarray, ...]
    """Of each row `(g,)`."""
    shown: tuple[np.ndarray, ...]
    """Of each row, of the p columns `(n,)`; the last always."""
    row: np.ndarray
    """Of each group `(G,)`."""
    place: np.ndarray
    """Of each group among those of its row `(G,)`."""
    size: int
    """p."""

    def empty(self) -> Sums:
        """All 0."""
        return Sums(
            self,
            tuple(
                np.zeros((len(g), len(s), len(s)))
                for g, s in zip(self.groups, self.shown, strict=True)
            ),
        )

    def add(self, sums: Iterable[Sums], columns: np.ndarray, piece: Piece) -> None:
        """Add the products of a piece of the columns `(p, S)` to some sums, in place."""
        row, place = int(self.row[piece.group]), int(self.place[piece.group])
        mine = columns[self.shown[row], piece.start : piece.stop]
        product = mine @ mine.T
        for one in sums:
            one.blocks[row][place] += product


@dataclass(frozen=True, eq=False)
class Sums:
    """Products of p columns with each other in G groups."""

    layout: Layout
    blocks: tuple[np.ndarray, ...]
    """Of each row `(g, n, n)`."""

    def __add__(self, other: Sums) -> Sums:
        return Sums(
            self.layout, tuple(a + b for a, b in zip(self.blocks, other.blocks, strict=True))
        )

    def __sub__(self, other: Sums) -> Sums:
        return Sums(
            self.layout, tuple(a - b for a, b in zip(self.blocks, other.blocks, strict=True))
        )

    def weighed(self, weight: np.ndarray) -> np.ndarray:
        """Sum over the groups `(p, p)`, each times its weight `(G,)`."""
        found = np.zeros((self.layout.size, self.layout.size))
        for groups, shown, block in zip(
            self.layout.groups, self.layout.shown, self.blocks, strict=True
        ):
            if len(groups):
                found[np.ix_(shown, shown)] += np.tensordot(weight[groups], block, 1)
        return found

    def square(self, combination: np.ndarray) -> np.ndarray:
        """Sum of squares of a combination of the columns `(p,)`, by group `(G,)`."""
        found = np.zeros(len(self.layout.row))
        for groups, shown, block in zip(
            self.layout.groups, self.layout.shown, self.blocks, strict=True
        ):
            if len(groups):
                own = combination[shown]
                found[groups] = (block @ own) @ own
        return found

    def whole(self) -> np.ndarray:
        """Of all columns `(G, p, p)`."""
        found = np.zeros((len(self.layout.row), self.layout.size, self.layout.size))
        for groups, shown, block in zip(
            self.layout.groups, self.layout.shown, self.blocks, strict=True
        ):
            for group, one in zip(groups.tolist(), block, strict=True):
                found[group][np.ix_(shown, shown)] = one
        return found


def layout_of(samples: Samples, columns: np.ndarray) -> Layout:
    """Of columns `(p, S)`."""
    shown = []
    for row in range(len(samples.rows)):
        mine = np.any(columns[:, samples.row == row] != 0, 1)
        mine[-1] = True
        shown.append(np.flatnonzero(mine))
    groups = tuple(np.flatnonzero(samples.group_row == row) for row in range(len(samples.rows)))
    place = np.zeros(samples.groups, int)
    for own in groups:
        place[own] = np.arange(len(own))
    return Layout(groups, tuple(shown), samples.group_row, place, len(columns))
