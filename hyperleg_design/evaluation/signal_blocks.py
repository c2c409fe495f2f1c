"""Signals of trials while they run, in blocks of time that hold only the trials still running."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hyperleg_design.simulation.environment import Environment

BLOCK = 64
"""Policy steps of a block."""


class SignalBlocks:
    """Records signals of simulations that end one after another.

    One array for all trials and the longest time would be several times as large, and most of the
    time of a record goes into the first touch of its memory.

    Args:
        shapes: of one sample of each signal, by the names that `Environment.signals` gives.
        substeps: samples in a policy step.
    """

    def __init__(self, shapes: Mapping[str, tuple[int, ...]], substeps: int) -> None:
        self._shapes, self._substeps = shapes, substeps
        self._steps = 0
        self._rows: list[np.ndarray] = []
        """Simulations of each block, ascending."""
        self._blocks: dict[str, list[np.ndarray]] = {name: [] for name in shapes}

    @property
    def names(self) -> tuple[str, ...]:
        """Of the signals that are kept and not taken yet."""
        return tuple(self._blocks)

    def keep(self, environment: Environment, running: np.ndarray) -> None:
        """Keep what happened in the last policy step.

        Args:
            environment: whose signals are kept.
            running: whether each trial still runs, `(n,)`; one that has ended never runs again.
        """
        if self._steps % BLOCK == 0:
            self._rows.append(np.flatnonzero(running))
            size = (BLOCK * self._substeps, len(self._rows[-1]))
            for name, blocks in self._blocks.items():
                blocks.append(np.empty((*size, *self._shapes[name])))
        begin = self._steps % BLOCK * self._substeps
        environment.keep_signals(
            {name: blocks[-1] for name, blocks in self._blocks.items()},
            slice(begin, begin + self._substeps),
            self._rows[-1],
        )
        self._steps += 1

    def latest(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Look up the last sample of a signal.

        Args:
            name: of the signal.

        Returns:
            The trials that ran when its block began, ascending `(k,)`, and their values
            `(k, ...)`.
        """
        last = (self._steps - 1) % BLOCK * self._substeps + self._substeps - 1
        return self._rows[-1], self._blocks[name][-1][last]

    def taken(self, name: str, lengths: np.ndarray) -> list[np.ndarray]:
        """Take a signal out, which frees its blocks.

        Args:
            name: of the signal.
            lengths: samples of each trial, within the time that it ran, `(n,)`; all ran at first.

        Returns:
            The signal of each trial, `(t, ...)`.
        """
        parts: list[list[np.ndarray]] = [[] for _ in lengths]
        blocks = self._blocks.pop(name)
        for index, (rows, block) in enumerate(zip(self._rows, blocks, strict=True)):
            for column, row in enumerate(rows):
                left = lengths[row] - index * len(block)
                if left > 0 or not index:
                    parts[row].append(block[: max(left, 0), column])
        return [np.concatenate(own) for own in parts]
