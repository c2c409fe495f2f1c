"""Tests that an analysis plan asks for: Holm's correction, equivalence, the smallest difference
that could have been detected, and whether a training's reward has reached a plateau.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError

if TYPE_CHECKING:
    from hyperleg_design.evaluation.plans.analysis_plan import PlateauRule

FEWEST_POINTS = 5
"""Fewest points in the last part of a curve from which a slope is judged."""


def p_value(mean: float, standard_error: float, freedom: int) -> float:
    """Compute the two-sided p value of a difference of zero, by Student's t.

    Args:
        mean: difference that was measured.
        standard_error: of it.
        freedom: degrees of freedom.

    Returns:
        The p value [-]; NaN without degrees of freedom.
    """
    from scipy.stats import t

    if not freedom or not np.isfinite(standard_error):
        return np.nan
    if standard_error == 0:
        return float(mean == 0)
    return float(2 * t.sf(abs(mean) / standard_error, freedom))


def interval_reach(standard_error: float, freedom: int, level: float) -> float:
    """Compute half the width of the interval of 1 - level around a difference.

    Args:
        standard_error: of the difference.
        freedom: degrees of freedom.
        level: of the two-sided test that leaves zero outside of this interval where it rejects.

    Returns:
        Half the width, in the unit of the standard error; NaN without degrees of freedom.
    """
    from scipy.stats import t

    if not freedom or not np.isfinite(standard_error):
        return np.nan
    return float(t.ppf(1 - level / 2, freedom)) * standard_error


def holm(p_values: Sequence[float]) -> np.ndarray:
    """Correct p values for their number by Holm's step-down method.

    The i-th smallest becomes max over j <= i of (m - j + 1) p_j, at most 1 (Holm, 1979). NaN stays
    NaN and counts in m, because the comparison was planned.

    Args:
        p_values: m values, NaN for comparisons that could not be made.

    Returns:
        The corrected values in the same order, `(m,)`.
    """
    values = np.asarray(p_values, float)
    measured = np.flatnonzero(np.isfinite(values))
    order = measured[np.argsort(values[measured], kind="stable")]
    factors = len(values) - np.arange(len(order))
    corrected = np.full(len(values), np.nan)
    corrected[order] = np.minimum(np.maximum.accumulate(factors * values[order]), 1.0)
    return corrected


def equivalent(
    mean: float, standard_error: float, freedom: int, margin: float, level: float
) -> bool:
    """Decide by two one-sided tests whether a difference lies inside plus and minus a margin.

    Both tests reject at the level exactly where the interval of level 1 - 2 level lies within the
    margin (Schuirmann, 1987).

    Args:
        mean: difference that was measured.
        standard_error: of it.
        freedom: degrees of freedom.
        margin: in the difference's unit, positive.
        level: of each of the two tests.

    Returns:
        True if both tests reject; False without degrees of freedom.
    """
    from scipy.stats import t

    if not freedom or not np.isfinite(standard_error):
        return False
    reach = float(t.ppf(1 - level, freedom)) * standard_error
    return bool(-margin < mean - reach and mean + reach < margin)


def smallest_detectable(standard_error: float, freedom: int, level: float, power: float) -> float:
    """Compute the true difference that a two-sided test would find with a given probability.

    It is (t_{1 - level / 2} + t_{power}) standard errors, the usual approximation to the noncentral
    t.

    Args:
        standard_error: of the difference.
        freedom: degrees of freedom.
        level: of the test.
        power: probability to find it.

    Returns:
        The difference, in the unit of the standard error; NaN without degrees of freedom.
    """
    from scipy.stats import t

    if not freedom or not np.isfinite(standard_error):
        return np.nan
    return float((t.ppf(1 - level / 2, freedom) + t.ppf(power, freedom)) * standard_error)


@dataclass(frozen=True)
class Plateau:
    """Whether a learning curve has become flat at its end, and how steep it still is."""

    gain: float
    """Rise of the fitted line over the last share, over the magnitude of its mean [-]."""
    p_value: float
    """One-sided p-value of the hypothesis of no gain [-]."""
    reached: bool
    """Whether there is no gain beyond noise, or none that matters."""


def plateau(steps: Any, reward: Any, rule: PlateauRule) -> Plateau:
    """Decide whether a training's reward has stopped rising over its last share of steps.

    A line is fitted to means of blocks of that part, twice `FEWEST_POINTS` at most, because
    neighbouring iterations are not independent. A one-sided test compares its slope with zero.

    Args:
        steps: policy steps, rising `(k,)`.
        reward: mean reward at each, `(k,)`.
        rule: what counts as a plateau.

    Returns:
        The relative gain over that share, its p value, and whether it counts as a plateau.

    Raises:
        InputError: other lengths, or too few points in the last share.
    """
    from scipy.stats import linregress

    steps, reward = np.asarray(steps, float), np.asarray(reward, float)
    if steps.shape != reward.shape or steps.ndim != 1:
        raise InputError("plateau", "reward", reward.shape, f"expects the shape {steps.shape}")
    last = steps >= steps[-1] - rule.share * (steps[-1] - steps[0]) if len(steps) else steps > 0
    if last.sum() < FEWEST_POINTS:
        raise InputError(
            "plateau", "steps", int(last.sum()), f"expects {FEWEST_POINTS} points in the last part"
        )
    blocks = min(int(last.sum()), 2 * FEWEST_POINTS)
    x, y = (
        np.array([part.mean() for part in np.array_split(values[last], blocks)])
        for values in (steps, reward)
    )
    fit = linregress(x, y, alternative="greater")
    gain = float(fit.slope * (x[-1] - x[0]) / max(abs(y.mean()), 1e-12))
    chance = float(fit.pvalue) if np.ptp(y) else 1.0
    return Plateau(gain, chance, bool(chance > rule.level or gain <= rule.gain))
