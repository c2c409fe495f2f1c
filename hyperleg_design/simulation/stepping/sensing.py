"""What sensors make of a motion on its way to the policy, where alterations change it."""

from __future__ import annotations

import numpy as np

from hyperleg_design.robot.models import GRAVITY
from hyperleg_design.simulation.drives.chain import Chain
from hyperleg_design.simulation.state import Motion, Sensed


def sensed(
    chain: Chain | None,
    motion: Motion,
    vertical: np.ndarray | None = None,
    ids: np.ndarray | None = None,
) -> Sensed | None:
    """Compute what encoders and IMU tell of a motion.

    Args:
        chain: drives and sensors as alterations make them; None without alterations.
        motion: true motion of some simulations.
        vertical: direction against gravity in the world `(3,)`; None for the world's z.
        ids: simulations that the rows of `motion` are of; None for all.

    Returns:
        The measured motion, a row for each of `motion`; None without alterations.
    """
    if chain is None:
        return None
    rows = slice(None) if ids is None else ids
    given = (
        motion.joint_position,
        motion.joint_velocity,
        motion.angular_velocity,
        motion.gravity if vertical is None else -(vertical @ motion.rotation),
    )
    whole = [np.zeros((chain.count, values.shape[-1])) for values in given]
    for place, values in zip(whole, given, strict=True):
        place[rows] = values
    position, velocity = chain.measured(*whole[:2])
    angular_velocity, force = chain.imu(whole[2], -GRAVITY * whole[3])
    down = -force[rows]
    return Sensed(
        angular_velocity[rows],
        down / np.linalg.norm(down, axis=-1, keepdims=True),
        position[rows],
        velocity[rows],
    )
