"""Where the electrical energy goes: a ledger from the battery through drivers and windings to the
joints.

At each motor, with torque tau, speed w and power constant Cp (paper, Eq. (5)):

    joule = Cp tau^2        mechanical = tau w        electrical = joule + mechanical        (motor side, the paper's)
    battery = electrical / efficiency_out     where the motor draws  (electrical > 0)
    battery = electrical * efficiency_regen   where it gives back    (electrical < 0)
    driver_loss = battery - electrical >= 0

Table III of the paper adds up on the motor side, without driver efficiencies; Table I prints these.
Both sides are kept here. Every motor has its own driver, and the drivers share one direct-current
bus, so what one gives back another may
draw: sums over motors are taken after the efficiencies. Samples hold for one time step, so energy
    is power times the step.
"""  # noqa: E501

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.models import GRAVITY


@dataclass(frozen=True, eq=False)
class EnergyLedger:
    """Powers [W] of every motor over time, or, after `energy`, `total` and the like, what is left
    of these axes.
    """

    time_step: float
    """Time between two samples [s]."""
    joule: np.ndarray
    """Heat of the windings, `(..., t, m)`."""
    mechanical: np.ndarray
    """Given to the joints, negative where a motor brakes, `(..., t, m)`."""
    driver_loss: np.ndarray
    """Heat of the drivers, `(..., t, m)`."""
    drawn: np.ndarray
    """Power that driving motors draw from the battery [W], `(..., t, m)`, not negative."""
    returned: np.ndarray
    """Power that braking motors return to the battery [W], `(..., t, m)`, not negative."""

    @property
    def mechanical_positive(self) -> np.ndarray:
        """Power of motors that drive, `(..., t, m)` [W]."""
        return np.maximum(self.mechanical, 0.0)

    @property
    def mechanical_negative(self) -> np.ndarray:
        """Power of motors that brake, `(..., t, m)` [W], not positive."""
        return np.minimum(self.mechanical, 0.0)

    @property
    def motor_side(self) -> np.ndarray:
        """Joule heat and signed mechanical power, the paper's total, `(..., t, m)` [W]."""
        return self.joule + self.mechanical

    @property
    def battery(self) -> np.ndarray:
        """Drawn less returned, `(..., t, m)` [W]."""
        return self.drawn - self.returned

    @property
    def duration(self) -> float:
        """Duration of the motion [s]."""
        return self.time_step * self.joule.shape[-2]

    def residual(self) -> np.ndarray:
        """Compute how far the balance battery = mechanical + joule + driver loss is from closing.

        Returns:
            The residual [-], `(..., t, m)`.
        """
        gap = self.battery - self.mechanical - self.joule - self.driver_loss
        scale = np.abs(self.battery) + np.abs(self.mechanical) + self.joule + self.driver_loss
        return np.divide(np.abs(gap), scale, out=np.zeros_like(gap), where=scale > 0)

    def energy(self) -> EnergySums:
        """Compute the energy of each motor over the whole time.

        Returns:
            The energies [J], `(..., m)` each.
        """
        return self._summed(self.time_step)

    def mean_power(self) -> EnergySums:
        """Compute the mean power of each motor over the whole time.

        Returns:
            The powers [W], `(..., m)` each.
        """
        return self._summed(1.0 / self.joule.shape[-2])

    def _summed(self, factor: float) -> EnergySums:
        parts = (
            "joule",
            "mechanical_positive",
            "mechanical_negative",
            "driver_loss",
            "drawn",
            "returned",
        )
        return EnergySums(**{name: getattr(self, name).sum(-2) * factor for name in parts})


@dataclass(frozen=True, eq=False)
class EnergySums:
    """Energies [J] or mean powers [W] of each motor, `(..., m)`; after `total`, of all motors,
    `(...)`.
    """

    joule: np.ndarray
    """Heat of the windings."""
    mechanical_positive: np.ndarray
    """While the motor drives."""
    mechanical_negative: np.ndarray
    """While the motor brakes, not positive."""
    driver_loss: np.ndarray
    """Heat of the drivers."""
    drawn: np.ndarray
    """Energy drawn from the battery [J]."""
    returned: np.ndarray
    """Energy returned to the battery [J]."""

    @property
    def mechanical(self) -> np.ndarray:
        """Net mechanical energy given to the joints [J]; negative where the motors braked more than
        they drove.
        """
        return self.mechanical_positive + self.mechanical_negative

    @property
    def mechanical_absolute(self) -> np.ndarray:
        """Driving and braking, each counted as positive."""
        return self.mechanical_positive - self.mechanical_negative

    @property
    def motor_side(self) -> np.ndarray:
        """Joule heat and signed mechanical: the paper's total."""
        return self.joule + self.mechanical

    @property
    def battery(self) -> np.ndarray:
        """Energy drawn from the battery less the energy returned to it [J]."""
        return self.drawn - self.returned

    def total(self) -> EnergySums:
        """Sum over all motors.

        Returns:
            The same quantities, `(...)` each.
        """
        return EnergySums(**{name: np.asarray(value).sum(-1) for name, value in vars(self).items()})

    def residual(self) -> np.ndarray:
        """Compute how far the balance is from closing, relative to the sum of the magnitudes.

        Returns:
            The residual [-].
        """
        gap = self.battery - self.mechanical - self.joule - self.driver_loss
        scale = np.asarray(
            self.drawn + self.returned + self.mechanical_absolute + self.joule + self.driver_loss
        )
        return np.divide(np.abs(gap), scale, out=np.zeros(np.shape(gap)), where=scale > 0)


