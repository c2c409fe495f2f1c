"""Which way joints slide.

Near rest the sign of a velocity is noise, and friction at rest is whatever residuals the torques,
up to its size. So the way of sliding is taken from the position: it turns over while the joint
moves `2 z`, as bristles bend (Prandtl's stop operator, the elastic-plastic limit of the Dahl and
LuGre models),

    s_i = clip(s_(i-1) + (q_i - q_(i-1)) / z, -1, 1),    way = clip(2 s, -1, 1),

where twice s, as noise alone never lets it stay at its ends. A joint that comes to rest keeps it:
right on ramps slower than the noise of the velocity, and in holds that a damped controller creeps
into; where a joint sticks while its controller pulls it the other way, nothing but the torque
itself tells the friction: such rest is in no residual, `holding` speaks of it.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.model.friction import sliding_share
from hyperleg_design.gap.model.memoized import memoized
from hyperleg_design.gap.signals.limit_cycle import PRESLIDING
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.stop_operator import stop

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
    way of sliding explains most of it beside a rotor that the model lacks.

    Args:
        signals: conditioned log.

    Returns:
        [Nm], `(n,)`.
    """
    residual = signals.residual["motion"]
    known = signals.valid[:, None] & np.isfinite(residual)
    columns = sliding(signals), residual, signals.acceleration
    way, left, fast = (np.where(known, np.nan_to_num(column), 0.0) for column in columns)
    square = np.maximum(np.sum(fast**2, 0), 1e-300)
    way, left = (each - fast * np.sum(fast * each, 0) / square for each in (way, left))
    along, ways, whole = (np.sum(x, 0) for x in (way * left, way**2, left**2))
    shown = np.divide(along, ways, out=np.zeros_like(along), where=ways > 0)
    shown[along**2 < MOST * ways * whole] = 0.0
    coulomb = signals.subject.coulomb
    return np.asarray(np.where(coulomb > 0, coulomb, np.maximum(shown, 0.0)))


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
