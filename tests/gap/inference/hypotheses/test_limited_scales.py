"""Scales at which causes are looked for: those of a healthy robot at most."""

from dataclasses import replace

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.inference.channels.scale_fit import first_scales
from hyperleg_design.gap.inference.channels.scales import ABSENT
from hyperleg_design.gap.inference.hypotheses.limited_scales import limited_scales
from hyperleg_design.gap.inference.rules import InferenceRules

RULES = InferenceRules()
MOST = RULES.search.scales


@pytest.fixture(scope="module", params=[(), (1,)], ids=["alone", "referenced"])
def evidence(request, robot_files):
    references = tuple(diagnosed.run("healthy", s, role="reference") for s in request.param)
    log = diagnosed.run("healthy", 0)
    return diagnosed.evidence(robot_files["coupled"], log, references=references)


@pytest.fixture
def small(evidence):
    """Scales of a healthy robot: noise as expected, hardly any discrepancy."""
    scales = [first_scales(channel, RULES) for channel in evidence.channels]
    return [replace(one, noise=np.ones_like(one.noise), new=0.0) for one in scales]


def test_scales_of_a_healthy_robot_stay_as_they_are(evidence, small):
    for lacking in (False, True):
        for own, limited in zip(
            small, limited_scales(evidence, small, RULES, lacking), strict=True
        ):
            np.testing.assert_array_equal(limited.noise, own.noise)
            assert (limited.standing, limited.change, limited.new) == (
                own.standing,
                own.change,
                own.new,
            )


def test_noise_is_cut_under_test_alone(evidence, small):
    loud = [replace(one, noise=np.full_like(one.noise, 1e4)) for one in small]
    for channel, own, limited in zip(
        evidence.channels, loud, limited_scales(evidence, loud, RULES), strict=True
    ):
        tested = channel.bands_tested
        usual = channel.usual_noise(own.noise, RULES)
        np.testing.assert_array_equal(limited.noise[tested], np.minimum(1e4, MOST * usual))
        assert (np.delete(limited.noise, tested) == 1e4).all()
        assert (own.noise == 1e4).all()  # what was given is not written into


def test_a_discrepancy_is_cut_to_that_of_a_healthy_robot(evidence, small):
    large = [replace(one, standing=9.0, change=9.0, new=9.0) for one in small]
    prior = RULES.discrepancy
    for lacking in (False, True):
        for channel, limited in zip(
            evidence.channels, limited_scales(evidence, large, RULES, lacking), strict=True
        ):
            most = prior.referenced if channel.referenced else prior.standing
            taught = channel.referenced and not lacking
            assert limited.standing == (9.0 if taught else pytest.approx(np.log(MOST * most)))
            assert limited.change == pytest.approx(np.log(MOST * prior.change))
            assert limited.new == 0.0


def test_a_discrepancy_that_is_absent_stays_so(evidence, small):
    none = float(np.log(ABSENT))
    absent = [replace(one, standing=none, change=none) for one in small]
    for limited in limited_scales(evidence, absent, RULES, True):
        assert (limited.standing, limited.change) == (none, none)
