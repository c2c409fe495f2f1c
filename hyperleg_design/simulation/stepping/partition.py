"""Which simulations are stepped together, and the random streams that they draw from."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from hyperleg_design.simulation.stepping.streams import RowStreams

CHUNK = 512
"""Most simulations in a chunk: fewer and larger ones waste less time in Python."""
SMALLEST_SPLIT = 32
"""Simulations from which there are two chunks at least."""


@dataclass(frozen=True)
class Block:
    """Simulations `first .. end` that share a random stream."""

    first: int
    end: int
    seed: np.random.SeedSequence


@dataclass(frozen=True)
class Part:
    """Blocks that follow each other and are stepped together."""

    blocks: tuple[Block, ...]

    @property
    def first(self) -> int:
        """Index of the first simulation."""
        return self.blocks[0].first

    @property
    def end(self) -> int:
        """Index after the last simulation."""
        return self.blocks[-1].end

    def streams(self) -> RowStreams:
        """The random streams of its simulations, at their beginning."""
        return RowStreams(
            [np.random.default_rng(block.seed) for block in self.blocks],
            [block.end - block.first for block in self.blocks],
        )


def partition(simulations: int, seed: int, threads: int, designs: int | None = None) -> list[Part]:
    """Divide simulations into the parts that threads work on.

    A trajectory depends on the blocks through their random streams, so the blocks follow from the
    number of simulations alone, or that of each design.

    Args:
        simulations: how many in all.
        seed: of all randomness.
        threads: that step them.
        designs: how many designs have the same random numbers, each as if its simulations were the
            only ones; None where every simulation has its own.

    Returns:
        The parts, in the order of their simulations.
    """
    alone = simulations // designs if designs else simulations
    inside = np.linspace(0, alone, _number(alone) + 1).astype(int).tolist()
    seeds = np.random.SeedSequence(seed).spawn(len(inside) - 1)
    blocks = [
        Block(start + low, start + high, own)
        for start in range(0, simulations, alone)
        for (low, high), own in zip(itertools.pairwise(inside), seeds, strict=True)
    ]
    # With one thread a second chunk only costs time. Where designs have streams of their own, a
    # trajectory does not depend on how they are shared out, and no snapshot is taken.
    whole = designs is not None and threads == 1
    number = min(-(-simulations // CHUNK) if whole else _number(simulations), len(blocks))
    bounds = np.linspace(0, len(blocks), number + 1).astype(int).tolist()
    return [Part(tuple(blocks[begin:end])) for begin, end in itertools.pairwise(bounds)]


def _number(simulations: int) -> int:
    """Number of parts into which the simulations are divided for the threads."""
    return max(-(-simulations // CHUNK), 2 if simulations >= SMALLEST_SPLIT else 1)
