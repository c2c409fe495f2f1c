"""The space of a sweep: its samples and the designs made of them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.sweep.space import SAMPLINGS, sweep_from_mapping
from tests.sweep.test_space import AXES, GRID, sampled


def test_a_grid_has_every_combination_once():
    sweep = sweep_from_mapping(
        {"design": "hyperleg", "variants": ["toe", "toe_locked"], "axes": GRID}
    )
    samples = sweep.samples()
    assert (sweep.count, sweep.size) == (6, 12)
    assert (
        len(
            set(
                zip(
                    samples["toe.mass"].tolist(),
                    samples["actuators.knee.motor"].tolist(),
                    strict=True,
                )
            )
        )
        == 6
    )


@pytest.mark.parametrize("sampling", [s for s in SAMPLINGS if s != "grid"])
def test_samples_follow_from_the_seed(sampling):
    first, again, other = (sampled(sampling, seed=s).samples() for s in (3, 3, 4))
    for name in AXES:
        assert first[name].tobytes() == again[name].tobytes()
        assert not np.array_equal(first[name], other[name])


@given(count=st.integers(1, 40), seed=st.integers(0, 2**31))
@settings(max_examples=20, deadline=None)
def test_a_latin_hypercube_has_one_sample_a_stratum(count, seed):
    for values, (low, high) in zip(
        sampled("latin_hypercube", count, seed).samples().values(),
        ((0.1, 0.5), (0.8, 1.2)),
        strict=True,
    ):
        strata = np.floor((values - low) / (high - low) * count).astype(int)
        np.testing.assert_array_equal(np.sort(np.clip(strata, 0, count - 1)), np.arange(count))


@given(power=st.integers(0, 6), seed=st.integers(0, 2**31))
@settings(max_examples=20, deadline=None)
def test_sobol_points_are_balanced(power, seed):
    """The first 2^k points have one in each of 2^k equal intervals of every axis."""
    count = 2**power
    values = sampled("sobol", count, seed).samples()["toe.mass"]
    np.testing.assert_array_equal(
        np.sort(((values - 0.1) / 0.4 * count).astype(int)), np.arange(count)
    )


def test_designs_take_the_samples_and_become_the_variant():
    sweep = sampled(variants=["toe_removed_matched"], count=4)
    samples = sweep.samples()
    design = sweep.design(samples, "toe_removed_matched")
    assert design.batch_shape == (4,)
    assert design.variant == "toe_removed_matched"
    np.testing.assert_array_equal(design["toe.mass"], samples["toe.mass"])
    np.testing.assert_allclose(
        design["shank.length"], samples["leg"] * sweep.base.shank.length, rtol=1e-15
    )


def test_the_digest_sees_what_changes_numbers():
    base = sampled().digest()
    assert base == sampled().digest()
    for change in (
        {"seed": 1},
        {"count": 17},
        {"sampling": "random"},
        {"variants": ["toe_locked"]},
        {"measures": ["leg_mass"]},
    ):
        assert sampled(**change).digest() != base, change
