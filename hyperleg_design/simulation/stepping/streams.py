"""Random numbers of simulations that are stepped together, from one generator a block of them.

Where several designs are evaluated side by side, each has a block of simulations and generators of
its own that begin alike: the numbers that a design gets do not depend on which others share the
batch, and all designs meet the same starting states (common random numbers).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np


class RowStreams:
    """Draws for rows of an array, each from the generator of its block; used like a
    `numpy.random.Generator` whose results have the rows in front.

    Args:
        generators: one a block.
        sizes: rows of each block; blocks follow each other.
    """

    def __init__(
        self, generators: Sequence[np.random.Generator], sizes: Sequence[int] | np.ndarray
    ) -> None:
        self.generators, self.sizes = list(generators), [int(size) for size in sizes]
        self._ends = np.cumsum(self.sizes)

    def of(self, rows: np.ndarray) -> RowStreams:
        """Make a stream for some of the rows; it advances the same generators.

        Args:
            rows: indices, in ascending order.

        Returns:
            The stream.
        """
        block = np.searchsorted(self._ends, rows, side="right")
        sizes = np.bincount(block, minlength=len(self.generators))
        drawn = np.flatnonzero(sizes)
        return RowStreams([self.generators[i] for i in drawn], sizes[drawn])

    def uniform(
        self, low: float = 0.0, high: float = 1.0, size: int | tuple[int, ...] = 0
    ) -> np.ndarray:
        """Draw uniform numbers between two ends.

        Args:
            low: lower end.
            high: upper end.
            size: shape, whose first entry is the number of rows; all rows by default.

        Returns:
            The numbers.
        """
        return self._drawn("uniform", (low, high), size)

    def integers(self, high: int, size: int | tuple[int, ...] = 0) -> np.ndarray:
        """Draw whole numbers from 0 to `high - 1`.

        Args:
            high: number that is not reached.
            size: shape, whose first entry is the number of rows; all rows by default.

        Returns:
            The numbers.
        """
        return self._drawn("integers", (high,), size)

    @property
    def state(self) -> list[dict[str, Any]]:
        """State of the generators, for `restore`."""
        return [dict(generator.bit_generator.state) for generator in self.generators]

    def restore(self, state: Sequence[dict[str, Any]] | dict[str, Any]) -> None:
        """Go on from a `state`, or from that of a single generator as older snapshots hold it.

        Args:
            state: as `state` returned it, or that of a single generator, as older snapshots hold
                it.
        """
        states = [state] if isinstance(state, dict) else state
        for generator, own in zip(self.generators, states, strict=True):
            generator.bit_generator.state = own

    def _drawn(
        self, name: str, arguments: tuple[Any, ...], size: int | tuple[int, ...]
    ) -> np.ndarray:
        rows, *rest = (size,) if isinstance(size, int) else size
        if rows != sum(self.sizes):
            raise ValueError(f"{rows} rows are asked for, where there are {sum(self.sizes)}")
        parts = [
            getattr(generator, name)(*arguments, size=(own, *rest))
            for generator, own in zip(self.generators, self.sizes, strict=True)
        ]
        return np.concatenate(parts) if parts else np.empty((0, *rest))


Random = np.random.Generator | RowStreams
"""What simulations draw from."""


def of_rows(rng: Random, rows: np.ndarray) -> Random:
    """Choose what draws for some rows.

    Args:
        rng: a stream, or a plain generator.
        rows: indices, in ascending order.

    Returns:
        The rows' part of the stream; a plain generator itself.
    """
    return rng.of(rows) if isinstance(rng, RowStreams) else rng
