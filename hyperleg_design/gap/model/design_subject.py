"""The subject of a design: its motors count before their gears, and its limits are the motors'."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.gap.model import robot_file
from hyperleg_design.gap.model.assembling import add_rotors, assembled
from hyperleg_design.gap.model.feet import pads_of
from hyperleg_design.gap.model.mechanism import mechanism_of
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.robot import transmission
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.laws.friction import FRICTION_SPEED
from hyperleg_design.robot.laws.gear import rotor_inertia
from hyperleg_design.robot.mjcf import mujoco_spec
from hyperleg_design.robot.motors import find_motor
from hyperleg_design.robot.parameters.described import RobotDesign, prefixed
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.model import simulation_spec
from hyperleg_design.sizing.envelope import motor_envelope


def of_design(design: RobotDesign, path: Path, base: str, known: set[str] | None) -> Subject:
    """Build the subject of one of our designs before any log declared anything.

    Args:
        design: one robot, of any family.
        path: of its file.
        base: `fixed` or `floating`; as in the design where empty.
        known: joints that logs know; others are held still. All are free by default.

    Returns:
        The subject. A linkage whose reduction depends on the posture has that of the default
        posture.

    Raises:
        InputError: a batch of designs, or none of its joints is known.
    """
    design_tree = build_tree(design)
    base = base or ("floating" if design_tree.floating else "fixed")
    all_joints = [j.name for j in design_tree.moving]
    free_joints = robot_file.free_joints(all_joints, known, design.name)
    spec = _spec(design, base)
    robot_file.strip_drives(spec)
    for group in (spec.sensors, spec.keys):
        for element in list(group):
            spec.delete(element)
    for joint in spec.joints:
        joint.frictionloss = 0.0
    robot_file.set_base(spec, base, path)
    locked = robot_file.lock(spec, free_joints)
    moving = [joint for joint in design_tree.moving if joint.name in free_joints]
    limbs, names = design.copies, transmission.motor_names(design)
    sections = {
        prefixed(limb, name): section
        for limb in limbs
        for name, section in design.joint_sections.items()
    }
    joint_sections = [sections[joint.name] for joint in moving]
    joint_from_motor = np.kron(np.eye(len(limbs)), transmission.joint_from_motor(design))
    joint_from_motor = joint_from_motor[[list(sections).index(joint.name) for joint in moving]]
    used = np.flatnonzero(np.any(joint_from_motor != 0, 0))
    joint_from_motor = joint_from_motor[:, used]
    motors = [prefixed(limb, name) for limb in limbs for name in names]
    used_names = tuple(motors[i] for i in used)

    def of_motors(values: np.ndarray) -> np.ndarray:
        return np.tile(np.asarray(values, float)[: len(names)], len(limbs))[used]

    rotor = of_motors(rotor_inertia(design))
    add_rotors(spec, free_joints, used_names, joint_from_motor, rotor)
    model = robot_file.compiled(spec, path)
    tree = mechanism_of(model)
    layout = layout_of(design)
    pads = tuple(
        dataclasses.replace(pad, foot=int(layout.pad_foot[layout.pads.index(pad.name)]))
        for pad in pads_of(model, tree)
    )
    envelope = motor_envelope(design)
    constants = [find_motor(str(a.motor)).torque_constant for a in design.every_actuator]
    rods = design.rod_sections if isinstance(design, TreeDesign) else ()
    notes = [f"the linkages of {', '.join(rods)} have the reductions of the default posture"]
    return assembled(
        name=design.name,
        path=path,
        design=design,
        base=base,
        model=model,
        tree=tree,
        joint_from_motor=joint_from_motor,
        motors=used_names,
        motor_aliases=used_names,
        rotor_inertia=rotor,
        armature=np.zeros(len(moving)),
        gains=np.array([[joint.stiffness, joint.damping] for joint in joint_sections], float),
        torque_limit=of_motors(envelope.peak_torque),
        stall_torque=of_motors(envelope.stall_torque),
        no_load_speed=of_motors(envelope.no_load_speed),
        coulomb=np.array([joint.coulomb for joint in moving], float),
        viscous=np.array([joint.viscous for joint in moving], float),
        friction_speed=FRICTION_SPEED,
        torque_constant=of_motors(np.array(constants)),
        passive=np.zeros(len(moving), bool),
        default=np.array([joint.default for joint in moving]),
        feet=layout.feet,
        pads=pads,
        unlogged=locked,
        notes=notes if rods else [],
        imu_rotation=np.eye(3),
        imu_position=np.zeros(3),
    )


def _spec(design: RobotDesign, base: str) -> Any:
    """A robot on a stand needs neither pads nor a floor."""
    if base == "fixed":
        return mujoco_spec(design, friction=False, floor=False)
    return simulation_spec(design)


def subject_of(design: RobotDesign, base: str = "floating") -> Subject:
    """Build the subject of one of our designs, with all joints free to move.

    Args:
        design: one robot, of any family.
        base: `fixed` or `floating`.

    Returns:
        The subject.

    Raises:
        InputError: a batch of designs.
    """
    bare = of_design(design, Path(design.source or f"{design.name}.yaml"), base, None)
    return dataclasses.replace(bare, bare=bare)
