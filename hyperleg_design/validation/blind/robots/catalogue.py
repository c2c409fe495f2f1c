"""The robots of the trials, by name: a design and one leg of it, an arm, a servo.

Masses and frames are read from the compiled MJCF, which is the robot's published description.
"""

from __future__ import annotations

from dataclasses import fields, replace
from functools import cache
from typing import Any

import numpy as np

from hyperleg_design.robot import transmission
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.mjcf import mujoco_spec
from hyperleg_design.robot.motors import motor_arrays
from hyperleg_design.robot.names import SIDES
from hyperleg_design.validation.blind.robots.chain import Chain
from hyperleg_design.validation.blind.robots.tree_links import tree_links

ARM_MJCF = """<mujoco model="bench_arm">
  <compiler angle="degree" autolimits="true"/>
  <option timestep="0.002" gravity="0 0 -9.81"/>
  <default>
    <default class="large"><joint armature="0.35" damping="1.4" frictionloss="2.2"/><motor gear="100" ctrlrange="-1.5 1.5"/></default>
    <default class="middle"><joint armature="0.16" damping="0.8" frictionloss="1.3"/><motor gear="100" ctrlrange="-0.9 0.9"/></default>
    <default class="small"><joint armature="0.045" damping="0.3" frictionloss="0.55"/><motor gear="80" ctrlrange="-0.4 0.4"/></default>
  </default>
  <worldbody>
    <body name="pedestal" pos="0 0 0.4">
      <geom type="cylinder" size="0.08 0.1" pos="0 0 -0.1" contype="0" conaffinity="0" mass="0"/>
      <body name="turret" pos="0 0 0.08">
        <inertial pos="0 -0.012 0.055" mass="3.4" diaginertia="0.0132 0.0121 0.0098"/>
        <joint class="large" name="turn" axis="0 0 1" range="-165 165"/>
        <body name="upper_arm" pos="0 0.03 0.10" euler="0 90 0">
          <inertial pos="-0.16 0.045 0" mass="4.6" diaginertia="0.0105 0.0760 0.0752"/>
          <joint class="large" name="shoulder" axis="0 1 0" range="-110 110"/>
          <body name="upper_roll" pos="-0.20 0 0">
            <inertial pos="-0.06 0.01 0.004" mass="1.9" diaginertia="0.0031 0.0082 0.0080"/>
            <joint class="middle" name="twist" axis="1 0 0" range="-160 160"/>
            <body name="forearm" pos="-0.19 0 0">
              <inertial pos="-0.11 -0.03 0.01" mass="2.3" diaginertia="0.0038 0.0210 0.0207"/>
              <joint class="middle" name="elbow" axis="0 1 0" range="-130 130"/>
              <body name="wrist_yoke" pos="-0.24 0 0">
                <inertial pos="-0.03 0.006 0" mass="1.15" diaginertia="0.0011 0.0017 0.0016"/>
                <joint class="small" name="wrist_roll" axis="1 0 0" range="-170 170"/>
                <body name="wrist" pos="-0.09 0 0">
                  <inertial pos="-0.02 0 0.012" mass="0.95" diaginertia="0.0008 0.0010 0.0009"/>
                  <joint class="small" name="wrist_bend" axis="0 0 1" range="-115 115"/>
                  <body name="flange" pos="-0.07 0 0">
                    <inertial pos="-0.03 0.004 0.002" mass="0.48" diaginertia="0.0004 0.0005 0.0005"/>
                    <joint class="small" name="flange_turn" axis="1 0 0" range="-170 170"/>
                    <geom type="cylinder" size="0.03 0.02" euler="0 90 0" contype="0" conaffinity="0" mass="0"/>
                  </body>
                </body>
              </body>
            </body>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor class="large" name="turn" joint="turn"/>
    <motor class="large" name="shoulder" joint="shoulder"/>
    <motor class="middle" name="twist" joint="twist"/>
    <motor class="middle" name="elbow" joint="elbow"/>
    <motor class="small" name="wrist_roll" joint="wrist_roll"/>
    <motor class="small" name="wrist_bend" joint="wrist_bend"/>
    <motor class="small" name="flange_turn" joint="flange_turn"/>
  </actuator>
</mujoco>
"""  # noqa: E501
"""Seven joints with torque motors behind gears, as somebody else would write them; rotor inertia
stands on the joints as `armature`, already multiplied by the squared ratio."""

SERVO_MJCF = """<mujoco model="servo_pendulum">
  <compiler angle="radian"/>
  <option timestep="0.002" gravity="0 0 -9.81"/>
  <worldbody>
    <body name="housing" pos="0 0 0.5">
      <geom type="box" size="0.02 0.02 0.02" contype="0" conaffinity="0" mass="0"/>
      <body name="arm">
        <inertial pos="0 0 -0.12" mass="0.62" diaginertia="0.0021 0.0021 0.00006"/>
        <joint name="swing" axis="0 1 0" range="-2.6 2.6" armature="0.0045" damping="0.02" frictionloss="0.05"/>
        <geom type="capsule" size="0.01" fromto="0 0 0 0 0 -0.15" contype="0" conaffinity="0" mass="0"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="swing" joint="swing" kp="6" kv="0.15" forcerange="-2.4 2.4"/>
  </actuator>
</mujoco>
"""  # noqa: E501
"""One position servo."""

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
