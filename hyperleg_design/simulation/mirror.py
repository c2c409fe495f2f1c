"""Left-right mirror of observations and actions, as index and sign arrays: mirrored = values[...,
index] * sign.

The axes of the right leg's yaw and roll joints mirror the left's, so mirroring swaps the legs and
keeps all joint signs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.simulation.layout import Layout
from hyperleg_design.simulation.observations import SCAN, columns


@dataclass(frozen=True, eq=False)
class MirrorMap:
    """A signed permutation that is its own inverse."""

    index: np.ndarray
    """Place that each number comes from, `(k,)`."""
    sign: np.ndarray
    """`(k,)`"""

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """Mirror image, `(..., k)`."""
        return values[..., self.index] * self.sign


def mirror_joints(layout: Layout) -> MirrorMap:
    """Of joint values and actions: the legs swapped."""
    return MirrorMap(_swapped(len(layout.joints)), np.ones(len(layout.joints), np.float32))


def mirror_observation(parts: Sequence[str], layout: Layout) -> MirrorMap:
    """Of an observation made of parts."""
    index, sign, start = [], [], 0
    for name, count, signs in columns(parts, layout):
        if signs:
            place, turned = np.arange(count), np.array(signs, np.float32)
        else:
            place = (
                np.arange(count).reshape(SCAN)[:, ::-1].ravel()
                if name == "height_scan"
                else _swapped(count)
            )
            turned = np.ones(count, np.float32)
        index.append(start + place)
        sign.append(turned)
        start += count
    return MirrorMap(np.concatenate(index), np.concatenate(sign).astype(np.float32))


def mirror_position(qpos: np.ndarray, qvel: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mirror image, in the plane y = 0, of MuJoCo states `(..., 7 + J)` and `(..., 6 + J)`."""
    position, velocity = qpos.copy(), qvel.copy()
    position[..., [1, 4, 6]] *= -1  # y; quaternion x and z
    velocity[..., [1, 3, 5]] *= -1
    position[..., 7:] = qpos[..., 7:][..., _swapped(qpos.shape[-1] - 7)]
    velocity[..., 6:] = qvel[..., 6:][..., _swapped(qvel.shape[-1] - 6)]
    return position, velocity


def _swapped(count: int) -> np.ndarray:
    return np.roll(np.arange(count), count // 2)
