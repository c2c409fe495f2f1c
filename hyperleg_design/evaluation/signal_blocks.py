"""Samples of trials while they run, in blocks of time that hold only the trials still running."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

BLOCK = 64
"""Policy steps of a block."""


class SignalBlocks:
    """Records samples of simulations that end one after another.

    One array for all trials and the longest time would be several times as large, and most of the
    time of a record goes into the first touch of its memory.
    """

    def __init__(self) -> None:
        self._steps = 0
        self._rows: list[np.ndarray] = []
        """Simulations of each block, ascending."""
        self._blocks: dict[str, list[np.ndarray]] = {}
        """Samples of each block, `(policy steps, samples in one, k, ...)` each."""

    @property
    def names(self) -> tuple[str, ...]:
        """Of the samples that are kept and not taken yet."""
        return tuple(self._blocks)

    def keep(self, parts: Sequence[Mapping[str, np.ndarray]], running: np.ndarray) -> None:
        """Keep what happened in the last policy step.

        Args:
            parts: samples by name of simulations that follow each other, `(samples, n_i, ...)`.
            running: whether each trial still runs, `(n,)`; one that has ended never runs again.
        """
        place = self._steps % BLOCK
        if place == 0:
            self._rows.append(np.flatnonzero(running))
            for name, values in parts[0].items():
                shape = (BLOCK, len(values), len(self._rows[-1]), *values.shape[2:])
                self._blocks.setdefault(name, []).append(np.empty(shape))
        rows, first, begin = self._rows[-1], 0, 0
        for samples in parts:
            count = next(iter(samples.values())).shape[1]
            end = int(np.searchsorted(rows, first + count))
            for name, values in samples.items():
                stored = self._blocks[name][-1][place, :, begin:end]
                if end - begin == count:
                    stored[:] = values
                elif end > begin:
                    np.take(values, rows[begin:end] - first, 1, stored, "clip")
            first, begin = first + count, end
        self._steps += 1

    def latest(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Look up the last sample.

        Args:
            name: of the samples.

        Returns:
            The trials that ran when its block began, ascending `(k,)`, and their values
            `(k, ...)`.
        """
        return self._rows[-1], self._blocks[name][-1][(self._steps - 1) % BLOCK, -1]

    def taken(self, name: str, steps: np.ndarray) -> list[np.ndarray]:
        """Take samples out, which frees their blocks.

        Args:
            name: of the samples.
            steps: policy steps of each trial, within the time that it ran, `(n,)`; all ran at
                first.

        Returns:
            The samples of each trial, `(t, ...)`.
        """
        parts: list[list[np.ndarray]] = [[] for _ in steps]
        for index, (rows, block) in enumerate(zip(self._rows, self._blocks.pop(name), strict=True)):
            for column, row in enumerate(rows):
                left = steps[row] - index * BLOCK
                if left > 0 or not index:
                    parts[row].append(block[: max(left, 0), :, column])
        return [np.concatenate(own).reshape(-1, *own[0].shape[2:]) for own in parts]
