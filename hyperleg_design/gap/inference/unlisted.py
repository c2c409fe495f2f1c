"""Whether an effect that the catalogue lacks acts on a channel."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.inference.channels.channel import Channel
from hyperleg_design.gap.inference.channels.scales import ABSENT, Scales
from hyperleg_design.gap.inference.rules import InferenceRules


def unlisted(channel: Channel, scales: Scales, rules: InferenceRules) -> bool:
    """Whether a channel's discrepancy or noise is rather an unlisted effect's than a healthy
    robot's.

    Args:
        channel: of the evidence.
        scales: that were fitted to it.
        rules: of the inference.
    """
    if makes_noise(channel, scales, rules):
        return True
    prior = rules.discrepancy
    if channel.referenced:
        return scales.new > ABSENT
    healthy = ((scales.standing - np.log(prior.standing)) / prior.standing_spread) ** 2
    other = ((scales.standing - np.log(prior.unlisted)) / prior.unlisted_spread) ** 2
    odds = np.log(prior.unlisted_probability / (1 - prior.unlisted_probability))
    odds += 0.5 * (healthy - other) + np.log(prior.standing_spread / prior.unlisted_spread)
    return bool(odds > 0 and scales.standing > np.log(prior.standing))


def makes_noise(channel: Channel, scales: Scales, rules: InferenceRules) -> bool:
    """Whether a channel's noise is rather an unlisted effect's than a healthy robot's.

    Args:
        channel: of the evidence.
        scales: that were fitted to it.
        rules: of the inference.
    """
    healthy, other = channel.noisy(scales.noise, rules)
    return other > healthy
