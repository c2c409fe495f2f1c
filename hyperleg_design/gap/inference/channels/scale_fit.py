"""Fit the hyperparameters of one residual channel: noise by expectation maximisation, scales of the
discrepancy by a line search each.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from hyperleg_design.gap.inference.channels.channel import Channel
from hyperleg_design.gap.inference.channels.discrepancy_posterior import discrepancy_posterior
from hyperleg_design.gap.inference.channels.likelihood import Likelihood
from hyperleg_design.gap.inference.channels.residual import Residual
from hyperleg_design.gap.inference.channels.scales import ABSENT, Scales
from hyperleg_design.gap.inference.rules import InferenceRules

STEPS = (1.2, 0.5, 0.2)
"""Steps of the search for a scale's logarithm, each halved about [-]."""
MOST_STEPS = 4
"""Most steps of one size in the search for a scale."""


def first_scales(channel: Channel, rules: InferenceRules) -> Scales:
    """Choose the scales from which a fit begins: noise that explains the whole residual.

    Args:
        channel: whose they are.
        rules: of the inference.
    """
    square = np.bincount(channel.band, channel.whole_residual.square, len(channel.numbers))
    weight, prior = rules.noise.weight, rules.discrepancy
    noise = np.maximum((weight + square) / (weight + channel.numbers), 1.0)
    standing = prior.referenced if channel.referenced else prior.standing
    return Scales(noise, float(np.log(standing)), float(np.log(prior.change)))


def fitted(
    channel: Channel,
    scales: Scales,
    rules: InferenceRules,
    residual: Residual | None = None,
    sweeps: int = 3,
    steps: tuple[float, ...] = STEPS,
    again: bool = False,
) -> Scales:
    """Hyperparameters at the maximum of their posterior.

    Args:
        channel: whose they are.
        scales: to begin with.
        rules: of the inference.
        residual: what is left of the channel's; all of it by default.
        sweeps: of noise and scales in turn.
        steps: of the searches for a scale's logarithm.
        again: whether nothing unlisted acts where nothing did, so that it is not looked for.
    """
    residual = channel.whole_residual if residual is None else residual
    for _ in range(sweeps):
        scales = replace(scales, noise=_noise(channel, scales, rules, residual))
        likelihood = channel.likelihood(scales.noise, residual)
        scales = _searched(channel, scales, "standing", rules, likelihood, steps)
        if channel.changes:
            scales = _searched(channel, scales, "change", rules, likelihood, steps)
    if channel.referenced and (scales.new or not again):
        likelihood = channel.likelihood(scales.noise, residual)
        healthy = replace(scales, new=0.0)
        begin = max(scales.new, float(np.log(rules.discrepancy.unlisted)) / 2)
        unlisted = _searched(channel, replace(scales, new=begin), "new", rules, likelihood, steps)
        scales = max(
            (healthy, unlisted), key=lambda tried: _score(channel, tried, rules, likelihood)
        )
    return scales


def _noise(
    channel: Channel, scales: Scales, rules: InferenceRules, residual: Residual
) -> np.ndarray:
    """Noise by band at which the expected log posterior is largest, the discrepancy being what it
    is at some scales `(b,)`.
    """
    weight = rules.noise.weight
    means, covariances = discrepancy_posterior(channel, scales, residual)
    square = residual.square.copy()
    for session, (mean, covariance) in enumerate(zip(means, covariances, strict=True)):
        own = channel.session == session
        products = channel.products[own, :-1, :-1]
        square[own] += products @ mean @ mean - 2 * residual.cross[own] @ mean
        square[own] += np.einsum("cij,ij->c", products, covariance)
    left = np.bincount(channel.band, np.maximum(square, 0.0), len(channel.numbers))
    usual = np.ones(len(channel.numbers))
    usual[channel.bands_tested] = channel.usual_noise(scales.noise, rules)
    return np.asarray((weight * usual + left) / (weight + channel.numbers))


def _score(
    channel: Channel, scales: Scales, rules: InferenceRules, likelihood: Likelihood
) -> float:
    """Log posterior of the scales of the discrepancy at given noise [nat]."""
    log_likelihood = likelihood.at(channel.change_scales(scales), scales.standing)
    return log_likelihood + channel.log_prior_of_scales(scales, rules)


def _searched(
    channel: Channel,
    scales: Scales,
    name: str,
    rules: InferenceRules,
    likelihood: Likelihood,
    steps: tuple[float, ...],
) -> Scales:
    """Scales with one of them at the maximum of the posterior."""

    def moved(value: float) -> Scales:
        changes: dict[str, Any] = {name: value}
        return replace(scales, **changes)

    lowest = 2 * ABSENT if name == "new" else -np.inf
    return moved(
        _climbed(
            lambda value: _score(channel, moved(value), rules, likelihood),
            float(getattr(scales, name)),
            lowest,
            steps,
        )
    )


def _climbed(
    score: Callable[[float], float], begin: float, lowest: float, steps: tuple[float, ...]
) -> float:
    """Where a function of one variable has a local maximum, by steps that shrink."""
    best, value = begin, score(begin)
    for step in steps:
        for _ in range(MOST_STEPS):
            for other in (best + step, max(best - step, lowest)):
                trial = score(other)
                if trial > value + 1e-9:
                    best, value = other, trial
                    break
            else:
                break
    return best
