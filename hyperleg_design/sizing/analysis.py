"""The analysis of one design in one object: masses, reductions, torques, speeds, inertia, envelope,
confound.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot import ablation, transmission
from hyperleg_design.robot.checks.consistency import leg_length
from hyperleg_design.robot.masses import mass_table
from hyperleg_design.robot.models import leg_reflected_inertia
from hyperleg_design.robot.motors import find_motor
from hyperleg_design.robot.names import ACTUATOR_OF_MOTOR, POSTURES
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.sizing import zonotope
from hyperleg_design.sizing.envelope import motor_envelope
from hyperleg_design.sizing.tree_analysis import analyze_tree

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design
    from hyperleg_design.robot.parameters.described import RobotDesign

SCHEMA = 1
"""Version of the object that `analyze` returns."""

BELOW_HIP = slice(3, None)
"""Joints and motors that share torque: knee, ankle pitch, ankle roll and toe, where it moves."""


def analyze(design: RobotDesign) -> dict[str, Any]:
    """Analyse one design: masses, reductions, torques, speeds, reflected inertia and envelope.

    Args:
        design: one robot; batches are refused.

    Returns:
        Plain numbers, lists and mappings, SI units, ready for JSON: `total_mass`, `leg_mass` [kg],
        `leg_length`, `height` [m], `segment_mass` [kg], `reduction` by posture (joints x motors),
        `max_joint_torque` [Nm] by joint (standing, derated, as Table I), `single_joint_speed`
        [rad/s] (walking), `torque_alone` [Nm] by joint (walking, the others at zero, not derated),
        `joint_limits` (the joints under one convention, which it states),
        `reflected_inertia` [kg m^2] in the design's posture, `zonotope_to_box_volume` of the joints
        below the hip (walking, zero speed), `motors`, `ablation_confound`. Of a design that writes
        its tree out, what `tree_analysis.analyze_tree` returns.

    Raises:
        InputError: a batch of designs, or a passive toe.
    """
    if isinstance(design, TreeDesign):
        return analyze_tree(design)
    design = cast("Design", design)
    if design.batch_shape:
        raise InputError(design.name, "", None, "holds a batch of designs; take one of them")
    if design.toe.joint == "passive":
        remedy = "needs a motor for every joint that moves; a toe on a spring is simulated only"
        raise InputError(design.name, "toe.joint", design.toe.joint, remedy)
    table = mass_table(design)
    joints = transmission.joint_names(design)
    matrix = {posture: transmission.joint_from_motor(design, posture) for posture in POSTURES}
    envelope = motor_envelope(design)
    below = matrix["walking"][BELOW_HIP, BELOW_HIP]
    limit = envelope.standstill_torque
    alone = [float(zonotope.alone(matrix["walking"], -limit, limit, i)) for i in range(len(joints))]
    return {
        "schema": SCHEMA,
        "design": design.name,
        "variant": design.variant,
        "total_mass": float(table.total),
        "leg_mass": float(table.leg),
        "leg_length": float(leg_length(design)),
        "height": float(leg_length(design) + design.pelvis.height),
        "segment_mass": {
            s: float(getattr(table, s)) for s in ("pelvis", "thigh", "shank", "foot", "toe")
        },
        "joints": list(joints),
        "motors": _motors(design),
        "posture": str(design.transmission.posture),
        "reduction": {posture: m.tolist() for posture, m in matrix.items()},
        "max_joint_torque": _named(joints, transmission.max_joint_torque(design)),
        "single_joint_speed": _named(joints, transmission.single_joint_speed(design)),
        "torque_alone": _named(joints, np.array(alone)),
        "joint_limits": _joint_limits(design, joints, matrix["walking"], np.array(alone)),
        "reflected_inertia": leg_reflected_inertia(design).tolist(),
        "zonotope_to_box_volume": float(
            zonotope.zonotope_to_box_volume(below, -limit[BELOW_HIP], limit[BELOW_HIP])
        ),
        "ablation_confound": ablation.confound(design) if design.variant == "toe" else None,
    }


def _joint_limits(
    design: Design, joints: tuple[str, ...], matrix: np.ndarray, alone: np.ndarray
) -> dict[str, Any]:
    """What each joint can do under one convention: walking posture, motors at standstill with
    their largest torque, nothing derated.
    """
    envelope = motor_envelope(design)
    limit = envelope.standstill_torque
    motors = "at peak torque"
    if np.any(limit < envelope.peak_torque):
        motors = "at peak torque or at the stall torque where that is smaller"
    return {
        "convention": f"walking, at standstill, motors {motors}, not derated",
        "max_torque": _named(joints, transmission.joint_torque(np.abs(matrix), limit)),
        "torque_alone": _named(joints, alone),
        "speed": _named(joints, transmission.single_joint_speed(design, "walking")),
        "reflected_inertia": _named(joints, np.diag(leg_reflected_inertia(design, "walking"))),
    }


def _named(joints: tuple[str, ...], values: np.ndarray) -> dict[str, float]:
    return dict(zip(joints, values.tolist(), strict=True))


def _motors(design: Design) -> dict[str, Any]:
    kind = str(design.electrical.constants)
    corner = motor_envelope(design).corner_speed
    motors = {}
    names = zip(transmission.motor_names(design), ACTUATOR_OF_MOTOR, strict=False)
    for column, (name, actuator) in enumerate(names):
        motor = find_motor(str(getattr(design.actuators, actuator).motor))
        motors[name] = {
            "motor": motor.name,
            "gear": float(getattr(design.actuators, actuator).gear),
            "no_load_speed": motor.no_load_speed(kind) * design.electrical.voltage_ratio,
            "peak_torque": motor.peak_torque(kind),
            "rated_torque": motor.rated_torque,
            "stall_torque": motor.stall_torque(kind) * design.electrical.voltage_ratio,
            "corner_speed": float(corner[column]),
            "power_constant": motor.power_constant(kind),
            "motor_constant": motor.motor_constant(kind),
            "rotor_inertia": motor.rotor_inertia,
            "mass": motor.mass,
        }
    return motors
