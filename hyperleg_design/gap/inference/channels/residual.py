"""What of a channel's residual the fits of its scales and discrepancy need."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Residual:
    """Sums of products of a channel's residual, or of what is left of it, by cell."""

    cross: np.ndarray
    """With the discrepancy columns `(cells, k)`."""
    square: np.ndarray
    """Products of the residual with itself `(cells,)`."""
