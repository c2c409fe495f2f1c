"""Actuator values in Isaac Lab's terms: what its `DCMotorCfg` and `ImplicitActuatorCfg` ask for.

Isaac Lab knows one motor a joint. For a robot whose motors share joints these are the limits of
each joint on its own; the box that they span is larger than what the motors can do together (see
`sizing.zonotope`), and inertia between joints is lost. Both are stated in the result.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.mjcf import mujoco_model
from hyperleg_design.sizing.envelope import motor_envelope

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign

FILE = "isaac_actuators.json"
"""Name of the file that `hyperleg build --for isaac` writes."""


def isaac_actuators(design: RobotDesign) -> dict[str, Any]:
    """Actuator values of every joint of one robot.

    Args:
        design: one robot; batches are refused.

    Returns:
        `actuators` by joint with `effort_limit` and `saturation_effort` [Nm], `velocity_limit`
        [rad/s], `stiffness` [Nm/rad], `damping` [Nms/rad], `armature` [kg m^2] (diagonal of
        M diag(J) M^T), `friction` [Nm] and `viscous_friction` [Nms/rad]; `coupled`, names of joints
        that share motors; `armature_between`, the largest entry off the diagonal [kg m^2].
        `saturation_effort` is the stall torque of all motors of the joint together.

    Raises:
        InputError: a batch of designs.
    """
    model = mujoco_model(design, floor=False)
    joints = {joint.name: joint for joint in build_tree(design).joints if not joint.fixed}
    sections = design.joint_sections
    matrix = _joint_from_motor(model, tuple(joints))
    inertia = (matrix * model.tendon_armature) @ matrix.T
    stall = np.tile(motor_envelope(design).stall_torque, matrix.shape[1])[: matrix.shape[1]]
    shared = (matrix != 0).sum(0) > 1
    actuators = {}
    for row, (name, joint) in enumerate(joints.items()):
        section = next(s for own, s in sections.items() if name == own or name.endswith(f"_{own}"))
        actuators[name] = {
            "effort_limit": float(joint.effort),
            "saturation_effort": float(np.abs(matrix[row]) @ stall),
            "velocity_limit": float(joint.velocity),
            "stiffness": float(section.stiffness),
            "damping": float(section.damping),
            "armature": float(inertia[row, row]),
            "friction": float(joint.coulomb),
            "viscous_friction": float(joint.viscous),
        }
    coupled = [n for row, n in enumerate(joints) if (matrix[row] != 0)[shared].any()]
    return {
        "design": design.name,
        "actuators": actuators,
        "coupled": coupled,
        "armature_between": float(np.abs(inertia - np.diag(np.diag(inertia))).max()),
    }


def _joint_from_motor(model: Any, joints: tuple[str, ...]) -> np.ndarray:
    """Coefficients of the model's tendons, one a motor `(n, m)` [-]."""
    places = {int(model.joint(name).id): row for row, name in enumerate(joints)}
    matrix = np.zeros((len(joints), model.ntendon))
    for tendon in range(model.ntendon):
        start = model.tendon_adr[tendon]
        for wrap in range(start, start + model.tendon_num[tendon]):
            matrix[places[int(model.wrap_objid[wrap])], tendon] += model.wrap_prm[wrap]
    return matrix
