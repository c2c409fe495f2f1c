"""A robot from somebody else's MJCF or URDF: what its drives are, and a bare model of it for
inverse dynamics and replays.

Drawing shapes go, and missing mesh files with them, as long as the masses do not depend on them.
Drives are read from the file's actuators and then taken out: replays apply torques themselves.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError, in_short
from hyperleg_design.gap.model.tendons import Tendon, fixed_tendons

ANGLE_TRANSMISSIONS = ("mjTRN_JOINT", "mjTRN_JOINTINPARENT", "mjTRN_TENDON")
"""Kinds of transmission whose torque per unit of force does not change with posture, as long as the
tendon is fixed."""

SMALLEST_MASS = 1e-6
SMALLEST_INERTIA = 1e-9
"""Given to moving links of a file that have none [kg, kg m^2], as MuJoCo needs some."""


@dataclass(frozen=True, eq=False)
class Drives:
    """Drives that a file states; joints and motors are one to one unless motors are coupled."""

    names: tuple[str, ...]
    """Of the motors `(m,)`: of the joints where they are one to one."""
    aliases: tuple[str, ...]
    """Names of the actuators in the file, the motors' own where it has none `(m,)`."""
    matrix: np.ndarray
    """Joint torque of motor torque `(n, m)`."""
    gear: np.ndarray
    """Of the actuators over their joints where they are one to one, whose motors count at the
    joint; else 1 `(m,)`."""
    gains: np.ndarray
    """Stiffness and damping of the joint controllers, NaN where the file states none `(n, 2)`
    [Nm/rad, Nms/rad]."""
    limit: np.ndarray
    """Largest motor torque, infinite where unstated `(m,)` [Nm]."""
    rotor_inertia: np.ndarray
    """At the motor `(m,)` [kg m^2]."""
    armature: np.ndarray
    """Further inertia about each joint that is no rotor of a coupled motor `(n,)` [kg m^2]."""
    couplings: tuple[Tendon, ...]
    """Tendons whose armature couples joints and belongs to no motor's rotor."""
    passive: np.ndarray
    """Joints without a drive, in a file that drives others `(n,)`."""
    notes: tuple[str, ...]


def read_spec(path: Path) -> Any:
    """Read an editable MuJoCo model from an MJCF or URDF file.

    Args:
        path: of the file.

    Returns:
        The specification.

    Raises:
        InputError: no such file, or not one of the two.
    """
    import mujoco

    if not path.is_file():
        raise InputError(str(path), "", None, "no such file")
    try:
        spec = mujoco.MjSpec.from_file(str(path))
    except (ValueError, RuntimeError) as error:
        raise InputError(
            str(path), "", None, f"is neither MJCF nor URDF that MuJoCo can read: {_line(error)}"
        ) from None
    spec.compiler.fusestatic = False
    for index, joint in enumerate(spec.joints):
        joint.name = joint.name or f"joint_{index}"
    for index, body in enumerate(spec.bodies):
        body.name = body.name or f"body_{index}"
        if (
            body.explicitinertial
            and not body.mass
            and not np.nan_to_num(np.asarray(body.fullinertia)).any()
        ):
            body.fullinertia, body.inertia = [np.nan] * 6, [0.0] * 3
    return spec


