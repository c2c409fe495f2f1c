"""Joint angles of human walking over the gait cycle, from touchdown to touchdown of the same foot.

They guide a training at its beginning: some episodes start in mid-stride, and a reward term draws
the robot toward the cycle. That term has no clock, because the nearest phase counts.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

PERIOD = 0.9
"""Duration of a stride of a person with legs of 0.79 m at 1.33 m/s [s]; assumed."""
PHASES = 50
"""Number of phases of the cycle that a state is compared with."""
ANGLE, RATE = 0.15, 3.0
"""Scales of the distance from the cycle [rad], [rad/s]; assumed."""
SHARES = tuple(100 * place / 12 for place in range(12))
"""Places of the knots in the cycle [%]."""
KNOTS: dict[str, tuple[float, ...]] = {
    "hip_pitch": (-20.5, -21.0, -15.3, -6.9, 4.5, 12.9, 19.0, 16.2, 5.1, -20.7, -30.9, -24.6),
    "knee": (3.3, 13.2, 16.0, 13.4, 4.9, 1.8, 5.3, 21.2, 39.1, 61.3, 40.8, 8.2),
    "ankle_pitch": (-3.4, 6.6, -1.2, -6.1, -9.9, -11.2, -10.8, -1.1, 24.7, 1.8, -0.7, -10.7),
}
"""Angles at `SHARES` [deg] in the robot's signs: hip extension, knee flexion and plantar flexion
positive. Derived by `benchmarks/human_cycle.py`: the curves nearest to adult level walking (Perry
and Burnfield, Gait Analysis, 2nd edition, 2010) with which the feet of this robot neither slip nor
float at `SPEED`. With the human angles as they are, its heel would still be 50 mm above the floor
at touchdown, and the standing foot would move at 1.18 m/s."""
SPEED = 1.33
"""Speed of the pelvis in this cycle [m/s]."""
SLOWER, FASTER = 0.8, 1.1
"""Shares of `SPEED` between which an episode that starts in mid-stride begins; assumed."""


@lru_cache
def cycle(joints: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray]:
    """The cycle of hip, knee and ankle pitch of both legs.

    Args:
        joints: names with the side in front, `(J,)`.

    Returns:
        Places of these joints among the given ones `(q,)`; their angles over `ANGLE` and rates
        over `RATE`, `(PHASES, 2 q)`.
    """
    from scipy.interpolate import CubicSpline

    share = np.arange(PHASES) / PHASES
    places, angles, rates = [], [], []
    for place, joint in enumerate(joints):
        side, name = joint.split("_", 1)
        if name not in KNOTS:
            continue
        closed = np.deg2rad(np.append(KNOTS[name], KNOTS[name][0]))
        curve = CubicSpline(np.append(SHARES, 100.0) / 100, closed, bc_type="periodic")
        phase = (share + (0.5 if side == "right" else 0.0)) % 1.0
        places.append(place)
        angles.append(curve(phase))
        rates.append(curve(phase, 1) / PERIOD)
    scaled = [np.array(angles).T / ANGLE, np.array(rates).T / RATE]
    return np.array(places), np.concatenate(scaled, 1)


def distance(joints: tuple[str, ...], position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Compute the distance of joint states from the nearest phase of the cycle.

    d^2 = min over phases of the mean over joints of ((q - q_h) / ANGLE)^2 and ((dq - dq_h) /
    RATE)^2.

    Args:
        joints: names with the side in front, `(J,)`.
        position: of the joints [rad], `(n, J)`.
        velocity: of the joints [rad/s], `(n, J)`.

    Returns:
        The distance [-], `(n,)`.
    """
    places, phases = cycle(joints)
    now = np.concatenate([position[:, places] / ANGLE, velocity[:, places] / RATE], 1)
    squared = (now**2).sum(1)[:, None] + (phases**2).sum(1) - 2.0 * now @ phases.T
    return np.sqrt(np.maximum(squared.min(1), 0.0) / now.shape[1])


def distance_at(
    joints: tuple[str, ...], position: np.ndarray, velocity: np.ndarray, phase: np.ndarray
) -> np.ndarray:
    """Compute the distance of joint states from the cycle at given phases, otherwise as `distance`.

    Args:
        joints: names with the side in front, `(J,)`.
        position: of the joints [rad], `(n, J)`.
        velocity: of the joints [rad/s], `(n, J)`.
        phase: of the cycle, 0 .. 1, `(n,)`.

    Returns:
        The distance [-], `(n,)`.
    """
    places, phases = cycle(joints)
    now = np.concatenate([position[:, places] / ANGLE, velocity[:, places] / RATE], 1)
    there = phases[np.rint(phase * PHASES).astype(int) % PHASES]
    return np.sqrt(np.mean((now - there) ** 2, 1))


def stride(
    joints: tuple[str, ...], drawn: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Draw states in the middle of a human stride, for episodes to start from.

    Args:
        joints: names with the side in front, `(J,)`.
        drawn: uniform numbers 0 .. 1, `(n, 2)`: phase and speed.

    Returns:
        Places of the joints of the cycle `(q,)`; their angles [rad] and rates [rad/s], `(n, q)`;
        speed of the pelvis [m/s], `(n,)`; phase of the cycle, 0 .. 1, `(n,)`.
    """
    places, phases = cycle(joints)
    index = np.minimum((drawn[:, 0] * PHASES).astype(int), PHASES - 1)
    chosen, count = phases[index], len(places)
    speed = SPEED * (SLOWER + (FASTER - SLOWER) * drawn[:, 1])
    return places, chosen[:, :count] * ANGLE, chosen[:, count:] * RATE, speed, index / PHASES
