"""Motors without current control: their duty cycle follows the position error, so their torque
follows the battery's voltage.

    torque = V / V_n K (q* - q) - D q_dot    within the DC-motor line of V

V is the logged voltage, V_n the nominal one at which stiffness K, stall torque and no-load speed
are declared; D is mostly the motor's own (kt^2 / R), which no voltage changes. So are hobby servos
(Dynamixel XL, Feetech STS) in position mode.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.simulation.alteration import Alteration, Live, Tick
from hyperleg_design.simulation.drives.actuation import applied
from hyperleg_design.simulation.drives.limits import Limits


def over_nominal(subject: Subject, voltage: np.ndarray | None) -> np.ndarray:
    """Compute the voltage over the nominal one for each motor; 1 for motors with current control.

    Args:
        subject: the robot.
        voltage: of the battery `(t,)` [V], NaN where unknown; None, as nominal.

    Returns:
        The ratio [-], `(t, m)`; `(1, m)` where nothing changes.
    """
    driven = np.isfinite(subject.supply)
    if voltage is None or not driven.any():
        return np.ones((1, len(subject.supply)))
    ratio = voltage[:, None] / np.where(driven, subject.supply, 1.0)
    return np.where(driven & np.isfinite(ratio), ratio, 1.0)


def driven_by_duty(subject: Subject) -> np.ndarray:
    """Find the joints that a motor without current control moves.

    Args:
        subject: the robot.

    Returns:
        `(n,)`.
    """
    return np.asarray(((subject.joint_from_motor != 0) & np.isfinite(subject.supply)).any(1))


def followed(subject: Subject) -> tuple[Alteration, ...]:
    """Make a simulation of a robot follow its battery's measured voltage.

    Args:
        subject: the robot.

    Returns:
        The alteration; none where no motor follows the battery.
    """
    return (FollowsBattery(subject.supply),) if np.isfinite(subject.supply).any() else ()


class _Follows(Live):
    alteration: FollowsBattery

    def prepare(self) -> None:
        self.ratio = np.ones((self.count, len(self.machine.motors)))

    def begin(self, tick: Tick) -> None:
        if tick.battery is not None:
            ratio = tick.battery[:, None] / self.alteration.supply
            self.ratio = np.where(np.isfinite(ratio), ratio, 1.0)

    def command(self, command: np.ndarray, tick: Tick) -> np.ndarray:
        damper = -applied(self.machine.motor_from_joint, self.machine.damping * tick.velocity)
        return np.asarray((command - damper) * self.ratio + damper)

    def limits(self, limits: Limits, tick: Tick) -> Limits:
        return Limits(
            limits.no_load_speed * self.ratio, limits.stall_torque * self.ratio, limits.peak_torque
        )


@dataclass(frozen=True, eq=False)
class FollowsBattery(Alteration):
    """Stiffness and limits of some motors in proportion to the measured voltage of the battery."""

    live: ClassVar[type[Live] | None] = _Follows
    supply: np.ndarray
    """Nominal `(m,)` [V]; NaN of motors with current control."""
