"""The robots of the trials, by name: a design and one leg of it, an arm, a servo.

Masses and frames are read from the compiled MJCF, which is the robot's published description.
"""

from __future__ import annotations

from dataclasses import fields, replace
from functools import cache
from typing import Any

import numpy as np

from hyperleg_design.validation.blind.robots.arm import ARM_MJCF, SERVO_MJCF
from hyperleg_design.validation.blind.robots.chain import Chain
from hyperleg_design.validation.blind.robots.tree_links import tree_links

ROBOTS = ("hyperleg", "leg", "arm", "servo")
"""Names that `chain` knows; `leg` is the left one of `hyperleg`."""

ROBOT_FILE = "robot.xml"
"""Name of the MJCF that lies beside the logs of a robot that is no design."""
RIG_POSTURE = {
    "hip_yaw": -0.1,
    "hip_roll": 0.3,
    "hip_pitch": -0.3,
    "knee": 0.9,
    "ankle_pitch": 0.0,
    "ankle_roll": 0.0,
    "toe": -0.35,
}
"""Middle of the motions of a leg in the air [rad]: away from every limit."""


@cache
def chain(name: str) -> Chain:
    """A robot of `ROBOTS`.

    Args:
        name: of the robot.

    Returns:
        The robot.

    Raises:
        ValueError: no such robot.
    """
    if name == "hyperleg":
        return _design(name)
    if name == "leg":
        return _half(_design("hyperleg"))
    if name == "arm":
        return _arm()
    if name == "servo":
        return _servo()
    raise ValueError(f"no robot {name!r}; there are {', '.join(ROBOTS)}")


def _design(name: str) -> Chain:
    from hyperleg_design.robot import transmission
    from hyperleg_design.robot.design import load_design
    from hyperleg_design.robot.mjcf import mujoco_spec
    from hyperleg_design.robot.motors import motor_arrays
    from hyperleg_design.robot.names import SIDES

    design = load_design(name)
    model = mujoco_spec(design, floor=False).compile()
    links = tree_links(model)
    matrix = transmission.joint_from_motor(design)
    rows, columns = matrix.shape
    constants, names = motor_arrays(design), transmission.motor_names(design)
    order = [f"{side}_{joint}" for side in SIDES for joint in transmission.joint_names(design)]
    if [link.joint for link in links] != order:
        raise RuntimeError("the design's joints come in another order than its legs")
    both = np.zeros((2 * rows, 2 * columns))
    both[:rows, :columns] = both[rows:, columns:] = matrix
    of_joints = [getattr(design.joints, joint) for joint in transmission.joint_names(design)]

    def twice(values: Any) -> np.ndarray:
        return np.tile(np.asarray(values, float)[:columns], 2)

    return Chain(
        name=name,
        links=links,
        motors=tuple(f"{side}_{motor}" for side in SIDES for motor in names),
        joint_from_motor=both,
        rotor_inertia=twice(constants.rotor_inertia),
        coulomb=np.tile([j.coulomb for j in of_joints], 2),
        viscous=np.tile([j.viscous for j in of_joints], 2),
        stiffness=np.tile([j.stiffness for j in of_joints], 2),
        damping=np.tile([j.damping for j in of_joints], 2),
        peak_torque=twice(constants.peak_torque),
        stall_torque=twice(constants.stall_torque),
        no_load_speed=twice(constants.no_load_speed),
        # No data sheet of the design's motors is at hand for this: a winding of 48 V at its no-load
        # speed (assumed).
        torque_constant=twice(48.0 / constants.no_load_speed),
        low=np.tile(np.radians([j.lower_deg for j in of_joints]), 2),
        high=np.tile(np.radians([j.upper_deg for j in of_joints]), 2),
        rest=np.tile([RIG_POSTURE[joint] for joint in transmission.joint_names(design)], 2),
        voltage=48.0,
        mjcf=None,
        robot=name,
    )


def _half(both: Chain) -> Chain:
    n, m = (size // 2 for size in both.joint_from_motor.shape)
    cut = {field.name: getattr(both, field.name) for field in fields(both)}
    halves: dict[str, Any] = {
        key: value[: (m if value.size == 2 * m and key in _OF_MOTORS else n)]
        for key, value in cut.items()
        if isinstance(value, np.ndarray) and value.ndim == 1
    }
    return replace(
        both,
        links=both.links[:n],
        motors=both.motors[:m],
        joint_from_motor=both.joint_from_motor[:n, :m],
        **halves,
    )


_OF_MOTORS = ("rotor_inertia", "peak_torque", "stall_torque", "no_load_speed", "torque_constant")


def _arm() -> Chain:
    import mujoco

    model = mujoco.MjModel.from_xml_string(ARM_MJCF)
    gear = model.actuator_gear[:, 0]
    peak = model.actuator_ctrlrange[:, 1] * gear
    # Drive modules speak of their output: torque, speed and inertia behind the gear, amperes of the
    # motor.
    return Chain(
        name="arm",
        links=tree_links(model),
        motors=tuple(model.actuator(i).name for i in range(model.nu)),
        joint_from_motor=np.eye(model.nu),
        rotor_inertia=model.dof_armature.copy(),
        coulomb=model.dof_frictionloss.copy(),
        viscous=model.dof_damping.copy(),
        stiffness=np.array([900.0, 1200.0, 400.0, 500.0, 90.0, 90.0, 60.0]),
        damping=np.array([40.0, 50.0, 14.0, 16.0, 2.5, 2.5, 1.8]),
        peak_torque=peak,
        stall_torque=3.0 * peak,
        no_load_speed=np.array([9.0, 9.0, 9.0, 9.0, 13.0, 13.0, 13.0]),
        torque_constant=np.array([0.11, 0.11, 0.10, 0.10, 0.06, 0.06, 0.06]) * gear,
        low=model.jnt_range[:, 0].copy(),
        high=model.jnt_range[:, 1].copy(),
        rest=np.array([0.1, -0.5, 0.2, 0.7, 0.1, 0.4, 0.0]),
        voltage=48.0,
        mjcf=ARM_MJCF,
        robot=ROBOT_FILE,
    )


def _servo() -> Chain:
    import mujoco

    model = mujoco.MjModel.from_xml_string(SERVO_MJCF)
    return Chain(
        name="servo",
        links=tree_links(model),
        motors=("swing",),
        joint_from_motor=np.eye(1),
        rotor_inertia=model.dof_armature.copy(),
        coulomb=model.dof_frictionloss.copy(),
        viscous=model.dof_damping.copy(),
        stiffness=np.array([6.0]),
        damping=np.array([0.15]),
        peak_torque=np.array([2.4]),
        stall_torque=np.array([2.8]),
        no_load_speed=np.array([14.0]),
        torque_constant=np.array([1.1]),
        low=model.jnt_range[:, 0].copy(),
        high=model.jnt_range[:, 1].copy(),
        rest=np.array([0.2]),
        voltage=12.0,
        mjcf=SERVO_MJCF,
        robot=ROBOT_FILE,
    )
