"""What a rig plant is made of, and what a run of it leaves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import pinocchio


@dataclass(frozen=True, eq=False)
class RigPlant:
    """One rig as it truly is: `m` motors, `n` joints, `c = m + n` coordinates, motors first."""

    model: pinocchio.Model
    joint_from_motor: np.ndarray
    """True M `(n, m)`."""
    declared: np.ndarray
    """M that the controller computes with `(n, m)`."""
    rotor_inertia: np.ndarray
    """`(m,)` [kg m^2]"""
    belt_stiffness: np.ndarray
    """At the motors `(m,)` [Nm/rad]."""
    belt_damping: np.ndarray
    """At the motors `(m,)` [Nms/rad]."""
    backlash: np.ndarray
    """Free play at the motors, end to end `(m,)` [rad]."""
    coulomb: np.ndarray
    static: np.ndarray
    """Sliding and breakaway friction `(c,)` [Nm]."""
    stribeck_speed: np.ndarray
    """`(c,)` [rad/s]"""
    viscous: np.ndarray
    """`(c,)` [Nms/rad]"""
    bristle: np.ndarray
    """Deflection at which friction slides `(c,)` [rad]."""
    load_friction: np.ndarray
    """Friction over transmitted torque `(c,)` [-]."""
    spring: np.ndarray
    spring_rest: np.ndarray
    """At the joints `(n,)` [Nm/rad], [rad]."""
    cogging: np.ndarray
    cogging_order: np.ndarray
    cogging_phase: np.ndarray
    """At the motors, torque amplitude, periods a turn and phase `(m,)` [Nm], [-], [rad]."""
    torque_scale: np.ndarray
    """True torque over what the drive's current and the declared constant say `(m,)`."""
    peak_torque: np.ndarray
    stall_torque: np.ndarray
    no_load_speed: np.ndarray
    """Envelope at the nominal voltage `(m,)` [Nm], [Nm], [rad/s]."""
    voltage: float
    """Nominal supply [V]."""
    supply: float
    """Open-circuit voltage of the battery [V]."""
    supply_resistance: float
    """Of the battery and its cables [Ohm]."""
    power_constant: np.ndarray
    """Joule heat over squared torque `(m,)` [W/Nm^2]."""
    thermal_resistance: np.ndarray
    thermal_time: np.ndarray
    """Winding to air `(m,)` [K/W], and time constant [s]."""
    start_temperature: np.ndarray
    """`(m,)` [degC]"""
    derating: np.ndarray
    """Torque lost per kelvin above 25 degC `(m,)` [1/K]."""
    delay: np.ndarray
    """From the controller to the current loop `(m,)` [s]."""
    lag: np.ndarray
    """Time constant of the torque loop `(m,)` [s]."""
    stiffness: np.ndarray
    damping: np.ndarray
    """True gains of the joint controller `(n,)` [Nm/rad], [Nms/rad]."""
    offset: np.ndarray
    """What the encoders read too much `(n,)` [rad]."""
    resolution: np.ndarray
    """Of the encoders `(n,)` [rad]."""
    velocity_bandwidth: float
    """Of the drives' speed estimate [Hz]."""
    # Outside the catalogue; all zero where absent.
    ripple: np.ndarray
    """Torque ripple over torque at the 5th and 7th electrical harmonic `(m,)` [-]."""
    patch: np.ndarray
    """Further sliding friction inside `patch_middle` +- 0.15 rad `(n,)` [Nm]."""
    patch_middle: np.ndarray
    """`(n,)` [rad]"""
    hysteresis: np.ndarray
    """Rate-independent torque that builds up over 0.25 rad `(n,)` [Nm]."""
    loss: float
    """Share of time in which commands do not arrive, in bursts of 40 ms on average [-]."""
    push: np.ndarray
    push_frequency: float
    """Torque of a periodic push on the joints `(n,)` [Nm], [Hz]; short thrusts, not a sine."""
    hardening: np.ndarray
    """Cubic spring about the rest posture `(n,)` [Nm/rad^3]."""
    coupling: np.ndarray
    """Torque at joint i over angle of joint j `(n, n)` [Nm/rad]."""
    drift: np.ndarray
    """Of the encoders over time `(n,)` [rad/s]."""
    drag: np.ndarray
    """Torque over squared speed `(n,)` [Nms^2/rad^2]."""
    eccentricity: np.ndarray
    """Of the encoder discs: error that goes as sin of three times the angle `(n,)` [rad]."""
    rest: np.ndarray
    """Posture that springs and patches refer to `(n,)` [rad]."""


@dataclass(frozen=True, eq=False)
class Trace:
    """What truly happened, at every tick of the drives, `k` ticks at 1 kHz."""

    time: np.ndarray
    """`(k,)` [s]"""
    position: np.ndarray
    velocity: np.ndarray
    """Of the joints `(k, n)` [rad], [rad/s]."""
    encoder: np.ndarray
    speed: np.ndarray
    """As the drives see them, before the log's own noise `(k, n)`."""
    motor_velocity: np.ndarray
    """`(k, m)` [rad/s]"""
    command: np.ndarray
    """Motor torque that the controller asks for `(k, m)` [Nm]."""
    drive_torque: np.ndarray
    """Motor torque as current times declared constant `(k, m)` [Nm]."""
    pull: np.ndarray
    """Torque of the belts on the joints `(k, n)` [Nm]."""
    temperature: np.ndarray
    """`(k, m)` [degC]"""
    voltage: np.ndarray
    """`(k,)` [V]"""
    energy: np.ndarray
    """Kinetic and elastic energy of rotors and belts, potential and kinetic of the bodies `(k,)`
    [J]; NaN unless asked for."""


def columns_of(n: int, m: int) -> dict[str, int]:
    """State how many numbers a trace holds at each tick.

    Args:
        n: joints.
        m: motors.

    Returns:
        Columns by field of `Trace`; energy, which is computed afterwards, is missing.
    """
    of_joints = dict.fromkeys(("position", "velocity", "encoder", "speed", "pull"), n)
    of_motors = dict.fromkeys(("motor_velocity", "command", "drive_torque", "temperature"), m)
    return of_joints | of_motors | {"voltage": 1}


def traces_of(columns: Mapping[str, np.ndarray], energy: np.ndarray, step: float) -> list[Trace]:
    """Cut what `b` plants did side by side into their traces.

    Args:
        columns: by field of `Trace`, `(k, b, n)`.
        energy: `(k, b)` [J].
        step: between ticks [s].

    Returns:
        One trace a plant.
    """
    time = np.arange(len(energy)) * step
    return [
        Trace(
            time=time,
            energy=energy[:, i],
            voltage=columns["voltage"][:, i, 0],
            **{name: values[:, i] for name, values in columns.items() if name != "voltage"},
        )
        for i in range(energy.shape[1])
    ]


def inverse_inertia(plant: RigPlant) -> np.ndarray:
    """Compute the inverse of the joints' inertia at the posture of rest.

    Args:
        plant: the rig.

    Returns:
        The inverse `(n, n)` [1/(kg m^2)].
    """
    import pinocchio as pin

    half = np.triu(pin.computeMinverse(plant.model, plant.model.createData(), plant.rest))
    return np.asarray(half + np.triu(half, 1).T)
