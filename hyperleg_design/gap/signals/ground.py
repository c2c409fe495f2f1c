"""Residual of the ground: logged contact forces against those of the nominal ground at the logged
motion.

Each foot is judged by its whole force F, world frame, and by its pads:

    sliding                    tangential force -mu F_z v_t / |v_t|; of a pyramid of friction, between its sides and its edges
    sticking                   any tangential force within the cone mu F_z: the logged one, cut to the cone
    pressing                   F_z = sum over the pads below the floor of k(d) d + c(d) d', d the depth

v_t is the velocity of what the foot touches the ground with: a pad that rolls does not slide. Soft
contacts creep below the cone, in a simulation as in rubber, by F_t / c or less with c = b' i / (1 -
i) over a pad's inverse weight, and more for a moment after each jerk; a foot slides for sure where
its softest pad alone would be at the cone, away from where it lands and lifts off. k and c are those
of `nominal_ground`. The floor lies where the nominal ground bears the logged mean force, since no
log knows a floor to a tenth of a millimetre.

A base whose height nobody measured leaves the vertical rows unknown, one whose velocity nobody
measured knows no sliding. MuJoCo's contacts also resist acceleration, as a mass 1 / R would: that
is left out, as no log tells a foot's acceleration so well, and counts as doubt; vertical rows of a
standing foot are a few per cent of its load off by it, those of one that lands all.
"""  # noqa: E501

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from hyperleg_design.gap.model import pads
from hyperleg_design.gap.signals.contact import TOUCHING_FORCE
from hyperleg_design.gap.signals.nominal_ground import Law, nominal_ground
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.memoized import memoized

SLIDING = 0.05
"""Speed from which a foot may slide [m/s] (assumed: above what noise of encoders makes)."""
LANDING = 0.02
"""Time around ticks without load, in which speed and force of a foot change too fast to go together
[s] (assumed)."""
HEIGHT = 0.001
"""Height of a pad is known so well [m]: offsets of a leg's encoders, and of what tells where the
base is (assumed)."""
KEPT = 32
"""Results of `Footing.pressing` that are kept."""
HALVINGS = 34
"""Bisections of the range in which the height of the floor is sought: to a nanometre."""
LOADED = 10 * TOUCHING_FORCE
"""Force from which a foot is judged [N]; below, directions are noise (assumed)."""


@dataclass(frozen=True, eq=False)
class Footing:
    """One foot on its ground in a log of t ticks."""

    force: np.ndarray
    """Logged `(t, 3)` [N]; NaN where unknown."""
    slide: np.ndarray
    """Horizontal velocity of its loaded point `(t, 2)` [m/s]; NaN where unknown."""
    pad_force: np.ndarray
    """Logged on its p pads `(t, p, 3)` [N]; NaN where unknown."""
    pad_slide: np.ndarray
    """Horizontal velocity of their lowest points `(t, p, 2)` [m/s]; NaN where unknown."""
    height: np.ndarray
    """Of its p pads over the origin `(t, p)` [m]; NaN where unknown."""
    sink: np.ndarray
    """Rate at which they go down `(t, p)` [m/s]."""
    fall: np.ndarray
    """Rate of that `(t, p)` [m/s^2]."""
    friction: float
    """Nominal friction coefficient mu of the ground [-]."""
    law: Law
    """Contact law of its pads."""
    judged: np.ndarray
    """Ticks by whose mean force the floor is found `(t,)`."""
    settled: np.ndarray
    """Ticks with load all around `(t,)`."""
    known: dict[tuple[float, float], np.ndarray] = field(default_factory=dict)
    """What `pressing` found already; most of what asks differs in friction alone."""

    def pressing(self, spring: float, damper: float) -> np.ndarray:
        """Compute the vertical force of a ground at this motion, with the floor at the height at
        which it bears the mean of the logged forces.

        Args:
            spring: scale of k.
            damper: scale of c.

        Returns:
            The force [N], `(t,)`.
        """
        key = float(spring), float(damper)
        force = self.known.get(key)
        if force is None:
            force = self._pressing(*key)
            if len(self.known) < KEPT:
                self.known[key] = force
        return force

    def _pressing(self, spring: float, damper: float) -> np.ndarray:
        if not self.judged.any():
            return np.full(len(self.force), np.nan)
        return self.law.force(self._floor(spring, damper) - self.height, self.sink, spring, damper)

    def _floor(self, spring: float, damper: float) -> float:
        """Height at which the floor bears the mean of the logged forces [m]."""
        mean = float(self.force[self.judged, 2].mean())
        height = self.height[self.judged]
        sink = self.sink[self.judged]
        low, high = float(height.min()), float(height.max()) + 0.1
        for _ in range(HALVINGS):
            # bisection, as a higher floor bears more
            middle = (low + high) / 2
            if self.law.force(middle - height, sink, spring, damper).mean() < mean:
                low = middle
            else:
                high = middle
        return (low + high) / 2

    def doubt(self) -> np.ndarray:
        """Compute what the vertical force of a nominal ground leaves open, by the height and the
        acceleration of its pads.

        Returns:
            The force [N], `(t,)`.
        """
        if not self.judged.any():
            return np.zeros(len(self.force))
        floor = self._floor(1.0, 1.0)
        above, below = (
            self.law.force(floor + sign * HEIGHT - self.height, self.sink) for sign in (1, -1)
        )
        resisted = np.abs((self.law.mass(floor - self.height) * self.fall).sum(-1))
        return np.asarray(np.hypot((above - below) / 2, np.nan_to_num(resisted)))

    def ground(
        self, friction: np.ndarray, compliance: np.ndarray, damping: np.ndarray
    ) -> np.ndarray:
        """Compute the force of a ground with scaled properties at this motion.

        Args:
            friction: scale of mu `(k,)`.
            compliance: scale of 1 / k `(k,)`.
            damping: scale of the damping ratio c / (2 sqrt(k m)) `(k,)`.

        Returns:
            The force [N], `(k, t, 3)`.
        """
        normal = np.maximum(self.force[:, 2], 0.0)
        limit = friction[:, None] * self.friction * normal
        tangential = self.force[None, :, :2]
        size = np.linalg.norm(self.force[:, :2], axis=-1)
        cut = np.minimum(1.0, limit / np.maximum(size, 1e-9))[..., None] * tangential
        speed = np.linalg.norm(self.slide, axis=-1)
        along = self.slide / np.maximum(speed, 1e-9)[:, None]
        sliding = (
            self.settled & (speed > np.maximum(SLIDING, self.friction * normal / self.law.creep))
        )[:, None]
        slid = np.clip(size, self.law.weakest * limit, limit)
        tangential = np.where(sliding, -slid[..., None] * along, cut)
        pressing = np.stack(
            [self.pressing(1 / c, d / np.sqrt(c)) for c, d in zip(compliance, damping, strict=True)]
        )
        force = np.concatenate([tangential, pressing[..., None]], -1)
        return np.where(
            (normal > LOADED)[None, :, None],
            force,
            np.where(normal[None, :, None] <= 0, self.force[None], np.nan),
        )


