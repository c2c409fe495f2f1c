"""What logs tell of a cause beside their residuals: log odds for it, or against it.

| effect | sign |
|---|---|
| `transmission_elasticity` | against, where its joints knock about as in play (`waveform`) |
| `thermal_derating` | for, where its motor is much warmer than motors are, and than the others of
the robot |
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.effects.thermal_derating import COLD
from hyperleg_design.gap.signals.waveform import knocks

if TYPE_CHECKING:
    from hyperleg_design.gap.signals.signals import Signals

KNOCKS = 15.0
"""Log odds against a spring where joints knock (in development no spring's joints did; residuals
tell the two apart badly then)."""
WARMER, WARM = 25.0, 2.0
"""How much warmer than `COLD`, and than most other motors, a motor must be [K], and the log odds
that it is why it lacks torque (assumed: of motors that lack torque for another reason, one in seven
is so warm)."""


def odds(effect: str, location: str, signals: Sequence[Signals]) -> float:
    """Log odds for an effect at a place.

    Args:
        effect: of the catalogue.
        location: one of its places.
        signals: conditioned logs.
    """
    if effect == "transmission_elasticity":
        return -KNOCKS if knocks(signals, signals[0].subject.motors.index(location)) else 0.0
    if effect == "thermal_derating":
        return WARM if warm(signals, signals[0].subject.motors.index(location)) else 0.0
    return 0.0


def warm(signals: Sequence[Signals], motor: int) -> bool:
    """Whether a motor is `WARMER`, by all logs; not where none has its temperature."""
    logged = [
        one.temperature
        for one in signals
        if one.temperature is not None and np.isfinite(one.temperature).any()
    ]
    if not logged:
        return False
    mean = np.array(
        [
            np.nanmean(column) if np.isfinite(column).any() else np.nan
            for column in np.concatenate(logged).T
        ]
    )
    others = np.delete(mean, motor)
    usual = float(np.nanmedian(others)) if np.isfinite(others).any() else COLD
    return bool(mean[motor] > max(usual, COLD) + WARMER)
