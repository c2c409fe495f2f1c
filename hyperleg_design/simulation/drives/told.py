"""Signals that drives, encoders and an IMU report in a simulation with alterations, where they
differ from the true state.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hyperleg_design.simulation.drives.chain import Chain, Driven

TOLD = "told_"
"""Before the name of each signal."""


class Told:
    """Signals of one policy step of all simulations of a chain, `(substeps, n, ...)` each."""

    def __init__(self, chain: Chain, substeps: int) -> None:
        joints, motors = len(chain.machine.joints), len(chain.machine.motors)
        sizes = {
            "joint_position": joints,
            "joint_velocity": joints,
            "motor_command": motors,
            "motor_torque": motors,
        }
        sizes |= {"angular_velocity": 3, "acceleration_error": 3}
        self.chain = chain
        self.signals = {
            f"{TOLD}{name}": np.zeros((substeps, chain.count, size)) for name, size in sizes.items()
        }
        """Joint state as encoders tell it [rad, rad/s], motor torque that the controller asked for
        and that the drives take themselves to give [Nm], angular velocity by the gyro [rad/s], what
        the accelerometer adds to the truth [m/s^2]."""

    def keep(
        self,
        substep: int,
        driven: Driven,
        position: np.ndarray,
        velocity: np.ndarray,
        angular_velocity: np.ndarray,
    ) -> None:
        """Keep what drives, encoders and IMU measure in one simulation step.

        Args:
            substep: index within the policy step.
            driven: torques of this step.
            position: true, of the joints [rad], `(n, J)`.
            velocity: true, of the joints [rad/s], `(n, J)`.
            angular_velocity: true, of the base in its frame [rad/s], `(n, 3)`.
        """
        assert driven.command is not None
        turning, added = self.chain.imu(angular_velocity, np.zeros_like(angular_velocity))
        said = (
            *self.chain.measured(position, velocity),
            driven.command,
            driven.believed,
            turning,
            added,
        )
        for stored, values in zip(self.signals.values(), said, strict=True):
            stored[substep] = values

    def forget(self, simulations: Sequence[int] | np.ndarray) -> None:
        """Set what some simulations measured to zero.

        Args:
            simulations: their indices.
        """
        for values in self.signals.values():
            values[:, simulations] = 0.0