def strip_scene(spec: Any, path: Path, *, contact: bool) -> list[str]:
    """Take out what inverse dynamics and replays do not need.

    Args:
        spec: model, changed in place.
        path: for messages.
        contact: keep primitive shapes that collide.

    Returns:
        Notes on what was taken out and matters.

    Raises:
        InputError: masses follow from mesh files that are missing.
    """
    import mujoco

    notes = []
    if len(spec.equalities):
        notes.append(
            f"{len(spec.equalities)} equality constraints (closed loops, mimic joints) are left out"
        )
    for group in (
        spec.sensors,
        spec.equalities,
        spec.keys,
        spec.pairs,
        spec.cameras,
        spec.skins,
        spec.flexes,
        spec.tuples,
    ):
        for item in list(group):
            spec.delete(item)
    from_geoms = int(spec.compiler.inertiafromgeom) == int(
        mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE
    )
    needed = set()
    for body in spec.bodies:
        weighed = (
            body is spec.worldbody
            or body.name == "world"
            or (bool(body.explicitinertial) and not from_geoms)
        )
        for geom in list(body.geoms):
            mesh = geom.type in (
                mujoco.mjtGeom.mjGEOM_MESH,
                mujoco.mjtGeom.mjGEOM_SDF,
                mujoco.mjtGeom.mjGEOM_HFIELD,
            )
            touches = contact and not mesh and (geom.contype or geom.conaffinity)
            if weighed and not touches:
                spec.delete(geom)
                continue
            if mesh:
                needed.add(geom.meshname)
                geom.contype = geom.conaffinity = 0
            elif not contact:
                geom.contype = geom.conaffinity = 0
            geom.material = ""
    for group in (spec.materials, spec.textures, spec.hfields):
        for item in list(group):
            spec.delete(item)
    for mesh in list(spec.meshes):
        if mesh.name not in needed:
            spec.delete(mesh)
    return notes


def compiled(spec: Any, path: Path) -> Any:
    """Compile a model, and repair small errors of its numbers where MuJoCo refuses it.

    Args:
        spec: the specification, which the repairs change.
        path: for error messages.

    Returns:
        The compiled model.

    Raises:
        InputError: MuJoCo refuses it, for a missing mesh perhaps.
    """
    remedy = "mend the file"
    for repair in ("", "balance", "bound"):
        if repair == "balance":  # numbers rounded in a drawing program break A + B >= C by a little
            spec.compiler.balanceinertia = True
        elif repair == "bound":  # links without mass at a chain's end
            spec.compiler.boundmass, spec.compiler.boundinertia = SMALLEST_MASS, SMALLEST_INERTIA
        try:
            return spec.compile()
        except (ValueError, RuntimeError) as error:
            message = _line(error)
        if "inertia" not in message:
            break
    if "file" in message or "mesh" in message:
        remedy = "put the file there, or give each body an inertial"
    raise InputError(str(path), "", None, f"cannot be compiled: {message}; {remedy}")


def set_base(spec: Any, wanted: str | None, path: Path) -> str:
    """Weld or free the root as the logs state.

    Loose bodies beside the robot (things to grasp) are taken out.

    Args:
        spec: the specification, which is changed.
        wanted: `fixed` or `floating`; as in the file by default.
        path: for error messages.

    Returns:
        What the base now is, `fixed` or `floating`.

    Raises:
        InputError: the file has no joint, or its root cannot be freed or welded.
    """
    import mujoco

    free = mujoco.mjtJoint.mjJNT_FREE
    roots = [b for b in spec.worldbody.bodies if _joints_below(b)]
    if not roots:
        raise InputError(str(path), "", None, "has no joint")
    robot = max(roots, key=_joints_below)
    for body in list(spec.worldbody.bodies):
        if (
            body is not robot
            and body.name != robot.name
            and any(j.type == free for j in body.joints)
        ):
            spec.delete(body)
    own = [j for j in robot.joints if j.type == free]
    if wanted == "fixed" and own:
        for joint in own:
            spec.delete(joint)
        return "fixed"
    if wanted == "floating" and not own:
        if list(robot.joints):
            raise InputError(
                str(path),
                "base",
                "floating",
                f"its root, {robot.name}, hangs on a joint; give the file a root link that can "
                f"float",
            )
        robot.add_freejoint(name="floating_base")
        return "floating"
    return "floating" if own else "fixed"


def _joints_below(body: Any) -> int:
    return len(list(body.joints)) + sum(_joints_below(b) for b in body.bodies)


