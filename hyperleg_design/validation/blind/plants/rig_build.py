"""From a robot, what is off and what is wrong to the first rig plant."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.validation.blind.plants.nuisance import Nuisance, built
from hyperleg_design.validation.blind.plants.plant import RigPlant
from hyperleg_design.validation.blind.robots.chain import GRAVITY, Chain
from hyperleg_design.validation.blind.wrong import Wrong

BELT_DAMPING = 0.05
"""Damping ratio of a rotor on its belt, the joint held."""
BRISTLE = 1.2e-3
"""Deflection at which friction slides [rad], at a joint."""
STRIBECK_SPEED = 0.06
"""At the joints, of ordinary friction [rad/s]."""
ENCODER = 2 * np.pi / 2**15
"""Resolution of an output encoder [rad]."""
HEATED = 75.0
"""Windings at the start of a recording whose drives derate [degC]."""


@dataclass(frozen=True, eq=False)
class Reach:
    """How far a clean recording drives the robot; what limits are set against."""

    command: np.ndarray
    """Largest motor torque asked for `(m,)` [Nm]."""
    speed: np.ndarray
    """Largest motor speed `(m,)` [rad/s]."""


def build_rig(
    chain: Chain, nuisance: Nuisance, wrongs: Sequence[Wrong] = (), reach: Reach | None = None
) -> RigPlant:
    """The plant; `reach` is needed by effects that are limits.

    Args:
        chain: the nominal robot.
        nuisance: what is off, though nothing is wrong.
        wrongs: what is wrong.
        reach: how far clean runs drive the motors.

    Returns:
        The plant.
    """
    n, m = chain.joint_from_motor.shape
    true = built(chain, nuisance)
    matrix = chain.joint_from_motor
    ratio = np.abs(matrix).max(0)
    peak = np.abs(matrix) @ chain.peak_torque
    rotor = chain.rotor_inertia * nuisance.rotor
    zeros_n, zeros_m = np.zeros(n), np.zeros(m)
    values: dict[str, Any] = {
        "joint_from_motor": matrix.copy(),
        "declared": matrix,
        "rotor_inertia": rotor,
        "belt_stiffness": rotor * (2 * np.pi * nuisance.resonance) ** 2,
        "belt_damping": 2 * BELT_DAMPING * rotor * 2 * np.pi * nuisance.resonance,
        "backlash": zeros_m.copy(),
        "coulomb": np.r_[zeros_m, chain.coulomb * nuisance.coulomb],
        "static": np.r_[zeros_m, chain.coulomb * nuisance.coulomb * nuisance.breakaway],
        "stribeck_speed": np.r_[STRIBECK_SPEED * ratio, np.full(n, STRIBECK_SPEED)],
        "viscous": np.r_[zeros_m, chain.viscous * nuisance.viscous],
        "bristle": np.r_[BRISTLE * ratio, np.full(n, BRISTLE)],
        "load_friction": np.zeros(m + n),
        "spring": zeros_n.copy(),
        "spring_rest": chain.rest.copy(),
        "cogging": zeros_m.copy(),
        "cogging_order": zeros_m.copy(),
        "cogging_phase": zeros_m.copy(),
        "torque_scale": nuisance.torque.copy(),
        "peak_torque": chain.peak_torque.copy(),
        "stall_torque": chain.stall_torque.copy(),
        "no_load_speed": chain.no_load_speed.copy(),
        "voltage": chain.voltage,
        "supply": chain.voltage,
        "supply_resistance": 0.01,
        "power_constant": np.full(m, 20.0) / chain.peak_torque**2,
        "thermal_resistance": np.full(m, 1.5),
        "thermal_time": np.full(m, 90.0),
        "start_temperature": np.full(m, nuisance.air),
        "derating": zeros_m.copy(),
        "delay": np.full(m, nuisance.delay),
        "lag": np.full(m, nuisance.lag),
        "stiffness": chain.stiffness.copy(),
        "damping": chain.damping.copy(),
        "offset": nuisance.offset.copy(),
        "resolution": np.full(n, ENCODER),
        "velocity_bandwidth": 120.0,
        "ripple": zeros_m.copy(),
        "patch": zeros_n.copy(),
        "patch_middle": chain.rest.copy(),
        "hysteresis": zeros_n.copy(),
        "loss": 0.0,
        "push": zeros_n.copy(),
        "push_frequency": 1.0,
        "hardening": zeros_n.copy(),
        "coupling": np.zeros((n, n)),
        "drift": zeros_n.copy(),
        "drag": zeros_n.copy(),
        "eccentricity": zeros_n.copy(),
        "rest": chain.rest,
    }
    gravity = GRAVITY.copy()
    for wrong in wrongs:
        place = _Place(chain, wrong.location, peak)
        if wrong.effect in _RIGID:
            true = _RIGID[wrong.effect](true, wrong)
        elif wrong.effect == "tilted_gravity":
            gravity = tilted(wrong.size, wrong.shape["heading"])
        else:
            _change(values, place, wrong, reach)
    return RigPlant(model=true.pinocchio(gravity), **values)


def tilted(angle: float, heading: float) -> np.ndarray:
    """Gravity of a rig that stands askew `(3,)` [m/s^2].

    Args:
        angle: by which it stands askew [rad].
        heading: direction in which it leans [rad].

    Returns:
        The gravity `(3,)` [m/s^2].
    """
    across = np.array([np.cos(heading), np.sin(heading), 0.0])
    return 9.81 * (np.sin(angle) * across - np.array([0.0, 0.0, np.cos(angle)]))


@dataclass(frozen=True, eq=False)
class _Place:
    chain: Chain
    name: str
    peaks: np.ndarray

    @property
    def motor(self) -> Any:
        """Index of the motor; of a robot-wide effect, all."""
        if self.name in ("robot", "battery"):
            return slice(None)
        names = self.chain.joints if self.chain.diagonal else self.chain.motors
        return names.index(self.name) if self.name in names else self.chain.joints.index(self.name)

    @property
    def joint(self) -> int:
        return self.chain.joints.index(self.name)

    @property
    def coordinate(self) -> int:
        """Of the friction: the joint's, or the motor's where it sits at a motor of coupled ones."""
        m = len(self.chain.motors)
        return (
            m + self.joint if self.name in self.chain.joints else self.chain.motors.index(self.name)
        )

    @property
    def peak(self) -> float:
        """Largest torque of the coordinate [Nm]."""
        if self.name in self.chain.joints:
            return float(self.peaks[self.joint])
        return float(self.chain.peak_torque[self.chain.motors.index(self.name)])


def _gear(at: _Place) -> float:
    """Speed of the coordinate over that of a joint."""
    return (
        1.0
        if at.name in at.chain.joints
        else float(np.abs(at.chain.joint_from_motor[:, at.chain.motors.index(at.name)]).max())
    )


def _change(v: dict[str, Any], at: _Place, w: Wrong, reach: Reach | None) -> None:
    """Change the values of a plant by what is wrong with it, but for its rigid bodies."""
    match w.effect:
        case "coulomb_friction":
            for name in ("coulomb", "static"):
                v[name][at.coordinate] += w.size * at.peak
        case "viscous_friction":
            v["viscous"][at.coordinate] += w.size * at.peak / _gear(at)
        case "stribeck_friction":
            v["static"][at.coordinate] += w.size * at.peak
            v["stribeck_speed"][at.coordinate] = w.shape["speed"] * _gear(at)
        case "load_dependent_friction":
            v["load_friction"][at.coordinate] += w.size
        case "torque_constant":
            v["torque_scale"][at.motor] *= 1.0 - w.size
        case "torque_saturation":
            assert reach is not None
            v["peak_torque"][at.motor] = np.minimum(
                v["peak_torque"][at.motor], (1.0 - w.size) * reach.command[at.motor]
            )
        case "thermal_derating":
            v["start_temperature"][at.motor] = HEATED
            v["derating"][at.motor] = w.size / 100.0
        case "voltage_sag":
            v["supply"] = v["voltage"] * (1.0 - w.size)
        case "command_delay":
            v["delay"][at.motor] += w.size
        case "actuator_bandwidth":
            v["lag"][at.motor] += w.size
        case "rotor_inertia":
            v["rotor_inertia"][at.motor] += w.size * at.chain.rotor_inertia[at.motor]
        case "transmission_elasticity":
            v["belt_stiffness"][at.motor] /= w.size
            v["belt_damping"][at.motor] /= np.sqrt(w.size)
        case "backlash":
            v["backlash"][at.motor] += w.size * np.abs(at.chain.joint_from_motor).max(0)[at.motor]
        case "transmission_ratio":
            v["joint_from_motor"][:, at.motor] *= 1.0 + w.size
        case "encoder_offset":
            v["offset"][at.joint] += w.size
        case "controller_gain":
            v["stiffness"][at.joint] *= 1.0 + w.size * w.shape["stiffness"]
            v["damping"][at.joint] *= 1.0 + w.size * w.shape["damping"]
        case "cogging":
            v["cogging"][at.motor] = w.size * at.chain.peak_torque[at.motor]
            v["cogging_order"][at.motor] = w.shape["order"]
            v["cogging_phase"][at.motor] = w.shape["phase"]
        case "joint_spring":
            v["spring"][at.joint] += w.size * at.peak
            v["spring_rest"][at.joint] = w.shape["rest"]
        case "torque_ripple":
            v["ripple"][at.motor] = w.size
        case "friction_patch":
            v["patch"][at.joint] = w.size * at.peak
            v["patch_middle"][at.joint] = at.chain.rest[at.joint] + w.shape["shift"]
        case "hysteresis":
            v["hysteresis"][at.joint] = w.size * at.peak
        case "packet_loss":
            v["loss"] = w.size
        case "periodic_push":
            v["push"][at.joint], v["push_frequency"] = w.size * at.peak, w.shape["frequency"]
        case "hardening_spring":
            v["hardening"][at.joint] = w.size * at.peak
        case "cross_coupling":
            v["coupling"][at.joint, int(w.shape["other"])] = w.size * at.peak
        case "sensor_drift":
            v["drift"][at.joint] = w.size
        case "fluid_drag":
            v["drag"][at.joint] = w.size * at.peak
        case "encoder_eccentricity":
            v["eccentricity"][at.joint] = w.size
        case what:
            raise ValueError(f"{what} is nothing that a plant knows")


def _payload(chain: Chain, wrong: Wrong) -> Chain:
    return chain.with_point_mass(
        wrong.location, wrong.size, np.array([wrong.shape[a] for a in "xyz"])
    )


def _link_mass(chain: Chain, wrong: Wrong) -> Chain:
    link = next(link for link in chain.links if link.name == wrong.location)
    return chain.with_link(
        link.name, mass=link.mass * (1 + wrong.size), inertia=link.inertia * (1 + wrong.size)
    )


def _link_com(chain: Chain, wrong: Wrong) -> Chain:
    link = next(link for link in chain.links if link.name == wrong.location)
    return chain.with_link(
        link.name, com=link.com + wrong.size * np.array([wrong.shape[a] for a in "xyz"])
    )


_RIGID = {"payload": _payload, "link_mass": _link_mass, "link_com": _link_com}
