"""Left-right mirror of observations and actions, as index and sign arrays: mirrored = values[...,
index] * sign.

Which joints and feet are images of each other is data of the robot's layout (`symmetry`). The axes
of HyperLeg's right leg mirror the left's, so its mirror swaps the legs and keeps all joint signs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.simulation.layout import Layout
from hyperleg_design.simulation.terms.observations import SCAN, columns


@dataclass(frozen=True, eq=False)
class MirrorMap:
    """A signed permutation that is its own inverse."""

    index: np.ndarray
    """Place that each number comes from, `(k,)`."""
    sign: np.ndarray
    """Sign of each entry in the mirror, `(k,)`."""

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """Mirror image, `(..., k)`."""
        return values[..., self.index] * self.sign


def mirror_joints(layout: Layout) -> MirrorMap:
    """Describe how joint values and actions are mirrored.

    Args:
        layout: of the robot.

    Returns:
        Indices and signs.

    Raises:
        InputError: the robot is not its own mirror image.
    """
    if not layout.mirror_joints:
        raise InputError(
            "mirror",
            "joints",
            None,
            "robot or default posture is not symmetric about the plane y = 0; set algorithm.mirror "
            "of the preset to never",
        )
    places, signs = zip(*layout.mirror_joints, strict=True)
    return MirrorMap(np.array(places), np.array(signs, np.float32))


def mirror_observation(parts: Sequence[str], layout: Layout) -> MirrorMap:
    """Describe how an observation is mirrored.

    Args:
        parts: of the observation, by name.
        layout: of the robot.

    Returns:
        Indices and signs.
    """
    index, sign, start, joints = [], [], 0, mirror_joints(layout)
    for name, count, signs in columns(parts, layout):
        turned = np.array(signs, np.float32) if signs else np.ones(count, np.float32)
        if signs:
            place = np.arange(count)
        elif name == "height_scan":
            place = np.arange(count).reshape(SCAN)[:, ::-1].ravel()
        elif name == "foot_load":
            place = np.array(layout.mirror_feet, int)
        else:
            place, turned = joints.index, joints.sign
        index.append(start + place)
        sign.append(turned)
        start += count
    return MirrorMap(np.concatenate(index), np.concatenate(sign).astype(np.float32))
