"""Targets of the newcomer's quadruped: bodies that sway over standing feet, and feet that step."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from hyperleg_design.validation.newcomers.plant import rise

LEGS = ("FR", "FL", "RR", "RL")
"""Front and rear, right and left."""
HIP = np.array([[0.1805, -0.047], [0.1805, 0.047], [-0.1805, -0.047], [-0.1805, 0.047]])
"""Axes of the hips in the trunk, ahead and to the left `(4, 2)` [m]."""
SIDE = np.array([-1.0, 1.0, -1.0, 1.0])
OUT, LINK = 0.0838, 0.2
"""From hip to thigh sideways, and length of thigh and calf [m]."""
HEIGHT, SOLE = 0.29, 0.02
"""Of the trunk over the floor, and radius of a foot [m]."""
STANCE = np.column_stack([HIP[:, 0], HIP[:, 1] + SIDE * OUT])
"""Feet on the floor `(4, 2)` [m]."""
PERIOD, LIFT, LIFTED = 0.64, 0.045, 0.36
"""Of steps: time from one lift of a foot to its next [s], height [m], share of the period."""
SHIFT = 0.035
"""By which a trunk leans away from a foot that is lifted alone [m]."""


def joint_angles(feet: np.ndarray) -> np.ndarray:
    """Compute the joint angles that put feet at places in the trunk's frame.

    Args:
        feet: centres of the feet `(t, 4, 3)` [m].

    Returns:
        Hip, thigh and calf of each leg `(t, 12)` [rad].
    """
    from_hip = feet - np.column_stack([HIP, np.zeros(4)])
    x, y, z = from_hip[..., 0], from_hip[..., 1], from_hip[..., 2]
    down = np.sqrt(np.maximum(y**2 + z**2 - OUT**2, 1e-6))
    hip = np.arctan2(z, y) - np.arctan2(-down, SIDE * OUT)
    hip = (hip + np.pi) % (2 * np.pi) - np.pi
    length = np.minimum(np.hypot(x, down), 2 * LINK * 0.9999)
    calf = -2 * np.arccos(length / (2 * LINK))
    thigh = np.arctan2(-x, down) - calf / 2
    return np.stack([hip, thigh, calf], -1).reshape(len(feet), 12)


def targets(trunk: np.ndarray, feet: np.ndarray) -> np.ndarray:
    """Compute the joint targets of a motion of trunk and feet.

    Args:
        trunk: x, y, z [m], roll, pitch, yaw [rad] in the world `(t, 6)`.
        feet: centres of the feet in the world `(t, 4, 3)` [m].

    Returns:
        The targets `(t, 12)` [rad].
    """
    (sr, sp, sy), (cr, cp, cy) = np.sin(trunk[:, 3:].T), np.cos(trunk[:, 3:].T)
    rows = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    rotation = np.moveaxis(np.array(rows), -1, 0)
    return joint_angles(np.einsum("tji,tfj->tfi", rotation, feet - trunk[:, None, :3]))


def _standing(clock: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    trunk = np.zeros((len(clock), 6))
    trunk[:, 2] = HEIGHT
    feet = np.zeros((len(clock), 4, 3))
    feet[:, :, :2], feet[:, :, 2] = STANCE, SOLE
    return trunk, feet


def _waves(rng: np.random.Generator, clock: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Sums of three sines a coordinate `(t, 6)`, from rest."""
    out = np.zeros((len(clock), 6))
    for k in range(6):
        for (low, high), share in (((0.15, 0.3), 0.55), ((0.4, 0.8), 0.35), ((1.2, 1.9), 0.12)):
            phase = 2 * np.pi * rng.uniform(low, high) * clock + rng.uniform(0, 6.28)
            out[:, k] += size[k] * share * np.sin(phase)
    return out * rise(clock / 1.5)[:, None]


def _sway(rng: np.random.Generator, clock: np.ndarray) -> np.ndarray:
    """Sway in all directions, over feet that stand."""
    trunk, feet = _standing(clock)
    trunk += _waves(rng, clock, np.array([0.05, 0.045, 0.04, 0.16, 0.14, 0.16]))
    return targets(trunk, feet)


def _squat(rng: np.random.Generator, clock: np.ndarray) -> np.ndarray:
    """Squat and rise with rests, and lean to a side in each."""
    trunk, feet = _standing(clock)
    begin = 0.8
    while begin < clock[-1]:
        last, rest = rng.uniform(0.9, 1.6), rng.uniform(0.2, 0.6)
        phase = np.clip((clock - begin) / last, 0, 1)
        bump = 16 * phase**2 * (1 - phase) ** 2
        trunk[:, 2] -= rng.uniform(0.05, 0.11) * bump
        trunk[:, :2] += rng.uniform(-0.04, 0.04, 2) * bump[:, None]
        trunk[:, 3:] += rng.uniform(-0.12, 0.12, 3) * bump[:, None]
        begin += last + rest
    return targets(trunk, feet)


def _trot(rng: np.random.Generator, clock: np.ndarray) -> np.ndarray:
    """Step in place with the feet of a diagonal at once."""
    trunk, feet = _standing(clock)
    trunk += 0.2 * _waves(rng, clock, np.array([0.04, 0.03, 0.05, 0.08, 0.08, 0.2]))
    own = np.maximum(clock - 1.0, 0.0) / (PERIOD * rng.uniform(0.95, 1.1))
    for leg, begin in enumerate((0.0, 0.5, 0.5, 0.0)):
        phase = ((own - begin) % 1.0) / LIFTED
        lifted = (phase < 1) & (own > begin)
        feet[:, leg, 2] += LIFT * lifted * np.sin(np.pi * np.minimum(phase, 1.0)) ** 2
    return targets(trunk, feet)


def _crawl(rng: np.random.Generator, clock: np.ndarray) -> np.ndarray:
    """Lift one foot after another, with the trunk's weight on the other three."""
    trunk, feet = _standing(clock)
    trunk += 0.25 * _waves(rng, clock, np.array([0.03, 0.03, 0.04, 0.1, 0.1, 0.15]))
    begin, leg = 1.0, int(rng.integers(4))
    while begin < clock[-1]:
        lean = np.clip((clock - begin) / 1.1, 0, 1)
        bump = np.sin(np.pi * lean) ** 2
        trunk[:, :2] -= SHIFT * np.sign(STANCE[leg]) * bump[:, None] * np.array([1.0, 1.3])
        phase = np.clip((clock - begin - 0.35) / 0.4, 0, 1)
        feet[:, leg, 2] += rng.uniform(0.8, 1.3) * LIFT * np.sin(np.pi * phase) ** 2
        begin, leg = begin + 1.1, int((leg + rng.integers(1, 4)) % 4)
    return targets(trunk, feet)


MOTIONS: dict[str, Callable[[np.random.Generator, np.ndarray], np.ndarray]] = {
    "sway": _sway,
    "squat": _squat,
    "trot": _trot,
    "crawl": _crawl,
}
"""Targets `(t, 12)` [rad] at times `(t,)` [s]."""
