"""Fits of causes that are linearised, against what they are linearised of."""

from dataclasses import replace

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.hypotheses.hypothesis import Candidate
from hyperleg_design.gap.inference.hypotheses.hypothesis_fit import HypothesisFit
from hyperleg_design.gap.inference.hypotheses.limited_scales import limited_scales
from hyperleg_design.gap.inference.linearisation import linearise
from hyperleg_design.gap.inference.rules import InferenceRules

PLACE = "shank"
LOAD = np.array([0.5, 0.0, 0.0, -0.2, 0.0])


@pytest.fixture(scope="module")
def fits(robot_files):
    """Of logs whose residual is that of a load, beside a healthy robot's."""
    found = diagnosed.evidence(
        robot_files["coupled"],
        diagnosed.run("healthy", 0),
        references=(diagnosed.run("healthy", 1, role="reference"),),
    )
    load = found.tests.columns(lambda s: EFFECTS["payload"].trace(s, PLACE, LOAD[None]), 1)[0]
    trace = np.zeros(len(found.samples.value))
    trace[: len(load)] = -load * found.weight[: len(load)]
    channels = tuple(one.without(trace) for one in found.channels)
    evidence = type(found)(**{**vars(found), "channels": channels})
    count = {"payload": 2, "load_dependent_friction": 2}
    return HypothesisFit(evidence, InferenceRules(), {}, count)


def fitted(fits, values):
    cause = linearise(fits.evidence.tests, EFFECTS["payload"], PLACE, np.array(values))
    cause = fits.evidence.on_all_samples(cause, False)
    return fits.fit((Candidate("payload", PLACE, (cause,)),), fits.null.scales)


def test_a_load_is_the_same_wherever_it_was_linearised(fits):
    far, near = fitted(fits, [0.2, 0.02, 0.0, -0.35, 0.0]), fitted(fits, LOAD)
    assert abs(far.values(0)[0] - near.values(0)[0]) > 0.1 * LOAD[0]
    settled = fits.relinearised(far)
    np.testing.assert_allclose(
        settled.values(0)[0], fits.relinearised(near).values(0)[0], rtol=0.02
    )
    assert settled.values(0)[0] == pytest.approx(LOAD[0], rel=0.1)
    (cause,) = settled.causes
    assert (
        np.abs(cause.values - settled.values(0)) < fits.rules.search.converged * cause.usual
    ).all()


def test_what_is_linearised_where_it_is_stays_as_it_is(fits):
    settled = fits.relinearised(fitted(fits, LOAD))
    assert fits.relinearised(settled) is settled


def test_friction_under_load_is_linearised_with_the_load_that_is_fitted_beside_it(fits):
    rubbing = linearise(
        fits.evidence.samples, EFFECTS["load_dependent_friction"], "knee", np.array([0.1])
    )
    candidates = (
        *fitted(fits, LOAD).candidates,
        Candidate(
            "load_dependent_friction", "knee", (fits.evidence.on_all_samples(rubbing, True),)
        ),
    )
    settled = fits.relinearised(fits.fit(candidates, fits.null.scales))
    load, rubs = settled.causes
    np.testing.assert_allclose(rubs.before, settled.values(0), atol=0.02)
    assert not load.before
    assert not np.allclose(rubs.columns, rubbing.columns[:, : rubs.columns.shape[1]])


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
