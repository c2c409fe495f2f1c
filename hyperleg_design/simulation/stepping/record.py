"""What happened in each simulation step of the last policy step."""

from __future__ import annotations

from collections.abc import Mapping

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

    def friction(self, motor_velocity: np.ndarray) -> np.ndarray:
        """Compute the friction at the joints in each substep.

        Args:
            motor_velocity: of the motors [rad/s], `(substeps, n, K)`.

        Returns:
            The torque, with what alterations add [Nm], `(substeps, n, J)`.
        """
        velocity = self.states[..., 13 + len(self.layout.joints) :]
        legs = (*velocity.shape[:2], len(self.layout.limbs), -1)
        torque = self.drive.friction(velocity.reshape(legs), motor_velocity.reshape(legs))
        torque = torque.reshape(velocity.shape)
        return torque if self.altered is None else torque + self.altered[:, 1]

    def forget(self, ids: np.ndarray) -> None:
        """Set what is kept of some simulations to zero.

        Args:
            ids: their indices.
        """
        for values in (self.states, self.stops):
            values[:, ids] = 0.0
        if self.told is not None:
            self.told.forget(ids)

    def samples(self) -> dict[str, np.ndarray]:
        """Collect what was kept in the last policy step.

        Returns:
            By name, `(substeps, n, ...)` each, not to be written into: `state`, `stop_torque`; with
            alterations also `altered_torque` and those of `told.Told`.
        """
        middle = (self.layout.lower + self.layout.upper) / 2
        position = self.states[..., 7 : 7 + len(self.layout.joints)]
        stops = np.where(position < middle, self.stops, -self.stops)
        samples = {"state": self.states, "stop_torque": stops}
        if self.told is None or self.altered is None:
            return samples
        return {**samples, "altered_torque": self.altered[:, 0].copy(), **self.told.signals}


def signals_of(
    samples: Mapping[str, np.ndarray], layout: Layout, joint_from_motor: np.ndarray
) -> dict[str, np.ndarray]:
    """Compute signals of base, joints, motors and pads from what was recorded.

    Args:
        samples: by name, as `Chunk.samples` gives them, `(t, ...)` each with the same axes after
            time; `joint_target` has one sample for each policy step.
        layout: of the simulations.
        joint_from_motor: M [-], `(..., joints, motors)` of one limb.

    Returns:
        Arrays by name, `(t, ...)` each, without `joint_friction`; see `Environment.signals`. Most
        are the samples themselves or views of them.
    """
    signals = dict(samples)
    state, driven = signals.pop("state"), signals.pop("altered_torque", None)
    target, torque, joints = samples["joint_target"], samples["motor_torque"], len(layout.joints)
    position, velocity = state[..., : 7 + joints], state[..., 7 + joints :]
    if driven is None:
        legs = torque.reshape(*torque.shape[:-1], len(layout.limbs), -1)
        driven = np.einsum("...jm,...m->...j", joint_from_motor, legs)
        driven = driven.reshape(position[..., 7:].shape)
    return signals | {
        "base_position": position[..., :3],
        "base_orientation": position[..., 3:7],
        "base_velocity": velocity[..., :3],
        "base_angular_velocity": velocity[..., 3:6],
        "joint_target": np.repeat(target, len(torque) // max(len(target), 1), 0),
        "joint_position": position[..., 7:],
        "joint_velocity": velocity[..., 6:],
        "driven_joint_torque": driven,
    }