def read_drives(model: Any, kept: Collection[str]) -> Drives:
    """Read the drives of a compiled file.

    Args:
        model: the compiled model.
        kept: names of the joints that are kept.

    Returns:
        Drives over these joints, in the model's order.
    """
    import mujoco

    single = [j for j in single_joints(model) if _name(model, j) in kept]
    joints, dofs = (
        tuple(_name(model, j) for j in single),
        np.array([model.jnt_dofadr[j] for j in single]),
    )
    count = len(joints)
    notes: list[str] = []
    moment = _moment(model)
    tendons = fixed_tendons(model, single)
    found = []
    for index in range(model.nu):
        kind = mujoco.mjtTrn(model.actuator_trntype[index]).name
        wraps_sites = kind == "mjTRN_TENDON" and not _is_fixed_tendon(
            model, int(model.actuator_trnid[index, 0])
        )
        if kind not in ANGLE_TRANSMISSIONS or wraps_sites:
            notes.append(
                f"actuator {model.actuator(index).name} acts through {kind}, whose lever changes "
                f"with posture: left out"
            )
        elif np.any(moment[index, dofs]):
            found.append(index)
    usable = np.array(found, int)
    matrix = moment[usable][:, dofs].T
    names = [model.actuator(i).name or f"actuator_{i}" for i in usable]
    limit = np.array([_force_limit(model, i) for i in usable])
    stiffness, damping = np.array([_feedback(model, i) for i in usable]).reshape(-1, 2).T
    armature = model.dof_armature[dofs]
    effort = np.array(
        [
            max(abs(model.jnt_actfrcrange[j])) if model.jnt_actfrclimited[j] else np.inf
            for j in single
        ]
    )
    gains = np.full((count, 2), np.nan)
    if np.all(np.count_nonzero(matrix, 0) <= 1):
        own = matrix != 0
        driven = own.any(1) if found else np.ones(count, bool)
        servo = (own & (stiffness > 0)).any(1)
        for column, values in enumerate((stiffness, damping)):
            gains[servo, column] = (matrix[servo] ** 2 * values).sum(1)
        reached = np.where(own, np.abs(matrix), 0.0)
        total = (
            np.array([sum(r * f for r, f in zip(row, limit, strict=True) if r) for row in reached])
            if found
            else np.full(count, np.inf)
        )
        rotor = armature + matrix**2 @ model.actuator_armature[usable]
        for tendon in tendons:
            rotor = rotor + (np.diag(tendon.inertia) if tendon.single else 0.0)
        alias = [next((names[a] for a in np.flatnonzero(own[j])), joints[j]) for j in range(count)]
        gear = np.array(
            [float(matrix[j, own[j]][0]) if own[j].sum() == 1 else 1.0 for j in range(count)]
        )
        return Drives(
            joints,
            tuple(alias),
            np.eye(count),
            gear,
            gains,
            np.minimum(total, effort),
            rotor,
            np.zeros(count),
            tuple(t for t in tendons if t.armature and not t.single),
            ~driven,
            tuple(notes),
        )
    rotor = np.array(model.actuator_armature[usable])
    couplings = []
    for tendon in tendons:
        pulling = [
            place
            for place, i in enumerate(usable)
            if model.actuator_trntype[i] == mujoco.mjtTrn.mjTRN_TENDON
            and model.actuator_trnid[i, 0] == tendon.index
        ]
        if len(pulling) == 1:  # the motor turns gear times as fast as the tendon lengthens
            ratio = float(model.actuator_gear[usable[pulling[0]], 0])
            rotor[pulling[0]] += tendon.armature / ratio**2
        elif tendon.single:
            armature = armature + np.diag(tendon.inertia)
        elif tendon.armature:
            couplings.append(tendon)
    return Drives(
        tuple(names),
        tuple(names),
        matrix,
        np.ones(len(names)),
        gains,
        limit,
        rotor,
        armature,
        tuple(couplings),
        np.zeros(count, bool),
        tuple(notes),
    )


def single_joints(model: Any) -> list[int]:
    """List the joints that are hinges or slides.

    Args:
        model: the compiled model.

    Returns:
        Their indices.
    """
    return [int(joint) for joint in _single(model)[0]]


def strip_drives(spec: Any) -> None:
    """Take out actuators and tendons.

    Args:
        spec: the specification, which is changed.
    """
    for group in (spec.actuators, spec.tendons):
        for item in list(group):
            spec.delete(item)


