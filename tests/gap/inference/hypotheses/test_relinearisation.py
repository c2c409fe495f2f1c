"""Hypotheses are compared where their causes are linearised."""

import dataclasses

import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.hypotheses.hypothesis import Candidate
from hyperleg_design.gap.inference.hypotheses.hypothesis_fit import HypothesisFit
from hyperleg_design.gap.inference.hypotheses.relinearisation import on_other_evidence, relinearised
from hyperleg_design.gap.inference.linearisation import linearise


def test_a_load_is_the_same_wherever_it_was_linearised(fits, loaded, load):
    far, near = loaded(fits, [0.2, 0.02, 0.0, -0.35, 0.0]), loaded(fits, load)
    assert abs(far.values(0)[0] - near.values(0)[0]) > 0.1 * load[0]
    settled = relinearised(fits, far)
    np.testing.assert_allclose(
        settled.values(0)[0], relinearised(fits, near).values(0)[0], rtol=0.02
    )
    assert settled.values(0)[0] == pytest.approx(load[0], rel=0.1)
    (cause,) = settled.causes
    assert (
        np.abs(cause.values - settled.values(0)) < fits.rules.search.converged * cause.usual
    ).all()


def test_a_hypothesis_of_other_evidence_is_fitted_anew(fits, loaded, load):
    far = loaded(fits, [0.2, 0.02, 0.0, -0.35, 0.0])
    moved = on_other_evidence(fits, far)
    assert moved.names == far.names
    assert moved.values(0)[0] == pytest.approx(load[0], rel=0.1)
    assert on_other_evidence(fits, fits.null) is fits.null


def test_what_is_linearised_where_it_is_stays_as_it_is(fits, loaded, load):
    settled = relinearised(fits, loaded(fits, load))
    assert relinearised(fits, settled) is settled


def test_friction_under_load_is_linearised_with_the_load_that_is_fitted_beside_it(
    fits, loaded, load
):
    rubbing = linearise(
        fits.evidence.samples, EFFECTS["load_dependent_friction"], "knee", np.array([0.1])
    )
    candidates = (
        *loaded(fits, load).candidates,
        Candidate(
            "load_dependent_friction", "knee", (fits.evidence.on_all_samples(rubbing, True),)
        ),
    )
    settled = relinearised(fits, fits.fit(candidates, fits.null.scales))
    carried, rubs = settled.causes
    np.testing.assert_allclose(rubs.before, settled.values(0), atol=0.02)
    assert not carried.before
    assert not np.allclose(rubs.columns, rubbing.columns[:, : rubs.columns.shape[1]])


def test_too_few_steps_to_converge_do_not_raise_the_score(fits, loaded, load):
    settled = relinearised(fits, loaded(fits, load)).score
    few = dataclasses.replace(fits.rules.search, steps=1)
    hasty = HypothesisFit(
        fits.evidence, dataclasses.replace(fits.rules, search=few), {}, fits.count
    )
    for values in ([0.2, 0.02, 0.0, -0.35, 0.0], [2.0, 0.0, 0.0, 0.1, 0.0]):
        assert relinearised(hasty, loaded(fits, values)).score < settled + 0.1
