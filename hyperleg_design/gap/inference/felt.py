"""How much drives feel of fast accelerations."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.signals.filtering import FilteredLog

SLOWEST_BANDS = 3
"""Bands of a channel whose load sizes its discrepancy: in faster ones it is mostly noise."""


def felt_share(filtered_log: FilteredLog, row: int) -> np.ndarray:
    """Share of the torque that fast motion needs which the drives' torque shows: what sensors or
    belts add to accelerations, no motor feels.

    Args:
        filtered_log: of one log.
        row: one of its rows.

    Returns:
        By sample, from 0 to 1, the same all over a band `(samples,)`; 1 of slow bands and of rows
        that are no joints.
    """
    signals, one = filtered_log.signals, filtered_log.rows[row]
    band = filtered_log.labels(row)[0]
    share = np.ones(len(band))
    if one.residual_name != "motion":
        return share
    columns = signals.rigid[:, one.column], signals.residual["motion"][:, one.column]
    needed, left = filtered_log.sample(row, np.stack(columns))
    for fast in np.unique(band[band >= SLOWEST_BANDS]).tolist():
        mine = band == fast
        square = max(float(needed[mine] @ needed[mine]), 1e-300)
        share[mine] = np.clip(1 + float(left[mine] @ needed[mine]) / square, 0.0, 1.0)
    return share
