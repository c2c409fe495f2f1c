"""Interval of a share of cases."""

from __future__ import annotations


def wilson(hits: int, of: int) -> tuple[float, float]:
    """Compute Wilson's score interval of a share, 95 %.

    Args:
        hits: cases that have it.
        of: all cases; of none, the interval is 0 to 1.

    Returns:
        Lower and upper end.

    Raises:
        ValueError: more hits than cases, or a negative number.
    """
    from scipy.stats import binomtest

    if hits == of == 0:
        return 0.0, 1.0
    interval = binomtest(hits, of).proportion_ci(0.95, "wilson")
    return float(interval.low), float(interval.high)
