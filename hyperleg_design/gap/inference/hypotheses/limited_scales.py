"""Scales of noise and discrepancy at which causes are looked for."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hyperleg_design.gap.inference.assembly import Evidence
from hyperleg_design.gap.inference.channels.scales import Scales
from hyperleg_design.gap.inference.rules import InferenceRules


def limited_scales(
    evidence: Evidence, scales: Sequence[Scales], rules: InferenceRules, lacking: bool = False
) -> tuple[Scales, ...]:
    """Limit the scales under test, so that a search for causes finds what noise and discrepancy
    would explain otherwise.

    Noise and discrepancy that were fitted without a cause stand for it and hide it. They are cut to
    `SearchRules.scales` times those of a healthy robot.

    Args:
        evidence: channels.
        scales: fitted hyperparameters by channel.
        rules: of the inference.
        lacking: whether a cause acts in all logs, so that the discrepancy that references taught
            stands for it, too.

    Returns:
        The limited scales by channel.
    """
    prior, most = rules.discrepancy, rules.search.scales
    change, alone = np.log(most * prior.change), np.log(most * prior.standing)
    taught = np.log(most * prior.referenced) if lacking else np.inf
    limited = []
    for channel, own in zip(evidence.channels, scales, strict=True):
        noise, place = own.noise.copy(), channel.bands_tested
        noise[place] = np.minimum(noise[place], most * channel.usual_noise(own.noise, rules))
        standing = min(own.standing, taught if channel.referenced else alone)
        limited.append(Scales(noise, float(standing), min(own.change, change), 0.0))
    return tuple(limited)
