"""Residual of the control: motor commands as logged against what the declared gains make of the
logged targets and state.

Only controllers of the declared form have this residual. Others (feed-forward, integral terms,
gravity compensation) ask for torques that gains do not explain.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from hyperleg_design.gap.model.subject import Subject

OTHERWISE = 0.1
"""Largest share of a command's variance that the declared form, with gains of any size, may leave
(assumed)."""
FEWEST = 100
"""Samples that it takes to tell."""
HELD = 1e-3
"""Distance from a motor's limit, over the limit, within which a command is held there [-]."""


def control_residual(
    subject: Subject,
    logged: np.ndarray,
    spring: np.ndarray,
    damper: np.ndarray,
    damper_of_rotors: np.ndarray | None = None,
) -> tuple[np.ndarray, tuple[str, ...]]:
    """Logged command minus the one of the declared gains `(s, m)` [Nm]; NaN where it is unknown, as
    where a command is held at the motor's limit.

    Args:
        subject: the robot, with the declared gains; m motors, n joints.
        logged: motor torque commands `(s, m)` [Nm], NaN where unknown.
        spring: stiffness (target - position) of the joints `(s, n)` [Nm].
        damper: -damping velocity of the joints `(s, n)` [Nm].
        damper_of_rotors: the same of the speeds that the rotors give the joints, NaN where unknown.
            Of a controller that damps rotors it leaves less.

    Returns:
        The residual, and the motors whose controllers have another form.
    """
    residual, others = np.full(logged.shape, np.nan), []
    for motor, name in enumerate(subject.motors):
        share = subject.motor_from_joint[motor]
        joints = np.flatnonzero(share)
        ways = [
            np.concatenate([spring[:, joints], own[:, joints]], 1) * np.tile(share[joints], 2)
            for own in (damper, damper_of_rotors)
            if own is not None
        ]
        terms = min(ways, key=partial(_leaves, logged[:, motor]))
        limit = float(subject.torque_limit[motor])
        held = np.abs(np.abs(logged[:, motor]) - limit) < HELD * limit
        known = np.isfinite(logged[:, motor]) & np.isfinite(terms).all(1) & ~held
        if known.sum() < FEWEST or not terms[known].any():
            continue
        centred = terms[known] - terms[known].mean(0)
        command = logged[known, motor] - logged[known, motor].mean()
        left = command - centred @ np.linalg.lstsq(centred, command, rcond=None)[0]
        if np.sum(left**2) > OTHERWISE * np.sum(command**2):
            others.append(name)
            continue
        residual[known, motor] = logged[known, motor] - terms[known].sum(1)
    return residual, tuple(others)


def _leaves(logged: np.ndarray, terms: np.ndarray) -> float:
    """Variance of a command that is left beside terms `(s, k)` [Nm^2]; infinite where these are not
    known.
    """
    left = logged - terms.sum(1)
    known = np.isfinite(left)
    return float(np.var(left[known])) if known.sum() >= FEWEST else np.inf