def lock(spec: Any, kept: Collection[str]) -> tuple[str, ...]:
    """Weld joints that no log knows, at the position in which the file draws them.

    Args:
        spec: the specification, which is changed.
        kept: names of the joints that stay free.

    Returns:
        Names of the welded joints.
    """
    import mujoco

    locked = []
    for joint in list(spec.joints):
        if (
            joint.type in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE)
            and joint.name not in kept
        ):
            locked.append(joint.name)
            spec.delete(joint)
    return tuple(locked)


def _moment(model: Any) -> np.ndarray:
    """Generalised force of a unit of each actuator's force at the reference posture, `(nu, nv)`."""
    import mujoco

    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    dense = np.zeros((len(data.moment_rownnz), model.nv))
    for row, (start, length) in enumerate(zip(data.moment_rowadr, data.moment_rownnz, strict=True)):
        dense[row, data.moment_colind[start : start + length]] = np.ravel(data.actuator_moment)[
            start : start + length
        ]
    return dense[: model.nu]


def _is_fixed_tendon(model: Any, tendon: int) -> bool:
    import mujoco

    return bool(model.wrap_type[model.tendon_adr[tendon]] == mujoco.mjtWrap.mjWRAP_JOINT)


def _force_limit(model: Any, actuator: int) -> float:
    """Largest force of an actuator: its own limit, or that of the control of a plain motor."""
    import mujoco

    limits = [np.inf]
    if model.actuator_forcelimited[actuator]:
        limits.append(float(np.max(np.abs(model.actuator_forcerange[actuator]))))
    plain = model.actuator_biastype[actuator] == mujoco.mjtBias.mjBIAS_NONE
    if plain and np.ravel(model.actuator_ctrllimited)[actuator]:
        gain = abs(float(model.actuator_gainprm[actuator, 0]))
        limits.append(float(np.max(np.abs(model.actuator_ctrlrange[actuator]))) * gain)
    return min(limits)


def _feedback(model: Any, actuator: int) -> tuple[float, float]:
    """Stiffness and damping that an actuator's bias puts on its own length, zero for a torque
    motor.
    """
    import mujoco

    if model.actuator_biastype[actuator] != mujoco.mjtBias.mjBIAS_AFFINE:
        return 0.0, 0.0
    return -float(model.actuator_biasprm[actuator, 1]), -float(model.actuator_biasprm[actuator, 2])


def _name(model: Any, joint: int) -> str:
    return model.joint(joint).name or f"joint_{joint}"


def _line(error: Exception) -> str:
    return in_short(error, 300)


def imu_site(spec: Any) -> str:
    """Find the site of the accelerometer, else that of the gyro.

    Args:
        spec: the specification.

    Returns:
        Name of the site; empty where the file has neither.
    """
    import mujoco

    for kind in (mujoco.mjtSensor.mjSENS_ACCELEROMETER, mujoco.mjtSensor.mjSENS_GYRO):
        for sensor in spec.sensors:
            if sensor.type == kind and sensor.objtype == mujoco.mjtObj.mjOBJ_SITE:
                return str(sensor.objname)
    return ""


def imu_place(model: Any, site: str) -> tuple[np.ndarray, np.ndarray]:
    """Find the pose of the IMU in the base's frame.

    Args:
        model: the compiled model.
        site: name of the sensor's site.

    Returns:
        Axes `(3, 3)` and place `(3,)` [m]; the base's own where the file has no sensor on the base.
    """
    import mujoco

    from hyperleg_design.gap.model.mechanism import quaternion_rotation

    index = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, site) if site else -1
    if index < 0 or model.body_parentid[model.site_bodyid[index]] != 0:
        return np.eye(3), np.zeros(3)
    return quaternion_rotation(model.site_quat[index]), np.array(model.site_pos[index])


def add_floor(spec: Any) -> None:
    """Add a floor at z = 0 where the world has no plane.

    Args:
        spec: the specification, which is changed.
    """
    import mujoco

    if not any(g.type == mujoco.mjtGeom.mjGEOM_PLANE for g in spec.worldbody.geoms):
        spec.worldbody.add_geom(
            name="gap_floor",
            type=mujoco.mjtGeom.mjGEOM_PLANE,
            size=[0, 0, 1],
            contype=1,
            conaffinity=1,
        )


