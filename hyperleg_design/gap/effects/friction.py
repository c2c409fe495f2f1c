"""What effects of friction share: which way a joint slides, and friction in a simulation.

Near rest the sign of a velocity is noise, and friction at rest is whatever balances the torques, up
to its size. So the way of sliding is taken from the position: it turns over while the joint moves
`2 z`, as bristles bend (Prandtl's stop operator, the elastic-plastic limit of the Dahl and LuGre
models),

    s_i = clip(s_(i-1) + (q_i - q_(i-1)) / z, -1, 1),    way = clip(2 s, -1, 1),

where twice s, as noise alone never lets it stay at its ends. A joint that comes to rest keeps it:
right on ramps slower than the noise of the velocity, and in holds that a damped controller creeps
into; where a joint sticks while its controller pulls it the other way, nothing but the torque
itself tells the friction: such rest is in no balance, `holding` speaks of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar
from weakref import WeakKeyDictionary

import numpy as np

from hyperleg_design.gap.signals.chatter import PRESLIDING, sliding_share
from hyperleg_design.simulation.alteration import Alteration, Live, Tick, resistance

if TYPE_CHECKING:
    from hyperleg_design.gap.signals.signals import Signals

FRICTION = frozenset(
    {"coulomb_friction", "viscous_friction", "stribeck_friction", "load_dependent_friction"}
)
"""Effects of joints that rub."""
NOISES = 8.0
"""Least z over the noise of the smoothed position."""
WIDTH = 0.01
"""Velocity at which friction in a simulation has three quarters of its size [rad/s]; a sign,
softened below what logs resolve."""

_SLIDING: WeakKeyDictionary[Signals, np.ndarray] = WeakKeyDictionary()


def sliding(signals: Signals) -> np.ndarray:
    """Which way each joint slides, from -1 to 1 `(t, n)`; kept while `signals` live."""
    if signals not in _SLIDING:
        position = signals.position
        moved = np.diff(position, axis=0) / presliding(signals)
        out = np.empty_like(position)
        first = np.sign(
            np.where(
                np.abs(position - position[0]) > presliding(signals), position - position[0], 0.0
            )
        )
        start = np.argmax(first != 0, 0)
        state = first[start, np.arange(position.shape[1])]
        out[0] = state
        for tick, step in enumerate(moved, 1):
            state = out[tick]
            np.add(out[tick - 1], step, out=state)
            np.minimum(state, 1.0, out=state)
            np.maximum(state, -1.0, out=state)
        np.clip(2 * out, -1.0, 1.0, out=out)
        if signals.chatter is not None:
            swings = shaken(signals)
            out[swings] = sliding_share(
                signals.velocity[swings], WIDTH, signals.chatter.speed[swings]
            )
        out.setflags(write=False)
        _SLIDING[signals] = out
    return _SLIDING[signals]


def presliding(signals: Signals) -> np.ndarray:
    """Half the way of turning over, z, of each joint `(n,)` [rad]."""
    count = len(signals.subject.joints)
    if signals.noise is None or signals.bandwidth is None:
        return np.full(count, PRESLIDING)
    passed = np.sqrt(np.clip(2 * np.nan_to_num(signals.bandwidth) * signals.step, 0.0, 1.0))
    plain = 1.0 if signals.chatter is None else np.sqrt(1 - signals.chatter.share)
    return np.asarray(
        np.maximum(PRESLIDING, NOISES * np.nan_to_num(signals.noise) * plain * passed)
    )


def shaken(signals: Signals) -> np.ndarray:
    """Where chatter keeps a joint from sticking `(t, n)` of bool."""
    return (
        np.zeros(signals.position.shape, bool)
        if signals.chatter is None
        else np.asarray(signals.chatter.speed > 0)
    )


@dataclass(frozen=True, eq=False)
class JointFriction(Alteration):
    """Friction at a joint: (coulomb + breakaway exp(-(v/speed)^2) + share |torque|) sign(v) +
    viscous v, its sign softened.
    """

    joint: str
    coulomb: Any = 0.0
    viscous: Any = 0.0
    breakaway: Any = 0.0
    speed: Any = 1.0
    share: Any = 0.0
    """Of the torque that the motors give at the joint, less what turns their rotors; `()` or `(n,)`
    each [Nm, Nms/rad, Nm, rad/s, -]."""
    width: float = WIDTH
    """[rad/s]"""


class _Friction(Live):
    kept: ClassVar[tuple[str, ...]] = ("before", "begun")

    alteration: JointFriction

    def prepare(self) -> None:
        machine = self.machine
        self.place = machine.joint(self.alteration.joint)
        matrix, inertia = np.asarray(machine.joint_from_motor), np.asarray(machine.rigid_inertia)
        self.armature = np.einsum(
            "...k,...k,...lk->...l", matrix[..., self.place, :], inertia, matrix
        )
        self.before, self.begun = np.zeros((self.count, len(machine.joints))), np.zeros(self.count)

    def joint_damping(self, tick: Tick) -> np.ndarray:
        one, velocity = self.alteration, tick.velocity[:, self.place]
        size = one.coulomb + one.breakaway * np.exp(-((velocity / one.speed) ** 2))
        if np.any(one.share):
            size = size + one.share * np.abs(self._transmitted(tick))
        out = np.zeros_like(tick.velocity)
        out[:, self.place] = resistance(size, velocity, one.width) + one.viscous
        return out

    def _transmitted(self, tick: Tick) -> np.ndarray:
        """Torque that reaches the joint `(n,)` [Nm]: less what turned the rotors in the step
        before.
        """
        assert tick.joint_torque is not None
        acceleration = (tick.velocity - self.before) / self.step * self.begun[:, None]
        self.before[:], self.begun[:] = tick.velocity, 1.0
        return np.asarray(tick.joint_torque[:, self.place] - (self.armature * acceleration).sum(-1))


JointFriction.live = _Friction
