"""Encoders that are set to zero where their joints hang as a log begins.

Such encoders read 0 at the first tick of every log. Dry friction F holds joints that hang freely
anywhere around their balance where gravity's torque K q is less than it. With q even over that
range, the zeros of one log differ from those of another with the covariance K^-1 diag(F^2 / 3)
K^-T.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model import rigid
from hyperleg_design.gap.model.subject import Subject

AT_ZERO = 1e-3
"""Largest first reading of an encoder that was set to zero [rad] (assumed: a count or two)."""
APART = 1e-3
"""Step of the differences of gravity's torque [rad]."""
MOST = 0.1
"""Largest spread of a zero [rad] (assumed: who sets it looks at the joint)."""


def zero_spread(log: Log, subject: Subject) -> np.ndarray:
    """Compute how far the zeros of encoders that are set as a log begins are usually off.

    Args:
        log: as it was read.
        subject: the robot, with the dry friction of its joints.

    Returns:
        Standard deviations `(n,)` [rad]; 0 where the log begins elsewhere, where targets hold the
        joints, or where joints do not hang at zero.
    """
    count, coulomb = len(subject.joints), subject.coulomb
    start = log.stack("position", subject.joints)[0]
    held = any(log.has("position_target", joint) for joint in subject.joints)
    if subject.floating or held or not (np.abs(start) < AT_ZERO).all():
        return np.zeros(count)
    at = np.concatenate([np.zeros((1, count)), APART * np.eye(count)])
    gravity = rigid.inverse_dynamics(subject, at, np.zeros_like(at), np.zeros_like(at))
    stiffness = (gravity[1:] - gravity[0]).T / APART + np.diag(subject.spring)
    hangs = np.linalg.eigvalsh((stiffness + stiffness.T) / 2).min() > 0
    if not hangs or (np.abs(gravity[0]) > coulomb).any():
        return np.zeros(count)
    balance = np.linalg.inv(stiffness) * coulomb
    return np.minimum(np.sqrt(np.sum(balance**2, 1) / 3), MOST)
