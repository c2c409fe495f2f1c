"""A log made ready for the residuals: one even time base, smooth motion, believed torques, inverse
dynamics.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from hyperleg_design.gap.logs.columns import force_names
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.base import BaseMotion
from hyperleg_design.gap.model.joint_units import unit_at
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.model.supply import over_nominal
from hyperleg_design.gap.signals.channels import applied
from hyperleg_design.gap.signals.limit_cycle import LimitCycle
from hyperleg_design.gap.signals.unknown_forces import Elimination

RESIDUALS = {
    "motion": ("joint", "Nm"),
    "drive": ("motor", "Nm"),
    "control": ("motor", "Nm"),
    "transmission": ("motor", "rad/s"),
    "base": ("robot", "N, Nm"),
    "ground": ("foot", "N"),
    "gyro": ("sensor", "rad/s"),
    "accelerometer": ("sensor", "m/s^2"),
}
"""Kind of place and unit of the rows of each of `Signals.residual`."""
OF_SENSORS = tuple(name for name, (kind, _) in RESIDUALS.items() if kind == "sensor")
"""Residuals of the IMU, which no torque enters."""
OF_MOTORS = tuple(
    residual_name for residual_name, (kind, _) in RESIDUALS.items() if kind == "motor"
)
"""Residuals with a row for each motor."""
WRENCH = ("force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z")
"""Rows of the residual of the base."""


def row_names(subject: Subject, residual_name: str) -> tuple[str, ...]:
    """Name the rows of a residual.

    Args:
        subject: the robot.
        residual_name: of `RESIDUALS`.

    Returns:
        Joints, motors, parts of the base's wrench, each foot with each axis, or the axes of a
        sensor.
    """
    kind, _ = RESIDUALS[residual_name]
    sensor = tuple(f"{residual_name}_{axis}" for axis in "xyz")
    return {
        "joint": subject.joints,
        "motor": subject.motors,
        "robot": WRENCH,
        "foot": force_names(subject.feet),
        "sensor": sensor,
    }[kind]


def row_units(subject: Subject, residual_name: str) -> tuple[str, ...]:
    """State the unit of each row of a residual.

    Args:
        subject: the robot.
        residual_name: of `RESIDUALS`.

    Returns:
        One unit for each of `row_names`.
    """
    kind, unit = RESIDUALS[residual_name]
    if kind == "robot":
        return tuple("N" if row.startswith("force") else "Nm" for row in WRENCH)
    return tuple(unit_at(subject, kind, row, unit) for row in row_names(subject, residual_name))


@dataclass(frozen=True, eq=False)
class Signals:
    """One log on an even time base, `t` ticks, `n` joints, `m` motors, `f` feet; motion smoothed
    without delay.

    Residuals, each what the log shows minus what the nominal model explains:
        motion: believed joint torque minus the torque that the logged motion needs `(t, n)` [Nm];
            while forces of the ground are unknown, combinations that are free of them;
        drive: measured motor torque minus the torque that the controller asks for, within nominal
            limits `(t, m)` [Nm], where both are known; of sensors behind the gear, with the nominal
            friction and the rotors that act before them;
        control: logged command of the motors minus the one that the declared gains make of the
            logged targets and state `(t, m)` [Nm], where both are known and the controller is of
            that form;
        base: of a floating base whose contact forces are logged, the six rows of the base `(t, 6)`
            [N, Nm];
        transmission: logged speed of the motors minus that of the joints' motion `(t, m)` [rad/s],
            where both are known;
        ground: logged contact force minus the nominal ground's at the logged motion `(t, 3 f)` [N];
        gyro: angular velocity that the IMU of a floating base measured minus the rate of the logged
            orientation, in the sensor's axes `(t, 3)` [rad/s];
        accelerometer: what the IMU felt minus the acceleration of the logged velocity and
            orientation, and gravity, in the sensor's axes `(t, 3)` [m/s^2].
    """

    log: Log
    subject: Subject
    step: float
    """Of the time base [s]."""
    time: np.ndarray
    """Even times of the ticks `(t,)` [s]."""
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    """Of the joints `(t, n)` [rad, rad/s, rad/s^2]."""
    base: BaseMotion | None
    sensed: np.ndarray
    """Velocity that controllers see, see `sensed` `(t, n)` [rad/s]."""
    motor_speed: np.ndarray
    """Speed that the DC-motor lines of motors follow `(t, m)` [rad/s]: the logged one, else that of
    their joints' motion, which is smoother than what an impact does to a motor."""
    target: np.ndarray | None
    """Position target as it acts over a tick, `(t, n)` [rad]: halfway between the one that was kept
    until then and the one that is new."""
    command: np.ndarray | None
    """Motor torque that the controller asks for `(t, m)` [Nm]: logged, or from targets and gains;
    before any limit."""
    measured: np.ndarray | None
    """Motor torque that the log measured, or current times the declared torque constant `(t, m)`
    [Nm]."""
    believed: np.ndarray
    """Motor torque that the residual of motion trusts: measured, else command within the nominal
    limits `(t, m)` [Nm]."""
    rigid: np.ndarray
    """Joint torque that the logged motion needs: inverse dynamics, rotors, nominal friction,
    contact forces `(t, n)` [Nm]."""
    temperature: np.ndarray | None
    """Logged temperature of the motors `(t, m)` [degC]."""
    voltage: np.ndarray | None
    """Logged voltage of the battery `(t,)` [V]."""
    contact: np.ndarray | None
    """Force of the ground on each foot, world frame `(t, f, 3)` [N]."""
    valid: np.ndarray
    """Ticks fit for use `(t,)`: no gap in the log near, not at its ends."""
    residual: dict[str, np.ndarray]
    """By residual that this log allows."""
    pad_force: np.ndarray | None = None
    """Force of the ground on each of `subject.pads`, world frame `(t, P, 3)` [N], where the place
    of the force is known."""
    pushing: np.ndarray | None = None
    """The same, and equal shares of a foot's force where its place is unknown; 0 where the force
    is."""
    elimination: Elimination | None = None
    """How the rows of `motion` are combined while forces of the ground are unknown."""
    touching: np.ndarray | None = None
    """Of a floating base: whether each foot touches the ground, or may `(t, f)`."""
    bandwidth: np.ndarray | None = None
    """Frequency above which smoothing takes motion for noise `(n,)` [Hz]; NaN for joints that this
    log lacks."""
    noise: np.ndarray | None = None
    """Standard deviation of the noise of a position sample, as the log itself tells `(n,)`
    [rad]."""
    jump: np.ndarray | None = None
    """Half of the change of the commands where new targets come with a row of the log `(t, m)`
    [Nm]."""
    limit_cycle: LimitCycle | None = None
    """Of joints that swing to and fro above all that was commanded; None where none does."""
    behind_gears: np.ndarray | None = None
    """Joints whose torque is measured by a sensor between gear and link `(n,)`; None where no
    joint's is. Their nominal friction and rotors are not in `rigid`."""
    before_sensors: np.ndarray | None = None
    """What nominal friction and rotors take of motors before these sensors `(t, m)` [Nm]."""
    notes: tuple[str, ...] = ()
    """What this log lacked and what was assumed in its place."""

    @cached_property
    def supplied(self) -> np.ndarray:
        """Voltage over the nominal one of motors that follow it, 1 of others `(t, m)`, or `(1, m)`;
        see `supply`.
        """
        return over_nominal(self.subject, self.voltage)

    @cached_property
    def sensed_behind(self) -> np.ndarray:
        """Motors whose torque is measured behind the gear `(m,)`."""
        matrix = self.subject.joint_from_motor
        if self.behind_gears is None:
            return np.zeros(matrix.shape[1], bool)
        return np.asarray((matrix[self.behind_gears] != 0).any(0))

    @cached_property
    def resisting(self) -> np.ndarray:
        """Residual in which friction and rotors show, as the torque that joints take beyond the
        model `(t, n)` [Nm]: of motion, or of the drive before a sensor behind the gear.
        """
        motion = self.residual["motion"]
        if self.behind_gears is None:
            return motion
        drive = self.residual.get("drive")
        taken = np.full_like(motion, np.nan)
        if drive is not None:
            taken = -applied(self.subject.joint_from_motor, drive)
        return np.where(self.behind_gears, taken, motion)

    def shown(self, traces: Mapping[str, np.ndarray]) -> Mapping[str, np.ndarray]:
        """Combine the rows of traces as those of the residuals, see `elimination`.

        Args:
            traces: by residual `(..., t, rows)`, physical.
        """
        return traces if self.elimination is None else self.elimination.freed(traces)

    @property
    def steered(self) -> bool:
        """Whether targets and the controllers' declared gains alone tell torques: none was measured
        and no command is logged.
        """
        logged = self.measured is not None or "control" in self.residual
        return self.target is not None and not logged
