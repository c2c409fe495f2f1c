"""A robot from somebody else's MJCF or URDF: a bare model of it for inverse dynamics and replays.

Drawing shapes go, and missing mesh files with them, as long as the masses do not depend on them.
Drives are read from the file's actuators (`file_drives`) and then taken out: replays apply torques
themselves.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError, in_short
from hyperleg_design.gap.model.mechanism import quaternion_rotation

SMALLEST_MASS = 1e-6
SMALLEST_INERTIA = 1e-9
"""Given to moving links of a file that have none [kg, kg m^2], as MuJoCo needs some."""
ROUNDING = 1e-15
"""Moment of inertia below zero that is rounding in a file, of a link without any [kg m^2]
(assumed: iCub's file has -2e-22)."""


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


def mend_inertias(spec: Any) -> list[str]:
    """Replace moments of inertia that no body has (a negative one) by the nearest possible ones.

    The nearest ones have a matrix of second moments, tr(I) / 2 - I, without negative eigenvalues.
    MuJoCo refuses negative moments, which some vendors' files state, of dummy links above all.

    Args:
        spec: the specification, which is changed.

    Returns:
        A note on the bodies that were changed, if any were.
    """
    changed = []
    for body in spec.bodies:
        stated = np.asarray(body.fullinertia, float)
        if np.isnan(stated).any():
            continue
        xx, yy, zz, xy, xz, yz = stated
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        if np.linalg.eigvalsh(inertia)[0] >= -ROUNDING:  # a point: `compiled` bounds it
            continue
        values, vectors = np.linalg.eigh(np.trace(inertia) / 2 * np.eye(3) - inertia)
        moments = (vectors * np.maximum(values, SMALLEST_INERTIA)) @ vectors.T
        mended = np.trace(moments) * np.eye(3) - moments
        body.fullinertia = [*np.diag(mended), mended[0, 1], mended[0, 2], mended[1, 2]]
        changed.append(body.name)
    if not changed:
        return []
    return [
        f"impossible inertia (a negative moment) of {', '.join(changed)}: the nearest possible "
        f"one is taken"
    ]


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
            remedy = (
                f"its root, {robot.name}, hangs on a joint; give the file a root link that can "
                f"float"
            )
            raise InputError(str(path), "base", "floating", remedy)
        robot.add_freejoint(name="floating_base")
        return "floating"
    return "floating" if own else "fixed"


def _joints_below(body: Any) -> int:
    return len(list(body.joints)) + sum(_joints_below(b) for b in body.bodies)


def strip_drives(spec: Any) -> None:
    """Take out actuators and tendons.

    Args:
        spec: the specification, which is changed.
    """
    for group in (spec.actuators, spec.tendons):
        for item in list(group):
            spec.delete(item)


def free_joints(joints: Sequence[str], known: Collection[str] | None, where: str) -> list[str]:
    """Choose the joints of a robot that stay free.

    Args:
        joints: names of all its joints.
        known: joints that logs know; None for all.
        where: name of the robot, for the error.

    Returns:
        Those that logs know, in the robot's order.

    Raises:
        InputError: logs know none of them.
    """
    free = [name for name in joints if known is None or name in known]
    if known is not None and not free:
        remedy = f"are joints of another robot; its own are {', '.join(joints)}"
        raise InputError(where, "joints", sorted(known)[:8], remedy)
    return free


def lock(spec: Any, free: Collection[str]) -> tuple[str, ...]:
    """Weld joints that no log knows, at the position in which the file draws them.

    Args:
        spec: the specification, which is changed.
        free: names of the joints that stay free.

    Returns:
        Names of the welded joints.
    """
    import mujoco

    locked = []
    for joint in list(spec.joints):
        if (
            joint.type in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE)
            and joint.name not in free
        ):
            locked.append(joint.name)
            spec.delete(joint)
    return tuple(locked)


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

    index = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, site) if site else -1
    if index < 0 or model.body_parentid[model.site_bodyid[index]] != 0:
        return np.eye(3), np.zeros(3)
    return quaternion_rotation(model.site_quat[index]), np.array(model.site_pos[index])


def has_floor(spec: Any) -> bool:
    """Decide whether the world has a plane that shapes can touch.

    Args:
        spec: the specification.

    Returns:
        True if it has.
    """
    import mujoco

    return any(
        g.type == mujoco.mjtGeom.mjGEOM_PLANE and (g.contype or g.conaffinity)
        for g in spec.worldbody.geoms
    )


def add_floor(spec: Any) -> None:
    """Add a floor at z = 0 where the world has no plane.

    Args:
        spec: the specification, which is changed.
    """
    import mujoco

    if not has_floor(spec):
        spec.worldbody.add_geom(
            name="gap_floor",
            type=mujoco.mjtGeom.mjGEOM_PLANE,
            size=[0, 0, 1],
            contype=1,
            conaffinity=1,
        )


def touching_points(model: Any, geom: int) -> tuple[np.ndarray, float]:
    """Find the points of a shape that meet a floor first.

    Args:
        model: the compiled model.
        geom: index of the shape.

    Returns:
        The points in the body's frame [m], `(p, 3)`, and the radius around them [m].
    """
    import mujoco

    size, kind = model.geom_size[geom], mujoco.mjtGeom(model.geom_type[geom])
    rotation, place = quaternion_rotation(model.geom_quat[geom]), model.geom_pos[geom]
    if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        return place + np.array([[0, 0, size[1]], [0, 0, -size[1]]]) @ rotation.T, float(size[0])
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * size
        return place + corners @ rotation.T, 0.0
    return np.array(place)[None], float(size[0])
