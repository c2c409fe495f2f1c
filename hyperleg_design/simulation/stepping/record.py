"""What happened in each simulation step of the last policy step."""

from __future__ import annotations

import numpy as np

from hyperleg_design.simulation.drives.actuation import applied
from hyperleg_design.simulation.drives.drive import Drive
from hyperleg_design.simulation.drives.told import Told
from hyperleg_design.simulation.layout import Layout


class Record:
    """Motion, stops and altered torques of n simulations at each substep of a policy step.

    Args:
        drive: of the simulations; its positions and velocities are read.
        layout: of the simulations.
        substeps: simulation steps in a policy step.
    """

    def __init__(self, drive: Drive, layout: Layout, substeps: int) -> None:
        self.drive, self.layout = drive, layout
        count, joints = len(drive.qpos), len(layout.joints)
        self.states = np.zeros((substeps, count, 13 + 2 * joints))
        """MuJoCo's position and velocity before each substep."""
        self.stops = np.zeros((substeps, count, joints))
        """Size of the stops' torque at each joint in each substep [Nm]."""
        self.altered = None if drive.chain is None else np.zeros((substeps, 2, count, joints))
        """Torque through the transmission and friction that alterations make of them [Nm]."""
        self.told = None if drive.chain is None else Told(drive.chain, substeps)

    def keep_state(self, substep: int) -> None:
        """Keep positions and velocities as they are before a substep.

        Args:
            substep: index within the policy step.
        """
        joints = len(self.layout.joints)
        self.states[substep, :, : 7 + joints] = self.drive.qpos
        self.states[substep, :, 7 + joints :] = self.drive.qvel

    def keep_altered(self, substep: int) -> None:
        """Keep the torques that alterations make of the drives', and what is measured of them;
        nothing without alterations.

        Args:
            substep: index within the policy step, whose torques have been applied.
        """
        if self.told is None or self.altered is None:
            return
        driven = self.drive.driven
        assert driven is not None
        matrix, velocity, altered = (
            self.told.chain.machine.joint_from_motor,
            self.drive.qvel[:, 6:],
            self.altered[substep],
        )
        self.told.keep(substep, driven, self.drive.qpos[:, 7:], velocity, self.drive.qvel[:, 3:6])
        altered[0], altered[1] = applied(matrix, driven.transmitted), 0.0
        if driven.joint_damping is not None:
            altered[1] = driven.joint_damping * velocity
        if driven.motor_damping is not None:
            altered[1] += applied(
                matrix, driven.motor_damping * applied(np.swapaxes(matrix, -1, -2), velocity)
            )

    def forget(self, ids: np.ndarray) -> None:
        """Set what is kept of some simulations to zero.

        Args:
            ids: their indices.
        """
        for values in (self.states, self.stops):
            values[:, ids] = 0.0
        if self.told is not None:
            self.told.forget(ids)

    def signals(
        self, motor_torque: np.ndarray, motor_velocity: np.ndarray, *, friction: bool
    ) -> dict[str, np.ndarray]:
        """Collect the signals of base, joints and alterations; see `Environment.signals`.

        Args:
            motor_torque: of the motors in each substep, `(substeps, n, motors)` [Nm].
            motor_velocity: of the same, `(substeps, n, motors)` [rad/s].
            friction: also `joint_friction`, which must be computed anew.

        Returns:
            Arrays by name, `(substeps, n, ...)` each.
        """
        joints = len(self.layout.joints)
        substeps, count = self.stops.shape[:2]
        position, velocity = self.states[..., : 7 + joints], self.states[..., 7 + joints :]
        legs = (substeps, count, len(self.layout.limbs), -1)
        matrix = self.drive.model.joint_from_motor
        torque = np.einsum("...jm,...m->...j", matrix, motor_torque.reshape(legs))
        signals = {"driven_joint_torque": torque.reshape(substeps, count, -1)}
        if self.altered is not None:
            signals["driven_joint_torque"] = self.altered[:, 0].copy()
        if friction:
            resistance = self.drive.friction(
                velocity[..., 6:].reshape(legs), motor_velocity.reshape(legs)
            ).reshape(substeps, count, -1)
            signals["joint_friction"] = (
                resistance if self.altered is None else resistance + self.altered[:, 1]
            )
        signals |= {
            "base_position": position[..., :3],
            "base_orientation": position[..., 3:7],
            "base_velocity": velocity[..., :3],
            "base_angular_velocity": velocity[..., 3:6],
            "joint_position": position[..., 7:],
            "joint_velocity": velocity[..., 6:],
            "stop_torque": self._stop_torque(position[..., 7:]),
        }
        return signals if self.told is None else signals | self.told.signals

    def _stop_torque(self, position: np.ndarray) -> np.ndarray:
        """Torque of the stops on the joints, toward the middle of the range of motion [Nm],
        `(substeps, n, J)`.
        """
        middle = (self.layout.lower + self.layout.upper) / 2
        return np.where(position < middle, self.stops, -self.stops)
