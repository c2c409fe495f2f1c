"""Hyperparameters of one residual channel and their priors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.inference.rules import DiscrepancyRules

ABSENT = 1e-3
"""Logarithm of `Scales.new` up to which nothing unlisted acts [-]."""


@dataclass(frozen=True, eq=False)
class Scales:
    """Hyperparameters of one channel."""

    noise: np.ndarray
    """Variance of the noise over what is expected, by band `(b,)` [-]."""
    standing: float = 0.0
    """Logarithm of the scale of the discrepancy that all sessions share."""
    change: float = 0.0
    """Logarithm of the scale of its change from session to session."""
    new: float = 0.0
    """Logarithm of how much larger the change is in sessions under test; 0 of a healthy robot."""


def log_prior_of_scales(
    scales: Scales, prior: DiscrepancyRules, referenced: bool, changes: bool
) -> float:
    """Log prior density of the scales of the discrepancy, up to a constant [nat].

    Args:
        scales: hyperparameters.
        prior: of the discrepancy.
        referenced: whether reference logs teach the standing discrepancy.
        changes: whether more than one session tells a change from what stands.
    """
    if not referenced:
        density = _mixed(scales.standing, prior)
    else:
        density = _normal(scales.standing, prior.referenced, prior.referenced_spread)
        odds = prior.unlisted_probability
        density += (
            float(np.log(1 - odds))
            if scales.new <= ABSENT
            else float(np.log(odds)) + _normal(scales.new, prior.unlisted, prior.unlisted_spread)
        )
    if changes:
        density += _normal(scales.change, prior.change, prior.change_spread)
    return density


def _normal(logarithm: float, median: float, spread: float) -> float:
    """Log density of a scale's logarithm, without 2 pi."""
    return float(-0.5 * ((logarithm - np.log(median)) / spread) ** 2 - np.log(spread))


def _mixed(logarithm: float, prior: DiscrepancyRules) -> float:
    """Log density of the standing scale of a robot without references: healthy, or with something
    unlisted.
    """
    healthy = _normal(logarithm, prior.standing, prior.standing_spread)
    unlisted = _normal(logarithm, prior.unlisted, prior.unlisted_spread)
    odds = prior.unlisted_probability
    return float(np.logaddexp(np.log(1 - odds) + healthy, np.log(odds) + unlisted))
