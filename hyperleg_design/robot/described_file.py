"""Robots as another URDF or MJCF describes them: links, joints and the limits stated there."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.reading import given_path, short_name
from hyperleg_design.robot.checks.check_units import WORLD, check_ends, check_step
from hyperleg_design.robot.checks.check_urdf import check_urdf
from hyperleg_design.robot.checks.finding import Finding
from hyperleg_design.robot.checks.mesh_files import WITHOUT, missing_meshes
from hyperleg_design.robot.checks.urdf_xml import parse_xml
from hyperleg_design.robot.mjcf_meshes import compiled

MOVING = ("revolute", "continuous")


@dataclass(frozen=True, eq=False)
class FileLink:
    """A link of the file, in its own frame."""

    mass: float
    """Mass [kg]."""
    com: np.ndarray
    """Centre of mass in the link's frame [m], `(3,)`."""
    inertia: np.ndarray
    """Inertia about the centre of mass, in the axes of the link [kg m^2], `(3, 3)`."""
    spheres: tuple[tuple[np.ndarray, float], ...] = ()
    """Centre in the link's frame `(3,)` and radius [m] of each sphere that collides."""


@dataclass(frozen=True, eq=False)
class FileJoint:
    """A joint of the file."""

    kind: str
    """`revolute` or `fixed`, or another kind that cannot move here, such as `prismatic`."""
    parent: str
    child: str
    position: np.ndarray
    """Position of the child's frame in the parent's [m], `(3,)`."""
    turn: np.ndarray
    """Roll, pitch and yaw of the child's frame in the parent's [rad] `(3,)`."""
    axis: np.ndarray
    lower: float
    """Lower end of the range of motion [rad]."""
    upper: float
    """Upper end of the range of motion [rad]."""
    coulomb: float = 0.0
    """Coulomb friction [Nm]."""
    viscous: float = 0.0
    """Viscous friction [Nm s/rad]."""
    effort: float = math.nan
    """Largest torque that the file states [Nm]; nan where it states none."""
    velocity: float = math.nan
    """Largest speed that the file states [rad/s]; nan where it states none."""
    armature: float = math.nan
    """Rotor inertia at the joint that the file states [kg m^2]; nan where it states none."""


@dataclass(frozen=True, eq=False)
class FileRobot:
    """A robot read from a file; names are made fit for dotted paths."""

    name: str
    source: str
    """Path of the file as it was given, for messages."""
    root: str
    floating: bool
    links: dict[str, FileLink]
    joints: dict[str, FileJoint]

    @property
    def origin(self) -> str:
        """The file as the source of values, wherever it lay: its folder and name."""
        return short_name(Path(self.source))


def read_robot(path: str | Path, *, meshes: bool = True) -> FileRobot:
    """Read a robot from a URDF or MJCF file.

    Args:
        path: the file.
        meshes: whether the meshes that the file names must be there.

    Returns:
        Its links and joints, with the limits that the file states.

    Raises:
        InputError: it cannot be read, has two roots, a loop or repeated names, a mesh is missing,
            or its numbers look like degrees or millimetres.
    """
    path = Path(path)
    root, findings = parse_xml(path)
    where = given_path(path)
    if root is None:
        raise InputError(where, findings[0].place, None, findings[0].message)
    if root.tag == "robot":
        robot = _urdf(path, root, where, meshes)
    elif root.tag == "mujoco":
        robot = _mjcf(path, where, meshes)
        _check_units(robot)
    else:
        remedy = "expects a URDF (<robot>) or an MJCF (<mujoco>)"
        if root.tag == "sdf":
            remedy = "is SDF, which is not read; convert it to URDF or MJCF first"
        raise InputError(where, f"<{root.tag}>", None, remedy)
    return robot


def _check_units(robot: FileRobot) -> None:
    """Refuse what looks like millimetres or degrees; `check_urdf` does so for a URDF."""
    for name, joint in robot.joints.items():
        findings = check_step(f"joint {name}", joint.parent, joint.position)
        if joint.kind == "revolute":
            findings += check_ends(f"joint {name}", joint.lower, joint.upper)
        for finding in findings:
            raise InputError(robot.source, finding.place, None, _text(finding))


def _text(finding: Finding) -> str:
    return f"{finding.message}; {finding.remedy}"


