"""Motor envelopes: which torque a motor can give at which speed, in all four quadrants.

A motor behind a driver is bounded by its peak torque and by the bus voltage, which draws a line
through stall torque and no-load speed (Eq. (4) of the paper, the DC-motor clip of Isaac Lab):

    upper = clip(stall (1 - w / w0), -peak, peak)        lower = clip(-stall (1 + w / w0), -peak, peak)

Up to no-load speed zero torque lies between the two. Past it the back-EMF exceeds the bus voltage
and drives a braking current through the driver, so `upper` is negative: the motor brakes at least
that much, up to its peak torque. There the interval shrinks to the point -peak (at w0 (1 + peak /
stall)) and never turns inside out.
"""  # noqa: E501

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.robot.motors import motor_arrays
from hyperleg_design.robot.transmission import motor_names

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign


@dataclass(frozen=True, eq=False)
class MotorEnvelope:
    """Limits of the motors of one leg, `(..., motors)` each, and of the drivers."""

    no_load_speed: np.ndarray
    """No-load speed at the bus voltage, w0 [rad/s]."""
    stall_torque: np.ndarray
    """Where the voltage line meets zero speed, w0 / Cp [Nm]."""
    peak_torque: np.ndarray
    """Largest torque at any speed [Nm]; a motor whose stall torque is smaller reaches it only where
    it brakes."""
    power_constant: np.ndarray
    """Joule heat over squared torque, Cp [W/Nm^2]."""
    efficiency_out: Any
    """Efficiency of the driver from battery to motor [-], `()` or the batch."""
    efficiency_regen: Any
    """Efficiency of the driver from motor to battery [-], `()` or the batch."""

    @property
    def standstill_torque(self) -> np.ndarray:
        """Largest torque at standstill [Nm], `(..., motors)`: peak or stall torque, the smaller."""
        return torque_limits(self, 0.0)[1]

    @property
    def corner_speed(self) -> np.ndarray:
        """Speed up to which the peak torque is there [rad/s], `(..., motors)`; 0 where the voltage
        line never reaches it.
        """
        return np.maximum(0.0, self.no_load_speed * (1 - self.peak_torque / self.stall_torque))

    @property
    def top_speed(self) -> np.ndarray:
        """Speed from which even full braking current is less than the back-EMF drives [rad/s],
        `(..., motors)`.
        """
        return self.no_load_speed * (1 + self.peak_torque / self.stall_torque)

    def select(self, motors: slice | list[int]) -> MotorEnvelope:
        """Select the envelope of some of the motors.

        Args:
            motors: their indices.

        Returns:
            The smaller envelope.
        """
        return dataclasses.replace(
            self,
            no_load_speed=self.no_load_speed[..., motors],
            stall_torque=self.stall_torque[..., motors],
            peak_torque=self.peak_torque[..., motors],
            power_constant=self.power_constant[..., motors],
        )


def motor_envelope(design: RobotDesign) -> MotorEnvelope:
    """Envelope of the installed motors of one leg, a robot's `(motors,)` or a batch's `(n,
    motors)`.

    Args:
        design: a robot, or a batch of `n` robots.

    Returns:
        Limits in the torque-speed plane of each motor, at the rotor, gears not included.
    """
    arrays = motor_arrays(design)
    installed = slice(len(motor_names(design)))
    return MotorEnvelope(
        no_load_speed=arrays.no_load_speed[..., installed],
        stall_torque=arrays.stall_torque[..., installed],
        peak_torque=arrays.peak_torque[..., installed],
        power_constant=arrays.power_constant[..., installed],
        efficiency_out=design.electrical_section.efficiency_out,
        efficiency_regen=design.electrical_section.efficiency_regen,
    )


def torque_limits(
    envelope: MotorEnvelope, motor_velocity: np.ndarray | float
) -> tuple[np.ndarray, np.ndarray]:
    """Least and largest torque of each motor at its speed [Nm].

    Args:
        envelope: limits, `(..., motors)`.
        motor_velocity: signed speeds [rad/s], `(..., motors)`, broadcast against the envelope.

    Returns:
        `(lower, upper)`, each `(..., motors)`, with -peak <= lower <= upper <= peak at every speed.
    """
    slowing = np.asarray(motor_velocity, float) / envelope.no_load_speed
    peak, stall = envelope.peak_torque, envelope.stall_torque
    return np.clip(-stall * (1 + slowing), -peak, peak), np.clip(stall * (1 - slowing), -peak, peak)


def clip_torque(
    envelope: MotorEnvelope, motor_torque: np.ndarray, motor_velocity: np.ndarray | float
) -> np.ndarray:
    """Bring torques inside the envelope at the motors' speeds.

    Args:
        envelope: of the motors.
        motor_torque: as wanted [Nm], `(..., motors)`.
        motor_velocity: [rad/s], `(..., motors)`.

    Returns:
        The clipped torques [Nm], `(..., motors)`.
    """
    lower, upper = torque_limits(envelope, motor_velocity)
    return np.clip(motor_torque, lower, upper)
