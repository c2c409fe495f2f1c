from types import SimpleNamespace

import numpy as np

from hyperleg_design.gap.inference.channels.scales import Scales
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.inference.unlisted import unlisted

RULES = InferenceRules()


def channel(referenced=False, densities=(0.0, -9.0)):
    return SimpleNamespace(referenced=referenced, noisy=lambda noise, rules: densities)


def scales(standing=0.0, new=0.0):
    return Scales(np.ones(1), standing, np.log(0.3), new)


def test_a_scale_is_unlisted_where_that_prior_is_likelier():
    assert not unlisted(channel(), scales(), RULES)
    assert not unlisted(channel(), scales(-3.0), RULES)
    assert unlisted(channel(), scales(np.log(30.0)), RULES)


def test_beside_references_a_new_discrepancy_is_unlisted_however_large_the_standing_one():
    assert not unlisted(channel(True), scales(np.log(30.0)), RULES)
    assert unlisted(channel(True), scales(new=1.0), RULES)


def test_noise_is_unlisted_where_that_prior_is_likelier():
    assert unlisted(channel(densities=(-9.0, 0.0)), scales(), RULES)
