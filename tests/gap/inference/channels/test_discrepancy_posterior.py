"""The posterior of the discrepancy against the normal equations, and its limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hyperleg_design.gap.inference.channels.discrepancy_posterior import discrepancy_posterior
from hyperleg_design.gap.inference.channels.residual import Residual
from tests.gap.inference.channels.test_channel import SCALES, made


def least_squares(channel, white, scales):
    """Means and covariances of w + delta_s in each session, from the joint normal equations of w
    and of the change in every session.
    """
    change = channel.change_scales(scales) ** 2
    k, sessions = channel.columns, len(channel.tested)
    precision = np.zeros((k * (1 + sessions),) * 2)
    known = np.arange(k) < channel.known
    precision[:k, :k] = np.diag(np.where(known, 1.0, np.exp(-2 * scales.standing)))
    right = np.zeros(len(precision))
    for s in range(sessions):
        own = slice(k * (1 + s), k * (2 + s))
        precision[own, own] = np.diag(np.where(np.arange(k) < channel.steady, 1e12, 1 / change[s]))
    for cell, rows in enumerate(white):
        s, noise = channel.session[cell], scales.noise[channel.band[cell]]
        both = np.r_[0:k, k * (1 + s) : k * (2 + s)]
        stacked = np.concatenate([rows[:-1], rows[:-1]])
        precision[np.ix_(both, both)] += stacked @ stacked.T / noise
        right[both] += stacked @ rows[-1] / noise
    covariance = np.linalg.inv(precision)
    means, covariances = [], []
    for s in range(sessions):
        turn = np.zeros((k, len(right)))
        turn[:, :k] = turn[:, k * (1 + s) : k * (2 + s)] = np.eye(k)
        means.append(turn @ covariance @ right)
        covariances.append(turn @ covariance @ turn.T)
    return np.array(means), np.array(covariances)


@pytest.mark.parametrize("steady", [0, 1, 3])
def test_it_is_that_of_the_normal_equations(steady):
    channel, white = made(np.random.default_rng(8), steady=steady)
    means, covariances = discrepancy_posterior(channel, SCALES)
    expected_means, expected_covariances = least_squares(channel, white, SCALES)
    np.testing.assert_allclose(means, expected_means, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(covariances, expected_covariances, atol=1e-9)


def test_of_one_session_it_is_a_ridge_regression():
    channel, white = made(np.random.default_rng(3), sessions=1)
    scales = replace(SCALES, noise=np.array([0.7, 1.9]))
    precision = np.eye(channel.columns) / np.exp(2 * scales.standing)
    right = np.zeros(channel.columns)
    for rows, noise in zip(white, scales.noise, strict=True):
        precision += rows[:-1] @ rows[:-1].T / noise
        right += rows[:-1] @ rows[-1] / noise
    means, covariances = discrepancy_posterior(channel, scales)
    np.testing.assert_allclose(means, [np.linalg.solve(precision, right)], rtol=1e-9)
    np.testing.assert_allclose(covariances, [np.linalg.inv(precision)], rtol=1e-9)


@pytest.mark.parametrize("steady", [0, 2])
def test_samples_that_say_nothing_leave_the_prior(steady):
    channel, _ = made(np.random.default_rng(4), steady=steady)
    blank = replace(channel, products=np.zeros_like(channel.products))
    means, covariances = discrepancy_posterior(blank, SCALES)
    assert not means.any()
    for s, change in enumerate(channel.change_scales(SCALES)):
        place = np.arange(channel.columns)
        prior = np.where(place < channel.known, 1.0, np.exp(2 * SCALES.standing))
        prior += np.where(place >= steady, change**2, 0.0)
        np.testing.assert_allclose(covariances[s], np.diag(prior), atol=1e-12)


def test_without_noise_it_is_the_discrepancy_that_made_the_residual():
    rng = np.random.default_rng(5)
    channel, white = made(rng)
    truth = rng.standard_normal((len(channel.tested), channel.columns))
    exact = [
        np.concatenate([rows[:-1], truth[None, s] @ rows[:-1]])
        for rows, s in zip(white, channel.session, strict=True)
    ]
    channel = replace(channel, products=np.array([rows @ rows.T for rows in exact]))
    means, covariances = discrepancy_posterior(channel, replace(SCALES, noise=np.full(4, 1e-8)))
    np.testing.assert_allclose(means, truth, atol=1e-6)
    assert np.abs(covariances).max() < 1e-8


def test_a_steady_column_is_the_same_in_all_sessions():
    channel, _ = made(np.random.default_rng(6), steady=2)
    means, covariances = discrepancy_posterior(channel, SCALES)
    assert np.ptp(means[:, :2], axis=0).max() < 1e-12
    assert np.ptp(means[:, 2:], axis=0).min() > 1e-3
    assert np.ptp(covariances[:, :2, :2], axis=0).max() < 1e-12


def test_means_are_proportional_to_the_residual_and_covariances_do_not_know_it():
    channel, _ = made(np.random.default_rng(7))
    whole = channel.whole_residual
    means, covariances = discrepancy_posterior(channel, SCALES)
    tripled = Residual(3 * whole.cross, 9 * whole.square)
    other_means, other_covariances = discrepancy_posterior(channel, SCALES, tripled)
    np.testing.assert_allclose(other_means, 3 * means, rtol=1e-12)
    np.testing.assert_array_equal(other_covariances, covariances)