def fit_name(name: str) -> str:
    """Turn a name of the file into one that dotted paths take: letters, digits and underscores.

    Args:
        name: as the file has it.

    Returns:
        The changed name.
    """
    fit = re.sub(r"\W", "_", name)
    return fit if fit[:1].isalpha() else f"n_{fit}"


def _urdf(path: Path, root: Any, where: str, meshes: bool) -> FileRobot:
    errors = [f for f in check_urdf(path, meshes=False) if f.severity == "error"]
    if errors:
        rest = f"; hyperleg check {path} lists all {len(errors)} errors" if errors[1:] else ""
        raise InputError(where, errors[0].place, None, _text(errors[0]) + rest)
    if meshes and (missing := missing_meshes(root, path)):
        raise InputError(where, "<mesh filename>", missing[0], f"is missing; {WITHOUT}")
    links = {fit_name(e.get("name")): _urdf_link(e) for e in root.findall("link")}
    joints = {fit_name(e.get("name")): _urdf_joint(e) for e in root.findall("joint")}
    for name, joint in list(joints.items()):
        if joint.kind == "floating" and not any(joint.parent == j.child for j in joints.values()):
            del joints[name], links[joint.parent]  # the world, from which the robot is free
    carried = {joint.child for joint in joints.values()}
    (base,) = [name for name in links if name not in carried]
    floating = base != WORLD
    return FileRobot(fit_name(root.get("name", "robot")), where, base, floating, links, joints)


def _numbers(element: Any, key: str, default: str) -> np.ndarray:
    text = default if element is None else element.get(key, default)
    return np.array([float(v) for v in text.split()])


def _urdf_link(element: Any) -> FileLink:
    inertial = element.find("inertial")
    spheres = tuple(
        (_numbers(part.find("origin"), "xyz", "0 0 0"), float(sphere.get("radius")))
        for part in element.findall("collision")
        for sphere in part.findall("geometry/sphere")
    )
    if inertial is None:
        return FileLink(0.0, np.zeros(3), np.zeros((3, 3)), spheres)
    origin, tensor = inertial.find("origin"), inertial.find("inertia")
    xx, yy, zz, xy, xz, yz = (
        float(tensor.get(k, 0)) for k in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    )
    turn = _rotation(_numbers(origin, "rpy", "0 0 0"))
    own = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    mass = float(inertial.find("mass").get("value"))
    return FileLink(mass, _numbers(origin, "xyz", "0 0 0"), turn @ own @ turn.T, spheres)


def _urdf_joint(element: Any) -> FileJoint:
    kind, limit = element.get("type"), element.find("limit")
    axis = _numbers(element.find("axis"), "xyz", "1 0 0")
    dynamics = element.find("dynamics")
    ends = [float(limit.get(k, 0)) for k in ("lower", "upper")] if limit is not None else [0.0, 0.0]
    if kind == "continuous":
        ends = [-2 * math.pi, 2 * math.pi]
    stated = [math.nan] * 2
    if limit is not None:
        stated = [float(limit.get(k, math.nan)) for k in ("effort", "velocity")]
    if element.find("mimic") is not None:
        kind = "mimic"
    return FileJoint(
        "revolute" if kind in MOVING else kind,
        fit_name(element.find("parent").get("link")),
        fit_name(element.find("child").get("link")),
        _numbers(element.find("origin"), "xyz", "0 0 0"),
        _numbers(element.find("origin"), "rpy", "0 0 0"),
        axis / max(float(np.linalg.norm(axis)), 1e-12),
        *ends,
        *(
            float(dynamics.get(k, 0)) if dynamics is not None else 0.0
            for k in ("friction", "damping")
        ),
        *stated,
    )


def _rotation(turn: np.ndarray) -> np.ndarray:
    from hyperleg_design.robot.trees.tree_limb import turned

    return turned(np.rad2deg(turn))


