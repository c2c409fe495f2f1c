import numpy as np
import pytest
from noisy_channels import noisy_channel, noisy_scales

from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.inference.unlisted import excess_noise, makes_noise, scatter, unlisted

RULES = InferenceRules()


def test_a_scale_is_unlisted_where_that_prior_is_likelier():
    assert not unlisted(noisy_channel(False), noisy_scales(), RULES)
    assert not unlisted(noisy_channel(False), noisy_scales(-3.0), RULES)
    assert unlisted(noisy_channel(False), noisy_scales(np.log(30.0)), RULES)


def test_beside_references_a_new_discrepancy_is_unlisted_however_large_the_standing_one():
    assert not unlisted(noisy_channel(), noisy_scales(np.log(30.0)), RULES)
    assert unlisted(noisy_channel(), noisy_scales(new=1.0), RULES)


@pytest.mark.parametrize("healthy", [0.1, 1.0, 30.0])
def test_noise_is_unlisted_where_it_is_far_above_that_of_the_references(healthy):
    usual = max(healthy, RULES.noise.least)
    for times in (1e-6, 0.01, 1.0, 1.5):
        quiet = noisy_scales(noise=times * usual, healthy=healthy)
        assert not makes_noise(noisy_channel(), quiet, RULES)
        assert excess_noise(noisy_channel(), quiet, RULES) == 1
    loud = noisy_scales(noise=100 * usual, healthy=healthy)
    assert makes_noise(noisy_channel(), loud, RULES)
    assert unlisted(noisy_channel(), loud, RULES)
    assert excess_noise(noisy_channel(), loud, RULES) == pytest.approx(10.0)


def test_scatter_is_told_from_one_deviation_of_a_healthy_robots_on():
    assert scatter(noisy_channel(), noisy_scales(noise=4.0), RULES) == pytest.approx(2.0)
    within = 0.99 * np.exp(RULES.noise.spread)
    assert scatter(noisy_channel(), noisy_scales(noise=within), RULES) == 1
    assert scatter(noisy_channel(referenced=False), noisy_scales(noise=4.0), RULES) == 1
