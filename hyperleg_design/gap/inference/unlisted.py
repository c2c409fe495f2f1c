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

    Less noise than a healthy robot's is none: a command that follows its law exactly has no
    residual at all.

    Args:
        channel: of the evidence.
        scales: that were fitted to it.
        rules: of the inference.
    """
    noise, tested = scales.noise.copy(), channel.bands_tested
    noise[tested] = np.maximum(noise[tested], channel.usual_noise(noise, rules))
    healthy, other = channel.noisy(noise, rules)
    return other > healthy


def excess_noise(channel: Channel, scales: Scales, rules: InferenceRules) -> float:
    """Compute how many times as much a channel scatters as a healthy robot's, where something
    unlisted makes its noise.

    Args:
        channel: of the evidence.
        scales: that were fitted to it.
        rules: of the inference.

    Returns:
        The ratio of standard deviations in the band where it is largest; 1 where the noise is a
        healthy robot's.
    """
    if not makes_noise(channel, scales, rules):
        return 1.0
    over = scales.noise[channel.bands_tested] / channel.usual_noise(scales.noise, rules)
    return float(np.sqrt(over.max()))


def scatter(channel: Channel, scales: Scales, rules: InferenceRules) -> float:
    """Compute how many times as much a channel scatters as in the references, over all bands.

    Args:
        channel: of the evidence.
        scales: that were fitted to it.
        rules: of the inference.

    Returns:
        The ratio of standard deviations; 1 where it is within the deviation of a healthy robot's,
        or where there are no references.
    """
    known = channel.bands_alike >= 0
    if not known.any():
        return 1.0
    numbers = channel.numbers[channel.bands_tested][known]
    here = numbers @ scales.noise[channel.bands_tested][known]
    before = numbers @ channel.usual_noise(scales.noise, rules)[known]
    over = float(here / before)
    return float(np.sqrt(over)) if np.log(over) > rules.noise.spread else 1.0
