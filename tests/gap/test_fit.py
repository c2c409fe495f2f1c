import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.base import LIMIT
from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.fit import Design
from hyperleg_design.gap.screen import linearise


@pytest.fixture(scope="module")
def ready(robot_files):
    return diagnosed.prepared(robot_files["coupled"], diagnosed.run("viscous", 0), diagnosed.run("viscous", 1))


@pytest.fixture(scope="module")
def cause(ready):
    return linearise(ready.base.samples, EFFECTS["viscous_friction"], "knee", np.zeros(1))


def test_products_give_the_same_as_samples(ready, cause):
    design = Design(ready.base, [cause])
    fit = design.fit()
    left = design.left(fit.phi, fit.errors)
    samples = ready.base.samples
    assert np.allclose(np.bincount(samples.group, left**2, samples.groups), fit.rss, rtol=1e-6, atol=1e-6)


def test_a_fit_is_the_minimum_of_its_cost(ready, cause):
    base = ready.base
    design = Design(base, [cause])
    weight = 1 / design.fit().scale

    def cost(phi, errors):
        prior = np.sum((phi / design.deviation) ** 2) + np.einsum("sp,pq,sq->", errors, base.prior.precision, errors)
        return weight @ design.rss(phi, errors) + prior

    phi, _, errors, _ = design.solve(weight)
    best = cost(phi, errors)
    rng = np.random.default_rng(0)
    for _ in range(10):
        step = 0.05 * rng.normal(size=errors.shape)
        inside = np.abs(errors + step) <= LIMIT
        assert cost(phi + 0.05 * rng.normal(size=1), errors + np.where(inside, step, 0.0)) > best


def test_a_known_friction_is_found_with_an_honest_interval(ready, cause):
    fit = Design(ready.base, [cause]).fit()
    value = float(fit.phi[0] * cause.usual[0])
    reach = 1.96 * float(np.sqrt(fit.covariance[0, 0])) * cause.usual[0]
    assert value == pytest.approx(0.3, abs=0.03)
    assert abs(value - 0.3) < max(reach, 1e-3)
    assert reach < 0.15


def test_errors_never_leave_their_limits(ready):
    fit = Design(ready.base).fit()
    assert np.abs(fit.errors).max() <= LIMIT * (1 + 1e-9)


def test_bounds_are_kept(ready, cause):
    from dataclasses import replace

    tight = replace(cause, high=np.array([0.1]))
    fit = Design(ready.base, [tight]).fit()
    assert fit.phi[0] * cause.usual[0] == pytest.approx(0.1)
