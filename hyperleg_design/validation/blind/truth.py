"""The truth in the catalogue's words: where effects sit, which names count as the place, and sizes
in the catalogue's parameters.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.validation.blind.plants.nuisance import Nuisance
from hyperleg_design.validation.blind.plants.rig_build import Reach
from hyperleg_design.validation.blind.robots.chain import Chain
from hyperleg_design.validation.blind.wrong import Wrong

KIND = {
    "coulomb_friction": "joint",
    "viscous_friction": "joint",
    "stribeck_friction": "joint",
    "load_dependent_friction": "joint",
    "torque_constant": "motor",
    "torque_saturation": "motor",
    "thermal_derating": "motor",
    "voltage_sag": "battery",
    "command_delay": "robot",
    "actuator_bandwidth": "motor",
    "rotor_inertia": "motor",
    "transmission_elasticity": "motor",
    "backlash": "motor",
    "transmission_ratio": "motor",
    "encoder_offset": "joint",
    "controller_gain": "joint",
    "payload": "link",
    "link_mass": "link",
    "link_com": "link",
    "cogging": "motor",
    "joint_spring": "joint",
    "torque_ripple": "motor",
    "friction_patch": "joint",
    "hysteresis": "joint",
    "packet_loss": "robot",
    "tilted_gravity": "robot",
    "periodic_push": "joint",
    "hardening_spring": "joint",
    "cross_coupling": "joint",
    "sensor_drift": "joint",
    "fluid_drag": "joint",
    "encoder_eccentricity": "joint",
    "imu_bias": "sensor",
    "ground_friction": "foot",
    "ground_compliance": "foot",
}
"""Kind of place at which the plants put each effect."""


def places(wrong: Wrong, robot: Chain) -> tuple[str, ...]:
    """Names that count as the place of an effect: links and the joints that carry them are one
    place, as are a single drive and its joint.

    Args:
        wrong: what is wrong.
        robot: the robot.

    Returns:
        The names.
    """
    names = [wrong.location]
    for link in robot.links:
        if wrong.location in (link.name, link.joint) and KIND[wrong.effect] == "link":
            names += [link.name, link.joint]
    if robot.diagonal and wrong.location in robot.joints:
        names.append(robot.motors[robot.joints.index(wrong.location)])
    if wrong.location in ("robot", "battery"):
        names += ["robot", "battery"]
    return tuple(dict.fromkeys(names))


def parameters(
    wrong: Wrong, robot: Chain, day: Nuisance, reach: Reach | None, *, belts: float = 1.0
) -> dict[str, float]:
    """What was put in, by the catalogue's names and units; effects outside it, none.

    Args:
        wrong: the effect.
        robot: nominal robot.
        day: what is off besides.
        reach: of a clean recording; of limits.
        belts: stiffness of the plant's belts over the first plant's.
    """
    if not wrong.listed:
        return {}
    joint_peak = np.abs(robot.joint_from_motor) @ robot.peak_torque
    names = robot.joints if robot.diagonal else robot.motors
    joint = robot.joints.index(wrong.location) if wrong.location in robot.joints else 0
    motor = names.index(wrong.location) if wrong.location in names else 0
    torque = float(wrong.size * joint_peak[joint])
    match wrong.effect:
        case "coulomb_friction":
            return {"torque": torque}
        case "viscous_friction":
            return {"damping": torque}
        case "stribeck_friction":
            return {"torque": torque, "speed": wrong.shape["speed"]}
        case "load_dependent_friction":
            return {"coefficient": wrong.size}
        case "torque_constant":
            return {"scale": 1.0 - wrong.size}
        case "torque_saturation":
            assert reach is not None
            return {
                "limit": float(
                    min((1.0 - wrong.size) * reach.command[motor], robot.peak_torque[motor])
                )
            }
        case "thermal_derating":
            return {"coefficient": wrong.size / 100.0}
        case "voltage_sag":
            # Of a robot whose file tells no speed-torque line, `limits` is how near that line is,
            # which depends on the unknown voltage.
            return {"limits": 1.0} if robot.mjcf is None else {}
        case "command_delay":
            return {"delay": wrong.size}
        case "actuator_bandwidth":
            return {"time_constant": wrong.size}
        case "rotor_inertia":
            return {"inertia": float(wrong.size * robot.rotor_inertia[motor])}
        case "transmission_elasticity":
            rotor = robot.rotor_inertia[motor] * day.rotor[motor]
            return {
                "compliance": float(
                    wrong.size / (belts * rotor * (2 * np.pi * day.resonance[motor]) ** 2)
                )
            }
        case "backlash":
            return {"angle": wrong.size}
        case "transmission_ratio":
            return {"scale": 1.0 + wrong.size}
        case "encoder_offset":
            return {"offset": wrong.size}
        case "controller_gain":
            return {f"{k}_scale": 1.0 + wrong.size * v for k, v in wrong.shape.items()}
        case "payload":
            return {"mass": wrong.size}
        case "link_mass":
            return {
                "mass": float(
                    wrong.size
                    * next(link.mass for link in robot.links if link.name == wrong.location)
                )
            }
        case "link_com":
            return {axis: wrong.size * wrong.shape[axis] for axis in "xyz"}
        case "cogging":
            # The catalogue counts torque against the motor, cosine and sine of the angle.
            size = -float(wrong.size * robot.peak_torque[motor])
            phase = wrong.shape["phase"]
            return {
                "cosine": float(size * np.sin(phase)),
                "sine": float(size * np.cos(phase)),
                "order": wrong.shape["order"],
            }
        case "joint_spring":
            return {"stiffness": torque, "preload": -torque * wrong.shape["rest"]}
    return {}
