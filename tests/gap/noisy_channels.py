"""Channels that hold the noise of their bands alone."""

from types import SimpleNamespace

import numpy as np

from hyperleg_design.gap.inference.channels.channel import Channel
from hyperleg_design.gap.inference.channels.scales import Scales

BANDS = 3


def noisy_channel(referenced=True, **fields):
    """A channel with `BANDS` bands under test and, with references, as many of these."""
    bands = np.arange(BANDS)
    alike = bands + BANDS if referenced else np.full(BANDS, -1)
    own = SimpleNamespace(
        referenced=referenced,
        bands_tested=bands,
        bands_alike=alike,
        numbers=np.full(2 * BANDS, 50.0),
        **fields,
    )
    for name in ("usual_noise", "noisy"):
        setattr(own, name, getattr(Channel, name).__get__(own))
    return own


def noisy_scales(standing=0.0, new=0.0, noise=1.0, healthy=1.0):
    """Scales with one noise in the bands under test, and another in those of references."""
    levels = np.r_[np.full(BANDS, noise), np.full(BANDS, healthy)]
    return Scales(levels, standing, np.log(0.3), new)
