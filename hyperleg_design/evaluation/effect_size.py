"""Effect sizes of the difference between two groups."""

from __future__ import annotations

from typing import Any

import numpy as np


def hedges_g(first: Any, second: Any) -> float:
    """Compute Hedges' g, the difference of two means over their pooled standard deviation.

    It is corrected for few values by the factor 1 - 3 / (4 (n + m) - 9).

    Args:
        first: `(n,)`
        second: `(m,)`

    Returns:
        The effect size [-]; NaN without spread or with fewer than two values on a side.
    """
    x, y = np.asarray(first, float), np.asarray(second, float)
    freedom = len(x) + len(y) - 2
    if min(len(x), len(y)) < 2:
        return np.nan
    pooled = np.sqrt(((len(x) - 1) * x.var(ddof=1) + (len(y) - 1) * y.var(ddof=1)) / freedom)
    if pooled == 0:
        return np.nan
    return float((x.mean() - y.mean()) / pooled * (1 - 3 / (4 * freedom - 1)))


def cliffs_delta(first: Any, second: Any) -> float:
    """Compute Cliff's delta: the share of pairs with first > second minus that with first < second.

    Args:
        first: `(n,)`
        second: `(m,)`

    Returns:
        The effect size, -1 .. 1 [-].
    """
    x, y = np.asarray(first, float), np.asarray(second, float)
    return float(np.mean(np.sign(x[:, None] - y[None, :])))
