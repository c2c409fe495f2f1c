"""Posterior of the discrepancy of one residual channel."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.inference.channels.channel import Channel
from hyperleg_design.gap.inference.channels.residual import Residual
from hyperleg_design.gap.inference.channels.scales import Scales


def discrepancy_posterior(
    channel: Channel, scales: Scales, residual: Residual | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Compute the posterior of w + delta_s, the coefficients of the discrepancy in each session.

    Args:
        channel: of the evidence.
        scales: hyperparameters.
        residual: the channel's whole residual by default.

    Returns:
        Means `(sessions, k)` and covariances `(sessions, k, k)`.
    """
    residual = channel.whole_residual if residual is None else residual
    spectrum, change = channel.spectrum(scales.noise), channel.change_scales(scales)
    axes, own = spectrum.axes, slice(channel.steady, None)
    cross = channel.summed(scales.noise, residual.cross)[:, :, None]
    turned = spectrum.turned(cross)
    inverse = np.linalg.inv(spectrum.factor(change, scales.standing))
    standing = spectrum.standing_scales(scales.standing)
    shared = standing[:, None] * (inverse.T @ inverse) * standing
    mean = shared @ spectrum.left(change, cross, turned)
    across = spectrum.beside.swapaxes(1, 2)
    gained = axes * (change[:, None] ** 2 * spectrum.shrunk(change))[:, None, :]
    means = np.repeat(mean.T, len(change), 0)
    means[:, own] += (gained @ (turned - across @ mean))[:, :, 0]
    # the covariance of w + delta is that of the change, given w, and of what w alone moves
    left = np.repeat(np.eye(channel.columns)[None], len(change), 0)
    left[:, own] -= gained @ across
    covariances = left @ shared @ left.swapaxes(1, 2)
    covariances[:, own, own] += gained @ axes.swapaxes(1, 2)
    return means, covariances
