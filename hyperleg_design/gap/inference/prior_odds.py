"""Log odds of causes before any log, over those of any other cause in their place, beside those
that their effects state (`Effect.odds`).
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.inference.fit import Cause

PER_PARAMETER = 0.5
"""Log prior odds against each parameter, beside what the marginal likelihood takes for it."""
MISSING, HALF = 4.0, 0.5
"""Log odds against more than this share of what a model describes being missing (assumed: friction
that nobody described is usual, and joints run in, but none runs freely, nor is a rotor without
inertia)."""


def prior_odds(cause: Cause, values: np.ndarray) -> float:
    """Of a cause at some values `(k,)` [nat]."""
    free = int((~cause.shape).sum() if cause.linear else (cause.high > cause.low).sum())
    effect = WEIGHED[cause.effect]
    found = effect.rare if effect.flexible else -PER_PARAMETER * free + effect.rare
    if cause.unseen:
        found += effect.unseen
    if effect.described and values[0] < HALF * cause.low[0] < 0:
        found -= MISSING
    return found + effect.size_odds(values, cause.usual, cause.declared, cause.beyond)
