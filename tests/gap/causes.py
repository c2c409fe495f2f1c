"""Causes for tests of hypotheses."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from hyperleg_design.gap.inference.cause import Cause


def unbounded(
    effect: str, location: str, columns: np.ndarray, constant: np.ndarray | None = None
) -> Cause:
    """Without bounds, linear unless it has a constant trace."""
    k = len(columns)
    return Cause(
        effect,
        location,
        np.zeros(k),
        np.zeros(k),
        np.ones(k),
        np.full(k, -np.inf),
        np.full(k, np.inf),
        np.zeros(k, bool),
        csr_array(columns),
        np.zeros(columns.shape[1]) if constant is None else constant,
        constant is None,
    )
