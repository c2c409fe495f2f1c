"""Which way joints slide.

Near rest the sign of a velocity is noise, and friction at rest is whatever residuals the torques,
up to its size. So the way of sliding is taken from the position: it turns over while the joint
moves `2 z`, as bristles bend (Prandtl's stop operator, the elastic-plastic limit of the Dahl and
LuGre models),

    s_i = clip(s_(i-1) + (q_i - q_(i-1)) / z, -1, 1),    way = clip(2 s, -1, 1),

where twice s, as noise alone never lets it stay at its ends. A joint that comes to rest keeps it:
right on ramps slower than the noise of the velocity, and in holds that a damped controller creeps
into. Where a joint sticks while its controller pulls it the other way, only the torque tells the
friction, and residuals leave such rest out.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.model.friction import sliding_share, stop
from hyperleg_design.gap.signals.limit_cycle import PRESLIDING
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.memoized import memoized

NOISES = 8.0
"""Least z over the noise of the smoothed position."""
MOST = 0.5
"""Share of a residual, squared, from which it is mostly friction [-]."""
WIDTH = 0.01
"""Velocity at which friction in a simulation has three quarters of its size [rad/s]; a sign,
softened below what logs resolve."""


@memoized
def sliding(signals: Signals) -> np.ndarray:
    """Compute which way each joint slides.

    Args:
        signals: conditioned log.

    Returns:
        -1 .. 1, `(t, n)`.
    """
    ways = zip(signals.position.T, presliding(signals).tolist(), strict=True)
    out = np.clip(2 * np.stack([stop(position, way) for position, way in ways], -1), -1.0, 1.0)
    if signals.limit_cycle is not None:
        swings = shaken(signals)
        out[swings] = sliding_share(
            signals.velocity[swings], WIDTH, signals.limit_cycle.speed[swings]
        )
    out.setflags(write=False)
    return out


@memoized
def dry_friction(signals: Signals) -> np.ndarray:
    """Dry friction of each joint: the model's; where it has none, what the residual shows, if the
    way of sliding explains most of it beside functions of posture and acceleration, so that a load
    or a rotor that the model lacks does not hide it.

    Args:
        signals: conditioned log.

    Returns:
        [Nm], `(n,)`.
    """
    friction = signals.subject.coulomb.copy()
    for joint in np.flatnonzero(friction == 0).tolist():
        way, _, residual = _beside_posture(signals, joint)
        friction[joint] = _shown(way[:, None], residual)[0]
    return friction


def dry_friction_in(signals: Signals, residual_name: str) -> np.ndarray:
    """Dry friction that acts in each row of a residual: in the motion, or of joints whose torque is
    measured behind the gear in the drive.

    Args:
        signals: conditioned log.
        residual_name: such as `motion`.

    Returns:
        [Nm], `(rows,)`; 0 in other residuals.
    """
    behind = signals.behind_gears
    if residual_name == "motion":
        friction = dry_friction(signals)
        return friction if behind is None else np.where(behind, 0.0, friction)
    if residual_name == "drive" and behind is not None:
        share = np.abs(signals.subject.motor_from_joint)
        return np.asarray(share @ np.where(behind, dry_friction(signals), 0.0))
    return np.zeros(signals.residual[residual_name].shape[1])


@memoized
def viscous_friction(signals: Signals) -> np.ndarray:
    """Viscous friction of each joint: the model's; where it has none, what the residual shows
    beside `dry_friction`, likewise.

    Args:
        signals: conditioned log.

    Returns:
        [Nms/rad], `(n,)`.
    """
    friction = signals.subject.viscous.copy()
    for joint in np.flatnonzero(friction == 0).tolist():
        *causes, residual = _beside_posture(signals, joint)
        friction[joint] = _shown(np.stack(causes, 1), residual)[1]
    return friction


@memoized
def _beside_posture(signals: Signals, joint: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Way of sliding, velocity, and the residual of a joint at known ticks, without functions of
    posture, load and acceleration `(t,)` each.
    """
    angles, residual = np.nan_to_num(signals.position), signals.resisting[:, joint]
    known = signals.valid & np.isfinite(residual)
    own = signals.acceleration[:, joint], signals.rigid[:, joint]
    posture = [np.ones((len(angles), 1)), np.sin(angles), np.cos(angles)]
    beside = np.nan_to_num(np.concatenate([*posture, np.stack(own, 1)], 1)[known])
    rows = sliding(signals)[:, joint], np.nan_to_num(signals.velocity[:, joint]), residual
    left = np.stack(rows, 1)[known]
    left -= beside @ np.linalg.lstsq(beside, left, rcond=None)[0]
    return left[:, 0], left[:, 1], left[:, 2]


def _shown(causes: np.ndarray, residual: np.ndarray) -> np.ndarray:
    """Sizes at which functions `(t, k)` explain a residual `(t,)`, at least 0; 0 where they do not
    explain most of it.
    """
    size = np.linalg.lstsq(causes, residual, rcond=None)[0]
    explained = causes @ size
    if explained @ explained < MOST * (residual @ residual):
        return np.zeros(len(size))
    return np.maximum(size, 0.0)


def presliding(signals: Signals) -> np.ndarray:
    """Compute half the way over which the friction of each joint turns over, z.

    Args:
        signals: conditioned log.

    Returns:
        z [rad], `(n,)`.
    """
    count = len(signals.subject.joints)
    if signals.noise is None or signals.bandwidth is None:
        return np.full(count, PRESLIDING)
    passed = np.sqrt(np.clip(2 * np.nan_to_num(signals.bandwidth) * signals.step, 0.0, 1.0))
    plain = 1.0 if signals.limit_cycle is None else np.sqrt(1 - signals.limit_cycle.share)
    return np.asarray(
        np.maximum(PRESLIDING, NOISES * np.nan_to_num(signals.noise) * plain * passed)
    )


def shaken(signals: Signals) -> np.ndarray:
    """Find where a limit cycle keeps a joint from sticking.

    Args:
        signals: conditioned log.

    Returns:
        `(t, n)`.
    """
    if signals.limit_cycle is None:
        return np.zeros(signals.position.shape, bool)
    return np.asarray(signals.limit_cycle.speed > 0)
