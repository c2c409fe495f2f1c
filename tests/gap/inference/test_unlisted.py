from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.gap.inference.channels.channel import Channel
from hyperleg_design.gap.inference.channels.scales import Scales
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.inference.unlisted import excess_noise, makes_noise, unlisted

RULES = InferenceRules()
BANDS = 3


def channel(referenced=False):
    """A channel with `BANDS` bands under test and, with references, as many of these."""
    bands = np.arange(BANDS)
    alike = bands + BANDS if referenced else np.full(BANDS, -1)
    own = SimpleNamespace(referenced=referenced, bands_tested=bands, bands_alike=alike)
    for name in ("usual_noise", "noisy"):
        setattr(own, name, getattr(Channel, name).__get__(own))
    return own


def scales(standing=0.0, new=0.0, noise=1.0, healthy=1.0):
    levels = np.r_[np.full(BANDS, noise), np.full(BANDS, healthy)]
    return Scales(levels, standing, np.log(0.3), new)


def test_a_scale_is_unlisted_where_that_prior_is_likelier():
    assert not unlisted(channel(), scales(), RULES)
    assert not unlisted(channel(), scales(-3.0), RULES)
    assert unlisted(channel(), scales(np.log(30.0)), RULES)


def test_beside_references_a_new_discrepancy_is_unlisted_however_large_the_standing_one():
    assert not unlisted(channel(True), scales(np.log(30.0)), RULES)
    assert unlisted(channel(True), scales(new=1.0), RULES)


@pytest.mark.parametrize("healthy", [0.1, 1.0, 30.0])
def test_noise_is_unlisted_where_it_is_far_above_that_of_the_references(healthy):
    usual = max(healthy, RULES.noise.least)
    for times in (1e-6, 0.01, 1.0, 1.5):
        quiet = scales(noise=times * usual, healthy=healthy)
        assert not makes_noise(channel(True), quiet, RULES)
        assert excess_noise(channel(True), quiet, RULES) == 1
    loud = scales(noise=100 * usual, healthy=healthy)
    assert makes_noise(channel(True), loud, RULES)
    assert unlisted(channel(True), loud, RULES)
    assert excess_noise(channel(True), loud, RULES) == pytest.approx(10.0)
