"""The subject of anybody's MJCF or URDF."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np

from hyperleg_design.gap.model import file_drives, file_joints, robot_file
from hyperleg_design.gap.model.assembling import add_rotors, add_tendon, assembled
from hyperleg_design.gap.model.feet import feet_of
from hyperleg_design.gap.model.mechanism import mechanism_of
from hyperleg_design.gap.model.oracle import disagreements
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.model.tendons import fixed_tendons, fold_into_joints

COUPLING = "coupling {}"
"""Name of a tendon that couples joints and belongs to no motor."""
FRICTION_SPEED = 0.02
"""Width of the tanh that stands for MuJoCo's `frictionloss` [rad/s]: assumed; a sign, softened
below the speeds that logs resolve."""


def of_file(path: Path, base: str | None, known: set[str] | None) -> Subject:
    """Build the subject of an MJCF or URDF file before any log declared anything.

    Args:
        path: of the file.
        base: `fixed` or `floating`; as in the file by default.
        known: joints that logs know; others are held still. All are free by default.

    Returns:
        The subject.

    Raises:
        InputError: a file that cannot be understood, or none of its joints is known.
    """
    spec = robot_file.read_spec(path)
    imu_site = robot_file.imu_site(spec)
    base = robot_file.set_base(spec, base, path)
    stands = base == "floating" or robot_file.has_floor(spec)
    notes = robot_file.strip_scene(spec, path, contact=stands) + robot_file.mend_inertias(spec)
    all_joints = [j.name for j in spec.joints]
    free_joints = robot_file.free_joints(all_joints, known, path.name)
    whole = robot_file.compiled(spec, path)
    file_joints.refuse_negative(whole, path)
    drives = file_drives.read_drives(whole, free_joints)
    indices = [j for j in file_joints.single_joints(whole) if whole.joint(j).name in free_joints]
    notes += fold_into_joints(
        spec, fixed_tendons(whole, indices), [whole.joint(j).name for j in indices]
    )
    robot_file.strip_drives(spec)
    locked = robot_file.lock(spec, free_joints)
    if stands:
        robot_file.add_floor(spec)
    first = robot_file.compiled(spec, path)
    tree = mechanism_of(first)
    coupled = drives.names != tree.joints
    used = np.any(drives.matrix != 0, 0)
    names = tuple(n for n, u in zip(drives.names, used, strict=True) if u)
    aliases = tuple(n for n, u in zip(drives.aliases, used, strict=True) if u)
    if coupled:
        add_rotors(spec, tree.joints, names, drives.matrix[:, used], drives.rotor_inertia[used])
    inertia = drives.armature if coupled else drives.rotor_inertia
    for joint in spec.joints:
        if joint.name in tree.joints:
            joint.armature = float(inertia[tree.joints.index(joint.name)])
    for tendon in drives.couplings:
        add_tendon(spec, COUPLING.format(tendon.name), tree.joints, tendon)
    model = robot_file.compiled(spec, path)
    coulomb, viscous = file_joints.friction(model)
    spring, rest = file_joints.springs(model)
    unlimited = np.full(len(names), np.inf)
    feet, pads = feet_of(model, tree) if stands else ((), ())
    imu_rotation, imu_position = robot_file.imu_place(model, imu_site)
    subject = assembled(
        name=path.stem,
        path=path,
        design=None,
        base=base,
        model=model,
        tree=tree,
        joint_from_motor=drives.matrix[:, used],
        motors=names,
        motor_aliases=aliases,
        rotor_inertia=drives.rotor_inertia[used],
        armature=drives.armature,
        couplings=drives.couplings,
        gains=drives.gains,
        torque_limit=drives.limit[used],
        stall_torque=unlimited,
        no_load_speed=unlimited,
        coulomb=coulomb,
        viscous=viscous,
        friction_speed=FRICTION_SPEED,
        torque_constant=np.full(len(names), np.nan),
        passive=drives.passive,
        default=tree.reference.copy(),
        feet=feet,
        pads=pads,
        unlogged=locked,
        notes=(*notes, *drives.notes),
        imu_rotation=imu_rotation,
        imu_position=imu_position,
        spring=spring,
        spring_rest=rest,
        gear=drives.gear[used],
    )
    return dataclasses.replace(subject, notes=(*subject.notes, *disagreements(subject, whole)))
