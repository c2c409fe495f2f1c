"""How much drives feel of fast accelerations, and how far they answer to what pushes a joint."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.effects.placing import is_measured
from hyperleg_design.gap.inference import noise_model
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


def answering(filtered_log: FilteredLog, row: int) -> dict[int, float]:
    """Share of a torque on a joint that its controller answers with, by band.

    A position controller gives whatever torque is needed only while it holds the joint: below the
    frequency at which its stiffness moves the joint's inertia. Above, the joint moves instead, and
    the torque is what the targets make it. With C = K + i w D and Z = -J w^2 the share is that of
    C / (C + Z); J is the model's inertia, or what torques and accelerations of the log show, which
    holds rotors that a file leaves out.

    Args:
        filtered_log: of one log.
        row: one of its rows.

    Returns:
        From 0 to 1 by index of the band; 1 where torques are measured, and of rows that are no
        joints.
    """
    signals, one = filtered_log.signals, filtered_log.rows[row]
    subject, bands = signals.subject, filtered_log.bands[row]
    gains = subject.gains[one.column]
    driven = np.flatnonzero(subject.joint_from_motor[one.column])
    if (
        one.residual_name != "motion"
        or signals.target is None
        or not np.isfinite(gains).all()
        or any(is_measured(signals, motor) for motor in driven.tolist())
    ):
        return {band.index: 1.0 for band in bands}
    mask = filtered_log.mask[row]
    acceleration = signals.acceleration[mask, one.column]
    given = signals.believed[mask] @ subject.joint_from_motor[one.column]
    shown = float(acceleration @ given) / max(float(acceleration @ acceleration), 1e-300)
    own = noise_model.inertias_at(signals, one.column)[:, one.column]
    inertia = max(float(np.mean(own)), shown)
    share = {}
    for band in bands:
        omega = 2 * np.pi * np.linspace(band.low, band.high, 9)
        control = gains[0] + 1j * omega * gains[1]
        answer = np.real(control / (control - inertia * omega**2))
        share[band.index] = float(np.mean(np.clip(answer, 0.0, 1.0)))
    return share
