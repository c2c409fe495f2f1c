"""Sizes of residuals of a biped that stands on grounds of any kind."""

import numpy as np


def rms(values):
    return float(np.sqrt(np.nanmean(values**2)))


def late(signals, values):
    """After the robot has come down."""
    return values[(signals.time > 0.6) & signals.valid]