def energy_ledger(
    motor_torque: Any,
    motor_velocity: Any,
    time_step: float,
    power_constant: Any,
    efficiency_out: Any = 0.9,
    efficiency_regen: Any = 0.8,
) -> EnergyLedger:
    """The ledger of motors over time.

    Args:
        motor_torque: [Nm], `(..., t, m)`.
        motor_velocity: [rad/s], `(..., t, m)`.
        time_step: between samples [s].
        power_constant: Cp [W/Nm^2], `(..., m)`.
        efficiency_out: of the drivers, battery to motor [-], `()` or the batch (Table I: 0.9).
        efficiency_regen: of the drivers, motor to battery [-], `()` or the batch (Table I: 0.8); 0
            where nothing returns.

    Returns:
        Powers of each motor by kind at every sample [W], `(..., t, m)`.

    Raises:
        InputError: shapes that do not fit, values that are not finite, a step that is not positive,
            an efficiency that is none.
    """
    torque, velocity = (
        _samples(motor_torque, "motor_torque"),
        _samples(motor_velocity, "motor_velocity"),
    )
    if torque.shape[-2:] != velocity.shape[-2:]:
        raise InputError(
            "energy",
            "motor_velocity",
            list(velocity.shape),
            f"expects the time and motors of motor_torque, {list(torque.shape)}",
        )
    if not (np.ndim(time_step) == 0 and np.isfinite(time_step) and time_step > 0):
        raise InputError("energy", "time_step", time_step, "expects a positive number in s")
    heat = np.asarray(power_constant, float)
    if heat.shape[-1:] not in ((), torque.shape[-1:]) or not np.all(
        np.isfinite(heat) & (heat >= 0)
    ):
        raise InputError(
            "energy",
            "power_constant",
            heat.tolist(),
            f"expects {torque.shape[-1]} numbers in W/Nm^2, not negative",
        )
    out = _efficiency(efficiency_out, "efficiency_out", allow_zero=False)
    regen = _efficiency(efficiency_regen, "efficiency_regen", allow_zero=True)
    joule = (heat[..., None, :] if heat.ndim else heat) * torque**2
    mechanical = torque * velocity
    joule, mechanical = np.broadcast_arrays(joule, mechanical)
    electrical = joule + mechanical
    draws, gives = np.maximum(electrical, 0.0), np.maximum(-electrical, 0.0)
    return EnergyLedger(
        time_step=float(time_step),
        joule=joule,
        mechanical=mechanical,
        driver_loss=(1 / out - 1) * draws + (1 - regen) * gives,
        drawn=draws / out,
        returned=gives * regen,
    )


def joint_power(joint_torque: Any, joint_velocity: Any) -> np.ndarray:
    """Compute the mechanical power of each joint, tau_joint q_dot.

    Its sum over joints equals the sum of the motors' mechanical power, because M maps both. For a
    single joint the two differ where motors are shared.

    Args:
        joint_torque: [Nm], `(..., joints)`.
        joint_velocity: [rad/s], `(..., joints)`.

    Returns:
        The power [W], `(..., joints)`.

    Raises:
        InputError: unequal numbers of joints.
    """
    torque, velocity = np.asarray(joint_torque, float), np.asarray(joint_velocity, float)
    if torque.shape[-1:] != velocity.shape[-1:]:
        raise InputError(
            "energy",
            "joint_velocity",
            list(velocity.shape),
            f"expects the joints of joint_torque, {list(torque.shape)}",
        )
    return torque * velocity


def cost_of_transport(energy: Any, mass: Any, distance: Any) -> np.ndarray:
    """Compute the cost of transport, energy / (m g distance).

    Args:
        energy: [J], `(...)`.
        mass: [kg], `(...)`.
        distance: [m], `(...)`.

    Returns:
        The cost [-], `(...)`.

    Raises:
        InputError: a mass or distance that is not positive.
    """
    energy, mass, distance = (np.asarray(v, float) for v in (energy, mass, distance))
    for field, value, unit in (("mass", mass, "kg"), ("distance", distance, "m")):
        if not np.all(np.isfinite(value) & (value > 0)):
            worst = float(value.flat[np.argmin(np.where(np.isfinite(value), value, -np.inf))])
            raise InputError(
                "cost of transport",
                field,
                worst,
                f"expects a positive number in {unit}; without it no transport is done",
            )
    return np.asarray(energy / (mass * GRAVITY * distance))


def _samples(value: Any, field: str) -> np.ndarray:
    array = np.asarray(value, float)
    if array.ndim < 2 or 0 in array.shape[-2:]:
        raise InputError(
            "energy",
            field,
            list(array.shape),
            "is the shape found; expects samples over time of each motor, (..., t, m)",
        )
    if not np.all(np.isfinite(array)):
        raise InputError(
            "energy", field, float(array[~np.isfinite(array)][0]), "expects finite numbers"
        )
    return array


def _efficiency(value: Any, field: str, *, allow_zero: bool) -> np.ndarray:
    """An efficiency with room for time and motors behind the batch."""
    array = np.asarray(value, float)
    if not np.all((array <= 1) & ((array >= 0) if allow_zero else (array > 0))):
        raise InputError(
            "energy",
            field,
            array.tolist(),
            "expects a share of one: from 0 to 1" + ("" if allow_zero else ", above 0"),
        )
    return array[..., None, None]
