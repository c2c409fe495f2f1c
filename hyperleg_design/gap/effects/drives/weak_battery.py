"""A battery in a simulation whose voltage falls with the power that the drives take."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from hyperleg_design.simulation.alteration import Alteration, Live, Tick
from hyperleg_design.simulation.drives.limits import Limits
from hyperleg_design.simulation.drives.machine import Machine

SAG = 0.2
"""Share of the voltage that is missing at the reference power, where nobody logged it (assumed:
5.8-7.4 V of an XL330's 7.4 V)."""
AT_REST = 0.5
"""Part of `SAG` that is missing without load, as batteries run down (assumed)."""


def _modelled(
    torque: np.ndarray, speed: np.ndarray, drives: Machine, reference: float
) -> np.ndarray:
    """Share of the voltage that is missing at torques and speeds of the motors `(..., m)`,
    `(...,)`.

    Args:
        torque: of the motors `(..., m)` [Nm].
        speed: of the motors `(..., m)` [rad/s].
        drives: the machine that the robot is to its drives.
        reference: power at which `SAG` is missing [W].

    Returns:
        The missing share `(...,)` [-].
    """
    power = np.maximum((torque * speed + drives.power_constant * torque**2).sum(-1), 0.0)
    return np.asarray(SAG * (AT_REST + (1 - AT_REST) * np.minimum(power / reference, 1.0)))


class _Weak(Live):
    hidden_state: ClassVar[tuple[str, ...]] = ("lost", "full")

    alteration: WeakBattery

    def prepare(self) -> None:
        self.line = np.isfinite(self.machine.stall_torque) & np.isfinite(self.machine.no_load_speed)
        self.lost, self.full = np.zeros(self.count), np.zeros(self.count)

    def begin(self, tick: Tick) -> None:
        share = _modelled(
            tick.last_torque, tick.motor_velocity, self.machine, self.alteration.reference_power
        )
        if tick.battery is not None:
            self.full[:] = np.fmax(self.full, tick.battery)
            nominal = self.machine.voltage if np.isfinite(self.machine.voltage) else self.full
            with np.errstate(invalid="ignore", divide="ignore"):
                share = np.where(np.isfinite(tick.battery), 1 - tick.battery / nominal, share)
        self.lost[:] = share

    def command(self, command: np.ndarray, tick: Tick) -> np.ndarray:
        return np.asarray(command * (1 - self.alteration.torque * self.lost)[:, None])

    def limits(self, limits: Limits, tick: Tick) -> Limits:
        battery = self.alteration
        share, speed = (
            np.broadcast_to(np.asarray(x, float), (self.count,))[:, None]
            for x in (battery.limits, battery.speed)
        )
        lost = self.lost[:, None]
        voltage = np.maximum(1 - share * lost, 1e-6)
        left = np.maximum(1 - lost, 1e-6)
        stall = battery.strength / np.maximum(share, 1e-12) * left
        return dataclasses.replace(
            limits,
            stall_torque=np.where(
                self.line,
                limits.stall_torque * voltage,
                np.where(share > 0, stall, limits.stall_torque),
            ),
            no_load_speed=np.where(
                self.line,
                limits.no_load_speed * voltage,
                np.where(share > 0, speed * battery.ratio * left, limits.no_load_speed),
            ),
        )


@dataclass(frozen=True, eq=False)
class WeakBattery(Alteration):
    """Limits and torques of all motors follow the battery's voltage: measured, or modelled."""

    live: ClassVar[type[Live] | None] = _Weak
    limits: Any
    torque: Any
    speed: Any
    """`()` or `(n,)` each [-, -, rad/s]."""
    strength: np.ndarray
    ratio: np.ndarray
    """Of each motor: torque that it is made for [Nm], and speed over that of the joint that it
    moves most `(m,)`."""
    reference_power: float
    """Power at which a usual battery lacks its usual sag, see `reference_power` [W]."""
