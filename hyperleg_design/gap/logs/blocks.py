"""Blocks of rows that are read of a recording too long to be held in memory."""

from __future__ import annotations

import numpy as np

MAX_VALUES = 32 * 1024 * 1024
"""Numbers that one log may hold (256 MiB, half an hour of 100 columns at 200 Hz); of longer ones,
blocks spread evenly are read."""
BLOCK_ROWS = 16384
"""Rows that are read or left out together, at full rate."""


def chosen_blocks(rows: int, columns: int) -> np.ndarray:
    """Choose which blocks of `BLOCK_ROWS` rows to read so that no more than `MAX_VALUES` numbers
    are held.

    Args:
        rows: of the file.
        columns: of the file.

    Returns:
        True for each block to read, `(blocks,)`.
    """
    blocks = -(-rows // BLOCK_ROWS)
    most = max(1, MAX_VALUES // (BLOCK_ROWS * max(columns, 1)))
    if blocks <= most:
        return np.ones(blocks, bool)
    chosen = np.zeros(blocks, bool)
    chosen[np.arange(most) * blocks // most] = True
    return chosen


def shortened(rows: int, rows_read: int) -> str:
    """Write the remark on a recording that is too long to be read whole.

    Args:
        rows: of the file.
        rows_read: of them.

    Returns:
        The remark.
    """
    return (
        f"too long to be held in memory: {rows_read} of its {rows} rows were read, in blocks at "
        f"full rate spread over the recording"
    )
