"""Subjects from a design of ours, and from anybody's MJCF or URDF."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.model import file_drives, file_joints, robot_file
from hyperleg_design.gap.model.mechanism import BASE, Mechanism, mechanism_of
from hyperleg_design.gap.model.oracle import disagreements
from hyperleg_design.gap.model.subject import Pad, Subject
from hyperleg_design.gap.model.tendons import Tendon, fixed_tendons, fold_into_joints

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design

COUPLING = "coupling {}"
"""Name of a tendon that couples joints and belongs to no motor."""
FRICTION_SPEED = 0.02
"""Width of the tanh that stands for MuJoCo's `frictionloss` [rad/s]: assumed; a sign, softened
below the speeds that logs resolve."""


def of_design(design: Design, path: Path, base: str, known: set[str] | None) -> Subject:
    """Build the subject of one of our designs before any log declared anything.

    Args:
        design: one robot.
        path: of its file.
        base: `fixed` or `floating`.
        known: joints that logs know; others are held still. All are free by default.

    Returns:
        The subject.

    Raises:
        InputError: a batch of designs, or none of its joints is known.
    """
    from hyperleg_design.robot import transmission
    from hyperleg_design.robot.friction import FRICTION_SPEED as DESIGN_FRICTION_SPEED
    from hyperleg_design.robot.gear import rotor_inertia
    from hyperleg_design.robot.motors import find_motor
    from hyperleg_design.robot.names import ACTUATOR_OF_MOTOR, SIDES
    from hyperleg_design.robot.tree import build_tree
    from hyperleg_design.simulation.model import simulation_spec
    from hyperleg_design.sizing.envelope import motor_envelope

    moving = [j for j in build_tree(design).moving if known is None or j.name in known]
    every = [j.name for j in build_tree(design).moving]
    if not moving:
        raise InputError(
            design.name,
            "joints",
            sorted(known or ())[:8],
            f"are joints of another robot; its own are {', '.join(every)}",
        )
    matrix, names = transmission.joint_from_motor(design), transmission.motor_names(design)
    full = np.kron(np.eye(2), matrix)
    kept = [every.index(j.name) for j in moving]
    motors = [f"{side}_{name}" for side in SIDES for name in names]
    used = np.flatnonzero(np.any(full[kept] != 0, 0))
    envelope = motor_envelope(design)

    def of_motors(values: np.ndarray) -> np.ndarray:
        return np.tile(np.asarray(values, float)[: len(names)], 2)[used]

    constants = [
        find_motor(str(getattr(design.actuators, ACTUATOR_OF_MOTOR[i]).motor)).torque_constant
        for i in range(len(names))
    ]
    full = full[np.array(kept)][:, used]
    spec = simulation_spec(design)
    robot_file.strip_drives(spec)
    for group in (spec.sensors, spec.keys):
        for item in list(group):
            spec.delete(item)
    for joint in spec.joints:
        joint.frictionloss = 0.0
    robot_file.set_base(spec, base, path)
    held = robot_file.lock(spec, [j.name for j in moving])
    rotor = of_motors(rotor_inertia(design))
    used_names = tuple(motors[i] for i in used)
    _add_rotors(spec, [j.name for j in moving], used_names, full, rotor)
    joints = {j.name: getattr(design.joints, j.name.split("_", 1)[1]) for j in moving}
    model = robot_file.compiled(spec, path)
    tree = mechanism_of(model)
    pads = _pads(model, tree)
    feet = tuple(f"{side}_foot" for side in SIDES)
    pads = tuple(dataclasses.replace(p, foot=0 if p.name.startswith(SIDES[0]) else 1) for p in pads)
    return _assembled(
        name=design.name,
        path=path,
        design=design,
        base=base,
        model=model,
        tree=tree,
        matrix=full,
        motors=used_names,
        aliases=used_names,
        rotor=rotor,
        armature=np.zeros(len(moving)),
        gains=np.array([[j.stiffness, j.damping] for j in joints.values()], float),
        limit=of_motors(envelope.peak_torque),
        stall=of_motors(envelope.stall_torque),
        free=of_motors(envelope.no_load_speed),
        coulomb=np.array([j.coulomb for j in moving], float),
        viscous=np.array([j.viscous for j in moving], float),
        width=DESIGN_FRICTION_SPEED,
        constant=of_motors(np.array(constants)),
        passive=np.zeros(len(moving), bool),
        default=np.array([j.default for j in moving]),
        feet=feet,
        pads=pads,
        held=held,
        notes=(),
        imu=(np.eye(3), np.zeros(3)),
    )


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
    notes = robot_file.strip_scene(spec, path, contact=base == "floating")
    every = [j.name for j in spec.joints]
    if known is not None and not known & set(every):
        raise InputError(
            path.name,
            "joints",
            sorted(known)[:8],
            f"are joints of another robot; its own are {', '.join(every)}",
        )
    kept = every if known is None else known
    whole = robot_file.compiled(spec, path)
    drives = file_drives.read_drives(whole, kept)
    indices = [j for j in file_joints.single_joints(whole) if whole.joint(j).name in kept]
    notes += fold_into_joints(
        spec, fixed_tendons(whole, indices), [whole.joint(j).name for j in indices]
    )
    robot_file.strip_drives(spec)
    held = robot_file.lock(spec, every if known is None else known)
    if base == "floating":
        robot_file.add_floor(spec)
    first = robot_file.compiled(spec, path)
    tree = mechanism_of(first)
    coupled = drives.names != tree.joints
    used = np.any(drives.matrix != 0, 0)
    if coupled:
        _add_rotors(
            spec,
            tree.joints,
            [n for n, u in zip(drives.names, used, strict=True) if u],
            drives.matrix[:, used],
            drives.rotor_inertia[used],
        )
    inertia = drives.armature if coupled else drives.rotor_inertia
    for joint in spec.joints:
        if joint.name in tree.joints:
            joint.armature = float(inertia[tree.joints.index(joint.name)])
    for tendon in drives.couplings:
        _add_tendon(spec, COUPLING.format(tendon.name), tree.joints, tendon)
    model = robot_file.compiled(spec, path)
    coulomb, viscous = file_joints.friction(model)
    spring, rest = file_joints.springs(model)
    names = tuple(n for n, u in zip(drives.names, used, strict=True) if u)
    aliases = tuple(n for n, u in zip(drives.aliases, used, strict=True) if u)
    unlimited = np.full(len(names), np.inf)
    feet, pads = _feet_of_file(model, tree) if base == "floating" else ((), ())
    subject = _assembled(
        name=path.stem,
        path=path,
        design=None,
        base=base,
        model=model,
        tree=tree,
        matrix=drives.matrix[:, used],
        motors=names,
        aliases=aliases,
        rotor=drives.rotor_inertia[used],
        armature=drives.armature,
        couplings=drives.couplings,
        gains=drives.gains,
        limit=drives.limit[used],
        stall=unlimited,
        free=unlimited,
        coulomb=coulomb,
        viscous=viscous,
        width=FRICTION_SPEED,
        constant=np.full(len(names), np.nan),
        passive=drives.passive,
        default=tree.reference.copy(),
        feet=feet,
        pads=pads,
        held=held,
        notes=(*notes, *drives.notes),
        imu=robot_file.imu_place(model, imu_site),
        spring=spring,
        rest=rest,
        gear=drives.gear[used],
    )
    return dataclasses.replace(subject, notes=(*subject.notes, *disagreements(subject, whole)))


def _assembled(
    *,
    path: Path,
    model: Any,
    tree: Mechanism,
    matrix: np.ndarray,
    rotor: np.ndarray,
    armature: np.ndarray,
    couplings: Sequence[Tendon] = (),
    **v: Any,
) -> Subject:
    count = tree.count
    file_joints.take_out_friction(model)
    low, high = file_joints.limits(model)
    notes = list(v["notes"])
    if v["held"]:
        notes.append(
            f"joints in no log, held still where the model draws them: {', '.join(v['held'])}"
        )
    subject = Subject(
        name=v["name"],
        path=str(path),
        design=v["design"],
        base=v["base"],
        gravity=np.array(model.opt.gravity),
        joints=tree.joints,
        motors=v["motors"],
        motor_aliases=v["aliases"],
        feet=v["feet"],
        pads=v["pads"],
        joint_from_motor=matrix,
        gains=v["gains"],
        gear=v.get("gear", np.ones(len(v["motors"]))),
        torque_limit=v["limit"],
        stall_torque=v["stall"],
        no_load_speed=v["free"],
        rotor_inertia=rotor,
        armature=(matrix * rotor) @ matrix.T
        + np.diag(armature)
        + sum((tendon.inertia for tendon in couplings), np.zeros((count, count))),
        coulomb=v["coulomb"],
        viscous=v["viscous"],
        friction_speed=np.full(count, float(v["width"])),
        spring=v.get("spring", np.zeros(count)),
        spring_rest=v.get("rest", np.zeros(count)),
        torque_constant=v["constant"],
        supply=np.full(len(v["motors"]), np.nan),
        passive=v["passive"],
        position_low=low,
        position_high=high,
        default=v["default"],
        model=model,
        tree=tree,
        imu_rotation=v["imu"][0],
        imu_position=v["imu"][1],
        unlogged=v["held"],
        notes=tuple(notes),
        declared=Metadata(),
        bare=None,
    )
    for value in vars(subject).values():
        if isinstance(value, np.ndarray):
            value.setflags(write=False)
    return subject


def _add_rotors(
    spec: Any, joints: Sequence[str], motors: Sequence[str], matrix: np.ndarray, rotor: np.ndarray
) -> None:
    """Rotors of coupled motors, one fixed tendon each."""
    for column, motor in enumerate(motors):
        tendon = spec.add_tendon(name=motor, armature=rotor[column])
        for row in np.flatnonzero(matrix[:, column]).tolist():
            tendon.wrap_joint(joints[row], matrix[row, column])


def _add_tendon(spec: Any, name: str, joints: Sequence[str], tendon: Tendon) -> None:
    """Put a tendon with its armature alone into a model."""
    added = spec.add_tendon(name=name, armature=tendon.armature)
    for row in np.flatnonzero(tendon.coefficients).tolist():
        added.wrap_joint(joints[row], float(tendon.coefficients[row]))


def _pads(model: Any, tree: Mechanism, feet: Mapping[str, int] | None = None) -> tuple[Pad, ...]:
    """Spheres, ends of capsules and corners of boxes that collide on moving links.

    Args:
        model: compiled.
        tree: of the same robot.
        feet: foot of each link that belongs to one; by default all links do, to the first.
    """
    import mujoco

    found = []
    for geom in range(model.ngeom):
        name = model.body(int(model.geom_bodyid[geom])).name
        if name not in tree.links or not (model.geom_contype[geom] or model.geom_conaffinity[geom]):
            continue
        sphere = model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_SPHERE
        if feet is not None and (name not in feet or (feet[name] < 0 and not sphere)):
            continue
        foot = 0 if feet is None else feet[name] if feet[name] >= 0 else -1 - feet[name]
        points, radius = robot_file.touching_points(model, geom)
        label = model.geom(geom).name or f"{name}_{geom}"
        for index, point in enumerate(points):
            title = label if len(points) == 1 else f"{label}_{index}"
            found.append(
                Pad(
                    title,
                    foot,
                    tree.links.index(name),
                    (float(point[0]), float(point[1]), float(point[2])),
                    radius,
                )
            )
    return tuple(found)


def _feet_of_file(model: Any, tree: Mechanism) -> tuple[tuple[str, ...], tuple[Pad, ...]]:
    """Feet: the outermost links with shapes that collide; spheres further up the same limb are pads
    of that foot too.
    """
    names = [model.body(b).name for b in range(model.nbody)]
    touching = {
        int(b)
        for b, *kinds in zip(
            model.geom_bodyid, model.geom_contype, model.geom_conaffinity, strict=True
        )
        if any(kinds)
    }

    def limb(body: int) -> bool:
        return names[body] in tree.links and tree.link_joint[tree.links.index(names[body])] != BASE

    feet: list[str] = []
    foot_of: dict[str, int] = {}
    for leaf in sorted(set(range(1, model.nbody)) - set(model.body_parentid.tolist())):
        body = leaf
        while body and body not in touching:
            body = int(model.body_parentid[body])
        if not limb(body) or names[body] in feet:
            continue
        foot_of[names[body]] = len(feet)
        above = int(model.body_parentid[body])
        while limb(above):
            foot_of.setdefault(names[above], -1 - len(feet))  # below zero: spheres only
            above = int(model.body_parentid[above])
        feet.append(names[body])
    return tuple(feet), _pads(model, tree, foot_of)


def subject_of(design: Design, base: str = "floating") -> Subject:
    """Build the subject of one of our designs, with all joints free to move.

    Args:
        design: one robot.
        base: `fixed` or `floating`.

    Returns:
        The subject.

    Raises:
        InputError: a batch of designs.
    """
    bare = of_design(design, Path(design.source or f"{design.name}.yaml"), base, None)
    return dataclasses.replace(bare, bare=bare)