def _single(model: Any) -> tuple[np.ndarray, np.ndarray]:
    """Joints that are hinges or slides, and their velocities."""
    import mujoco

    joints = np.flatnonzero(
        (model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE)
        | (model.jnt_type == mujoco.mjtJoint.mjJNT_SLIDE)
    )
    return joints, np.asarray(model.jnt_dofadr)[joints]


def friction(model: Any) -> tuple[np.ndarray, np.ndarray]:
    """Read the dry and viscous friction of the joints.

    Args:
        model: the compiled model.

    Returns:
        Dry [Nm] and viscous [Nms/rad], `(n,)` each.
    """
    _, dofs = _single(model)
    return np.array(model.dof_frictionloss[dofs]), np.array(model.dof_damping[dofs])


def springs(model: Any) -> tuple[np.ndarray, np.ndarray]:
    """Read the springs of the joints.

    Args:
        model: the compiled model.

    Returns:
        Stiffness [Nm/rad] and rest position [rad], `(n,)` each.
    """
    joints, _ = _single(model)
    return np.array(model.jnt_stiffness[joints]), np.array(
        model.qpos_spring[model.jnt_qposadr[joints]]
    )


def limits(model: Any) -> tuple[np.ndarray, np.ndarray]:
    """Read the ranges of motion.

    Args:
        model: the compiled model.

    Returns:
        Lower and upper ends [rad], `(n,)` each; infinite where unlimited.
    """
    joints, _ = _single(model)
    limited = np.asarray(model.jnt_limited)[joints].astype(bool)
    low, high = model.jnt_range[joints].T
    return np.where(limited, low, -np.inf), np.where(limited, high, np.inf)


def take_out_friction(model: Any) -> None:
    """Remove joint friction and keep springs: replays put friction in themselves.

    Args:
        model: the compiled model, which is changed.
    """
    model.dof_frictionloss[:] = 0.0
    model.dof_damping[:] = 0.0


def touching_points(model: Any, geom: int) -> tuple[np.ndarray, float]:
    """Find the points of a shape that meet a floor first.

    Args:
        model: the compiled model.
        geom: index of the shape.

    Returns:
        The points in the body's frame [m], `(p, 3)`, and the radius around them [m].
    """
    import mujoco

    from hyperleg_design.gap.model.mechanism import quaternion_rotation

    size, kind = model.geom_size[geom], mujoco.mjtGeom(model.geom_type[geom])
    rotation, place = quaternion_rotation(model.geom_quat[geom]), model.geom_pos[geom]
    if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        return place + np.array([[0, 0, size[1]], [0, 0, -size[1]]]) @ rotation.T, float(size[0])
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * size
        return place + corners @ rotation.T, 0.0
    return np.array(place)[None], float(size[0])


def add_mass(model: Any, body: str, mass: float, com: np.ndarray) -> None:
    """Put a point mass on a body of a compiled model, which changes in place.

    Args:
        model: the compiled model.
        body: name of the body.
        mass: [kg].
        com: in the body's frame [m], `(3,)`.
    """
    import mujoco

    from hyperleg_design.gap.model.mechanism import (
        inertial_parameters,
        mass_properties,
        quaternion_rotation,
    )

    index = model.body(body).id
    turned = quaternion_rotation(model.body_iquat[index])
    own = inertial_parameters(
        float(model.body_mass[index]),
        model.body_ipos[index],
        turned @ np.diag(model.body_inertia[index]) @ turned.T,
    )
    total, centre, inertia = mass_properties(own + inertial_parameters(mass, com, np.zeros((3, 3))))
    values, vectors = np.linalg.eigh(inertia)
    if np.linalg.det(vectors) < 0:
        vectors[:, 0] *= -1
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, vectors.ravel())
    (
        model.body_mass[index],
        model.body_ipos[index],
        model.body_inertia[index],
        model.body_iquat[index],
    ) = total, centre, values, quaternion
    model.body_simple[index] = 0
    mujoco.mj_setConst(model, mujoco.MjData(model))
