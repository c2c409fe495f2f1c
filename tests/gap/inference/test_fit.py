import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hyperleg_design.gap.inference.base import LIMIT
from hyperleg_design.gap.inference.fit import Design, _bounded, parts


def test_products_give_the_same_as_samples(viscous_ready, knee_friction):
    design = Design(viscous_ready.base, [knee_friction])
    fit = design.fit()
    left = design.left(fit.phi, fit.errors)
    samples = viscous_ready.base.samples
    assert np.allclose(
        np.bincount(samples.group, left**2, samples.groups), fit.rss, rtol=1e-6, atol=1e-6
    )


def test_parts_cut_the_parameters_of_all_causes_without_gap(viscous_ready, knee_friction):
    design = Design(viscous_ready.base, [knee_friction, knee_friction])
    phi = design.fit().phi
    first, second = parts(design.causes)
    assert (first, second) == (slice(0, 1), slice(1, 2))
    weight = viscous_ready.base.samples.weight
    assert np.allclose(
        design.trace(phi), sum(knee_friction.trace(phi[part]) for part in (first, second)) * weight
    )
    assert parts(()) == []


def test_a_fit_is_the_minimum_of_its_cost(viscous_ready, knee_friction):
    base = viscous_ready.base
    design = Design(base, [knee_friction])
    weight = 1 / design.fit().scale

    def cost(phi, errors):
        prior = np.sum((phi / design.deviation) ** 2) + np.einsum(
            "sp,pq,sq->", errors, base.prior.precision, errors
        )
        return weight @ design.rss(phi, errors) + prior

    phi, _, errors, _ = design.solve(weight)
    best = cost(phi, errors)
    rng = np.random.default_rng(0)
    for _ in range(10):
        step = 0.05 * rng.normal(size=errors.shape)
        inside = np.abs(errors + step) <= LIMIT
        assert cost(phi + 0.05 * rng.normal(size=1), errors + np.where(inside, step, 0.0)) > best


def test_a_known_friction_is_found_with_an_honest_interval(viscous_ready, knee_friction):
    fit = Design(viscous_ready.base, [knee_friction]).fit()
    value = float(fit.phi[0] * knee_friction.usual[0])
    reach = 1.96 * float(np.sqrt(fit.covariance[0, 0])) * knee_friction.usual[0]
    assert value == pytest.approx(0.3, abs=0.03)
    assert abs(value - 0.3) < max(reach, 1e-3)
    assert reach < 0.15


def test_an_effect_far_larger_than_usual_is_not_shrunk(viscous_ready, knee_friction):
    from dataclasses import replace

    smaller = 0.05
    tiny = replace(
        knee_friction, usual=knee_friction.usual * smaller, columns=knee_friction.columns * smaller
    )
    usual, found = (
        Design(viscous_ready.base, [c]).fit().phi[0] * c.usual[0] for c in (knee_friction, tiny)
    )
    assert found == pytest.approx(usual, rel=0.01)


def test_errors_never_leave_their_limits(viscous_ready):
    fit = Design(viscous_ready.base).fit()
    assert np.abs(fit.errors).max() <= LIMIT * (1 + 1e-9)


def test_bounds_are_kept(viscous_ready, knee_friction):
    from dataclasses import replace

    tight = replace(knee_friction, high=np.array([0.1]))
    fit = Design(viscous_ready.base, [tight]).fit()
    assert fit.phi[0] * knee_friction.usual[0] == pytest.approx(0.1)


@given(st.integers(1, 8), st.integers(0, 10**6))
def test_least_squares_within_bounds_are_the_least(count, seed):
    rng = np.random.default_rng(seed)
    root = rng.standard_normal((count, count)) * 10 ** rng.uniform(-2, 2, count)
    matrix, right = (
        root.T @ root + 1e-2 * np.eye(count),
        10 * rng.standard_normal(count) * np.linalg.norm(root, axis=0),
    )
    low = np.where(rng.random(count) < 0.2, -np.inf, -rng.random(count))
    high = np.where(rng.random(count) < 0.2, low, rng.random(count))
    high = np.where(np.isfinite(high), high, 0.0)
    phi, _ = _bounded(matrix, right, low, high)
    assert ((phi >= low) & (phi <= high)).all()
    slope, small = matrix @ phi - right, 1e-6 * (np.abs(matrix) @ np.abs(phi) + np.abs(right))
    assert (slope[phi > low] <= small[phi > low]).all(), "what could be less would make it better"
    assert (slope[phi < high] >= -small[phi < high]).all(), (
        "what could be more would make it better"
    )


def test_what_is_held_stays_and_the_rest_is_fitted_around_it():
    matrix, right = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([1.0, 0.0])
    free, held = (
        _bounded(matrix, right, np.full(2, -9.0), np.full(2, 9.0))[0],
        np.array([3.0, np.nan]),
    )
    assert np.allclose(matrix @ free, right)
    assert np.allclose(
        _bounded(matrix, right, np.full(2, -9.0), np.full(2, 9.0), held)[0], [3.0, -1.5]
    )
    assert np.allclose(
        _bounded(matrix, right, np.full(2, -9.0), np.array([9.0, -2.0]), held)[0], [3.0, -2.0]
    )
