"""Fits of causes that are linearised, against what they are linearised of."""

from dataclasses import replace

import numpy as np
import pytest

from hyperleg_design.gap.inference.hypotheses.limited_scales import limited_scales
from hyperleg_design.gap.inference.hypotheses.relinearisation import relinearised


def test_causes_are_looked_for_where_nothing_stands_in_for_them(fits):
    """Whatever noise and discrepancy have grown to in logs under test."""
    grown = tuple(
        replace(one, noise=100 * one.noise, change=2.0, new=1.0) for one in fits.null.scales
    )
    for one, large, channel in zip(
        limited_scales(fits.evidence, grown, fits.rules), grown, fits.evidence.channels, strict=True
    ):
        assert one.new == 0
        assert np.exp(one.change) == pytest.approx(
            fits.rules.search.scales * fits.rules.discrepancy.change
        )
        assert one.standing == large.standing  # of references
        usual = channel.usual_noise(large.noise, fits.rules)
        assert (one.noise[channel.bands_tested] <= fits.rules.search.scales * usual).all()
    assert limited_scales(fits.evidence, fits.null.scales, fits.rules)[0].new == 0
    taught = fits.rules.search.scales * fits.rules.discrepancy.referenced
    large = tuple(replace(one, standing=9.0) for one in grown)
    for one in limited_scales(fits.evidence, large, fits.rules, lacking=True):
        assert np.exp(one.standing) == pytest.approx(taught)


def test_a_fit_far_from_where_its_cause_is_linearised_scores_as_the_load_there_does(
    fits, loaded, load
):
    settled = relinearised(fits, loaded(fits, load))
    for values in ([0.2, 0.02, 0.0, -0.35, 0.0], [2.0, 0.0, 0.0, 0.1, 0.0]):
        far = loaded(fits, values)
        there = fits.where_linearised(far)
        assert there.log_evidence < settled.log_evidence
        np.testing.assert_allclose(there.values(0), values, atol=1e-9)
        again = loaded(fits, there.values(0))  # linearised at the same values: the same
        assert fits.where_linearised(again).score == pytest.approx(there.score, abs=1e-6)
    assert fits.where_linearised(settled) is settled