@memoized
def footings(signals: Signals) -> tuple[Footing, ...]:
    """Collect every foot of a log with contact forces and a floating base.

    Args:
        signals: conditioned log.

    Returns:
        The feet.
    """
    from scipy.ndimage import minimum_filter1d

    subject, base = signals.subject, signals.base
    if signals.contact is None or base is None or not subject.pads:
        return ()
    relative = np.einsum(
        "tij,tpj->tpi", base.rotation, pads.pad_points(subject, signals.position, base.rotation)
    )
    points = base.position[:, None] + relative
    velocity = np.einsum("tij,tj->ti", base.rotation, base.linear_velocity)[:, None] + np.gradient(
        relative, signals.step, axis=0
    )
    velocity += pads.pad_rolling(subject, signals.position, base.rotation, signals.step)
    feet = []
    for index in range(len(subject.feet)):
        own = np.flatnonzero(subject.pad_foot == index)
        force = signals.contact[:, index]
        lowest = own[np.argmin(np.nan_to_num(relative[:, own, 2]), 1)]
        weight = _loads(signals, own, lowest)
        slide = np.einsum("tp,tpi->ti", weight, velocity[:, own, :2])
        height, sink = points[:, own, 2], -velocity[:, own, 2]
        friction, law = nominal_ground(
            subject, tuple(subject.tree.links[subject.pads[p].link] for p in own)
        )
        loaded = (
            np.isfinite(force[:, 2])
            & (np.nan_to_num(force[:, 2]) > LOADED)
            & np.isfinite(height).all(1)
            & signals.valid
        )
        span = 2 * max(round(LANDING / signals.step), 1) + 1
        settled = minimum_filter1d(np.nan_to_num(force[:, 2]) > LOADED, span)
        fall = np.gradient(sink, signals.step, axis=0)
        on_pads = (
            np.full((len(force), len(own), 3), np.nan)
            if signals.pad_force is None
            else signals.pad_force[:, own]
        )
        feet.append(
            Footing(
                force,
                slide,
                on_pads,
                velocity[:, own, :2],
                height,
                sink,
                fall,
                friction,
                law,
                loaded,
                settled,
            )
        )
    return tuple(feet)


def ground_residual(signals: Signals) -> np.ndarray | None:
    """Compute the logged minus the nominal force of the ground on each foot.

    Args:
        signals: conditioned log.

    Returns:
        The residual [N], `(t, 3 f)`, NaN where unknown; None without logged forces.
    """
    feet = footings(signals)
    if not feet:
        return None
    unscaled = np.ones(1)
    return np.concatenate(
        [foot.force - foot.ground(unscaled, unscaled, unscaled)[0] for foot in feet], 1
    )


def _loads(signals: Signals, own: np.ndarray, lowest: np.ndarray) -> np.ndarray:
    """Share of each of a foot's pads in its load `(t, p)`; all on the lowest where nobody measured
    it.
    """
    alone = (own[None, :] == lowest[:, None]).astype(float)
    if signals.pad_force is None:
        return alone
    load = np.maximum(np.nan_to_num(signals.pad_force[:, own, 2]), 0.0)
    total = load.sum(1, keepdims=True)
    return np.where(total > TOUCHING_FORCE, load / np.maximum(total, 1e-9), alone)
