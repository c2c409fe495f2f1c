"""The log that a newcomer writes of the quadruped."""

from __future__ import annotations

import numpy as np

from hyperleg_design.validation.benchmark.case import Recording
from hyperleg_design.validation.newcomers.quadruped_motion import LEGS
from hyperleg_design.validation.newcomers.recorded import recorded

JOINTS = tuple(f"{leg}_{part}_joint" for leg in LEGS for part in ("hip", "thigh", "calf"))
FEET = tuple(f"{leg}_foot" for leg in LEGS)
TORQUE_NOISE, CELL_NOISE = 0.03, 0.5
"""Of drives and load cells [Nm, N]."""
PLACE_NOISE, TURN_NOISE, MOVE_NOISE = 3e-4, 3e-4, 4e-3
"""Of the estimated base: place [m], orientation [rad], velocity [m/s]."""
GYRO_NOISE, FORCE_NOISE = 2e-3, 0.04
"""Of the IMU [rad/s, m/s^2]."""


def logged(
    table: np.ndarray,
    noise: np.random.Generator,
    label: str,
    stiffness: np.ndarray,
    damping: np.ndarray,
) -> Recording:
    """The log of a run, with the noise of its sensors.

    Args:
        table: a row a tick `(t, 89)`: time, targets, angles, speeds, commanded and given torques,
            base's place, orientation and velocity, gyro, accelerometer, forces on the feet.
        noise: source of randomness.
        label: name of the log.
        stiffness: of the controllers `(12,)` [Nm/rad].
        damping: of the controllers `(12,)` [Nms/rad].
    """
    widths = np.cumsum([1, 12, 12, 12, 12, 12, 3, 4, 3, 3, 3])
    (clock, target, read, speed, command, torque, place, turn, move, gyro, felt, cells) = np.split(
        table, widths, axis=1
    )

    def noisy(values: np.ndarray, size: float) -> np.ndarray:
        return values + size * noise.normal(size=values.shape)

    turn = noisy(turn, TURN_NOISE / 2)
    turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    motors = tuple(name.removesuffix("_joint") for name in JOINTS)
    blocks = (
        ("position_target", JOINTS, target),
        ("position", JOINTS, read),
        ("velocity", JOINTS, speed),
        ("motor_torque_command", motors, command),
        ("motor_torque", motors, noisy(torque, TORQUE_NOISE)),
        ("base_position", tuple("xyz"), noisy(place, PLACE_NOISE)),
        ("base_orientation", tuple("wxyz"), turn),
        ("base_velocity", tuple("xyz"), noisy(move, MOVE_NOISE)),
        ("gyro", tuple("xyz"), noisy(gyro, GYRO_NOISE)),
        ("accelerometer", tuple("xyz"), noisy(felt, FORCE_NOISE)),
        ("contact_force", tuple(f"{f}_{a}" for f in FEET for a in "xyz"), noisy(cells, CELL_NOISE)),
    )
    return recorded(label, clock[:, 0], blocks, JOINTS, stiffness, damping, base="floating")