def _mjcf(path: Path, where: str, meshes: bool) -> FileRobot:
    import mujoco

    model = compiled(path, where, meshes=meshes)
    first = [b for b in range(1, model.nbody) if model.body_parentid[b] == 0]
    free = [b for b in first if model.body_jntnum[b] and model.jnt_type[model.body_jntadr[b]] == 0]
    if len(free) > 1 or (free and len(first) > 1 and _moves(model, first, free[0])):
        roots = ", ".join(model.body(b).name for b in first)
        remedy = f"has two roots or more: {roots}; leave one robot in the file"
        raise InputError(where, "<worldbody>", None, remedy)
    root = free[0] if free else 0
    names = {b: fit_name(model.body(b).name or f"body_{b}") for b in range(model.nbody)}
    shift = {root: np.zeros(3)}
    links, joints = {}, {}
    bodies = [b for b in range(model.nbody) if b == root or _under(model, b, root)]
    for body in bodies:
        if body != root:
            name, joint = _mjcf_joint(model, body, names, shift, where)
            joints[name] = joint
        quat = np.zeros(9)
        mujoco.mju_quat2Mat(quat, model.body_iquat[body])
        turn = quat.reshape(3, 3)
        own = turn @ np.diag(model.body_inertia[body]) @ turn.T
        com = model.body_ipos[body] - shift[body]
        spheres = tuple(
            (model.geom_pos[g] - shift[body], float(model.geom_size[g, 0]))
            for g in range(model.ngeom)
            if model.geom_bodyid[g] == body
            and model.geom_type[g] == mujoco.mjtGeom.mjGEOM_SPHERE
            and (model.geom_contype[g] or model.geom_conaffinity[g])
        )
        links[names[body]] = FileLink(float(model.body_mass[body]), com, own, spheres)
    name = fit_name(path.stem)
    return FileRobot(name, where, names[root], bool(free), links, joints)


def _moves(model: Any, first: list[int], but: int) -> bool:
    """Whether another body of the world than one has joints or mass."""
    return any(model.body_jntnum[b] or model.body_mass[b] > 0 for b in first if b != but)


def _under(model: Any, body: int, root: int) -> bool:
    while body not in (0, root):
        body = int(model.body_parentid[body])
    return body == root


def _mjcf_joint(
    model: Any, body: int, names: dict[int, str], shift: dict[int, np.ndarray], where: str
) -> tuple[str, FileJoint]:
    """The joint that carries a body; the link's frame sits at the joint."""
    import mujoco

    parent, count = int(model.body_parentid[body]), int(model.body_jntnum[body])
    index = int(model.body_jntadr[body])
    if count > 1:
        remedy = "has several joints; give each a body of its own, as a URDF does"
        raise InputError(where, f"body {names[body]}", count, remedy)
    flat = np.zeros(9)
    mujoco.mju_quat2Mat(flat, model.body_quat[body])
    rotation = flat.reshape(3, 3)
    shift[body] = model.jnt_pos[index].copy() if count else np.zeros(3)
    position = model.body_pos[body] + rotation @ shift[body] - shift[parent]
    turn = np.array(
        [
            math.atan2(rotation[2, 1], rotation[2, 2]),
            math.asin(float(np.clip(-rotation[2, 0], -1, 1))),
            math.atan2(rotation[1, 0], rotation[0, 0]),
        ]
    )
    if not count:
        zero = FileJoint("fixed", names[parent], names[body], position, turn, np.eye(3)[0], 0, 0)
        return f"{names[body]}_mount", zero
    kind = {2: "prismatic", 3: "revolute", 1: "ball"}.get(int(model.jnt_type[index]), "free")
    limited, dof = bool(model.jnt_limited[index]), int(model.jnt_dofadr[index])
    ends = model.jnt_range[index] if limited else np.array([-2 * math.pi, 2 * math.pi])
    effort = math.nan
    if model.jnt_actfrclimited[index]:
        effort = float(model.jnt_actfrcrange[index, 1])
    for actuator in range(model.nu):
        at_joint = model.actuator_trntype[actuator] == mujoco.mjtTrn.mjTRN_JOINT
        own = at_joint and model.actuator_trnid[actuator, 0] == index
        if own and model.actuator_forcelimited[actuator]:
            gear = abs(model.actuator_gear[actuator, 0])
            effort = float(model.actuator_forcerange[actuator, 1] * gear)
    joint = FileJoint(
        kind,
        names[parent],
        names[body],
        position,
        turn,
        model.jnt_axis[index].copy(),
        float(ends[0]),
        float(ends[1]),
        float(model.dof_frictionloss[dof]),
        float(model.dof_damping[dof].flat[0]),
        effort,
        math.nan,
        float(model.dof_armature[dof]) if model.dof_armature[dof] > 0 else math.nan,
    )
    return fit_name(model.joint(index).name or f"{names[body]}_joint"), joint
