"""Joints that ring: above the frequencies of their motion their residuals are far larger than in
the references.

Play that knocks, a loose part and a control loop on the edge of its stability all do so. None of
them is noise, but what a log shows above its motion is taken for the noise of its sensors, in which
every fault is lost then.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hyperleg_design.gap.inference.white_noise import white_density
from hyperleg_design.gap.signals.filtering import FilteredLog


def ringing(
    tests: Sequence[FilteredLog], references: Sequence[FilteredLog], least: float
) -> dict[str, float]:
    """Find the joints that ring in a log under test and in no reference.

    Args:
        tests: logs under test.
        references: of the healthy robot; without any, no joint is named.
        least: density over that of the references from which a joint rings,
            `PosteriorRules.ringing` [-].

    Returns:
        By joint, how many times as large its residual of motion is above the frequencies of the
        motion, as a root mean square, in the loudest log as in the loudest reference, the loudest
        joint first.
    """
    quiet = [_densities(log) for log in references]
    loud = [_densities(log) for log in tests]
    over: dict[str, float] = {}
    for joint in loud[0]:
        own = max(density.get(joint, 0.0) for density in loud)
        before = max((density.get(joint, 0.0) for density in quiet), default=0.0)
        if before > 0 and own > least * before:
            over[joint] = float(np.sqrt(own / before))
    return dict(sorted(over.items(), key=lambda entry: -entry[1]))


def _densities(log: FilteredLog) -> dict[str, float]:
    """By joint, the density of its residual of motion above its cutoff [unit^2/Hz]."""
    densities = {}
    for row, mask in zip(log.rows, log.mask, strict=True):
        if row.residual_name == "motion":
            residual = log.signals.residual["motion"][:, row.column]
            values = np.where(mask, np.nan_to_num(residual), 0.0)
            densities[row.name] = white_density(values, mask, row.cutoff, log.signals.step)
    return densities
