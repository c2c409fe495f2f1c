"""A design from somebody else's URDF or MJCF and a file that names the motors behind its joints.

    name: my_robot                       # the file's own name by default
    trunk: {motion: fixed, height: 0.5}  # how the root stands; as the file has it by default
    lock: ["gripper_*"]                  # joints that stay at zero, by name or pattern
    actuators:                           # motors, by joint or pattern of joints, or by a name of
      "leg_*": {motor: U10, gear: 25}    # their own where transmission says what they drive
    joints: {"leg_*": {stiffness: 80, damping: 3, default_deg: 0}}
    pads: {"*_foot": {}}                 # links whose colliding spheres are pads, or pads by name
    transmission, rods, masses, electrical, contact, stops, friction, gears: as in a design of `family: tree`

`lint` says where the effort, velocity and rotor inertia that the file states contradict those motors.
"""  # noqa: E501

from __future__ import annotations

from collections.abc import Mapping
from fnmatch import fnmatchcase
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError, OutputError
from hyperleg_design.reading import given_path, read_yaml
from hyperleg_design.robot import transmission
from hyperleg_design.robot.assumed_posture import NEAREST, nearest_to_zero
from hyperleg_design.robot.build import design_yaml
from hyperleg_design.robot.checks.check_housing import check_housing
from hyperleg_design.robot.checks.finding import Finding
from hyperleg_design.robot.described_file import FileJoint, FileRobot, read_robot
from hyperleg_design.robot.housing import housing
from hyperleg_design.robot.models import leg_reflected_inertia
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.robot.parameters.entries import check_keys
from hyperleg_design.robot.parameters.motor_paths import with_motor_paths
from hyperleg_design.robot.placeholders import placeholders, real_inertia
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.robot.trees.tree_load import tree_design_from_mapping
from hyperleg_design.writing import write_text

AGREES = 0.05
"""Relative difference up to which a limit of the file agrees with the motors [-]."""
HEAD = "# Written by `hyperleg import`, which replaces this file until it is edited: {}\n"
"""First line of a design that import writes, with a checksum of the rest."""
KEYS = (
    "name",
    "trunk",
    "lock",
    "actuators",
    "joints",
    "transmission",
    "rods",
    "pads",
    "masses",
    "electrical",
    "contact",
    "stops",
    "friction",
    "gears",
)
"""What an actuation file may hold."""


def import_robot(
    path: str | Path, actuation: str | Path, *, meshes: bool = True
) -> tuple[TreeDesign, list[Finding]]:
    """A design from a URDF or MJCF and an actuation file.

    Args:
        path: URDF or MJCF.
        actuation: YAML file, see the module.
        meshes: whether the meshes that the file names must be there.

    Returns:
        The design, and what `lint`, `placeholders` and `check_housing` find.

    Raises:
        InputError: the file is no robot (see `described_file.read_robot`), a joint without a motor,
            a pattern that matches nothing, or actuation that does not fit.
    """
    motors = Path(actuation)
    data, where = with_motor_paths(read_yaml(motors), motors.parent), given_path(motors)
    robot = read_robot(path, meshes=meshes)
    mapping = design_mapping(robot, data, where)
    try:
        design = tree_design_from_mapping(mapping, robot.name, where)
    except InputError as error:
        if not error.field.startswith("links."):
            raise
        raise InputError(robot.source, error.field, error.value, error.remedy) from None
    return design, [*lint(robot, design), *placeholders(robot), *check_housing(design)]


def write_imported(design: TreeDesign, out: str | Path) -> Path:
    """Write the file of an imported design.

    Args:
        design: the design.
        out: a new file, or one that this function wrote and nobody has edited.

    Returns:
        The file.

    Raises:
        OutputError: another file stands there, such as one that was imported; it is untouched.
    """
    out = Path(out)
    if out.is_file():
        head, _, rest = out.read_bytes().partition(b"\n")
        if head + b"\n" != HEAD.format(sha256(rest).hexdigest()).encode():
            raise OutputError(
                f"{out}: is a file that hyperleg import did not write, or that was edited since; "
                f"choose another --out, or remove it first"
            )
    text = design_yaml(design)
    return write_text(out, HEAD.format(sha256(text.encode()).hexdigest()) + text)


def base_line(design: TreeDesign) -> str:
    """Write whether the root link of an imported robot moves, and what in the actuation file would
    change it.

    Args:
        design: the imported robot.

    Returns:
        One line.
    """
    motion = str(design.trunk.motion)
    other = "fixed" if motion == "floating" else "floating"
    return (
        f"the root link {design.trunk.link} is {motion}; trunk: {{motion: {other}}} in the "
        f"actuation file makes it {other}"
    )


def design_mapping(robot: FileRobot, data: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Write what the file of the imported design would hold.

    Args:
        robot: as its URDF or MJCF describes it.
        data: of the actuation file: motors, gears and which joints they drive.
        where: the actuation file, for error messages.

    Returns:
        Sections by name, as `robot_from_mapping` takes them.

    Raises:
        InputError: an unknown field, or a pattern that matches no joint.
    """
    check_keys(data, where, "", (), tuple(KEYS))
    moving = [n for n, j in robot.joints.items() if j.kind != "fixed"]
    if not moving:
        raise InputError(
            robot.source, "joints", None, "has no joint that moves, so nothing to drive"
        )
    lock = data.get("lock") or []
    if not isinstance(lock, list):
        raise InputError(where, "lock", lock, "expects a list of joints or patterns")
    locked = {name for pattern in lock for name in _matching(str(pattern), moving, where, "lock")}
    odd = [n for n in moving if robot.joints[n].kind != "revolute" and n not in locked]
    if odd:
        more = f", and so are {', '.join(odd[1:])}" if odd[1:] else ""
        remedy = f"is no kind of joint that a design moves{more}; list them or patterns under lock"
        raise InputError(robot.source, f"joint {odd[0]}", robot.joints[odd[0]].kind, remedy)
    free = [name for name in moving if name not in locked]
    actuators: dict[str, Any] = {}
    for pattern, held in _section(data, "actuators", where).items():
        own = pattern in _section(data, "transmission", where)
        own = own or pattern in _section(data, "rods", where)
        names = [pattern] if own else _driven(pattern, robot, locked, where)
        _fields(held, where, f"actuators.{pattern}", "motor: RI70, gear: 9")
        for name in names:
            actuators[name] = _housed(robot, name, locked, held) | dict(held)
    still = [name for name in free if name not in actuators]
    if still and not data.get("transmission") and not data.get("rods"):
        more = f", nor have {', '.join(still[1:])}" if still[1:] else ""
        remedy = f"has no motor{more}; name one under actuators, or list the joint under lock"
        raise InputError(where, f"joints.{still[0]}", None, remedy)
    source = robot.origin
    joints = {name: _joint(joint, source, name in locked) for name, joint in robot.joints.items()}
    for pattern, held in _section(data, "joints", where).items():
        for name in _matching(pattern, list(robot.joints), where, "joints"):
            joints[name] |= _fields(held, where, f"joints.{pattern}", "stiffness: 50")
    trunk = {"link": robot.root, "motion": "floating" if robot.floating else "fixed"}
    rest = {k: data[k] for k in KEYS[5:] if k in data}
    if "pads" in data:
        rest["pads"] = _pads(robot, _section(data, "pads", where), where)
    return {
        "family": "tree",
        "name": str(data.get("name", robot.name)),
        "trunk": trunk | dict(_section(data, "trunk", where)),
        "links": {
            name: {
                "mass": _leaf(link.mass, source),
                "com": _leaf(link.com.tolist(), source),
                "inertia": _leaf(
                    [
                        float(real_inertia(link)[i])
                        for i in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
                    ],
                    source,
                ),
            }
            for name, link in robot.links.items()
        },
        "joints": joints,
        "actuators": actuators,
        **rest,
    }


def _pads(robot: FileRobot, given: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Pads by name; a pattern of links without a position stands for their colliding spheres, or,
    with a radius, for a sphere at the origin of each that has none.

    Raises:
        InputError: a pattern that matches no link, or none with colliding spheres.
    """
    mapping: dict[str, Any] = {}
    for name, held in given.items():
        if "position" in _fields(held or {}, where, f"pads.{name}", "radius: 0.01"):
            mapping[name] = held
            continue
        links = [link for link in robot.links if fnmatchcase(link, name)]
        origin = ((np.zeros(3), 0.0),) if "radius" in (held or {}) else ()
        spheres = {link: robot.links[link].spheres or origin for link in links}
        spheres = {link: own for link, own in spheres.items() if own}
        if not links:
            remedy = parameters.unknown(name, list(robot.links), "link")
            raise InputError(where, f"pads.{name}", None, remedy)
        if not spheres:
            known = parameters.some([n for n, link in robot.links.items() if link.spheres])
            remedy = (
                f"no link of this name has a colliding sphere in {robot.source} (those that have: "
                f"{known or 'none'}); give a radius for a pad at the link's origin, or link, "
                f"position and radius of each pad"
            )
            raise InputError(where, f"pads.{name}", None, remedy)
        for link, own in spheres.items():
            for index, (place, radius) in enumerate(own):
                mapping[f"{link}_{index}"] = {
                    "link": link,
                    "position": _leaf(place.tolist(), robot.origin),
                    "radius": _leaf(radius, robot.origin),
                } | dict(held or {})
    return mapping


def _housed(
    robot: FileRobot, name: str, locked: set[str], held: Mapping[str, Any]
) -> dict[str, Any]:
    """Link that carries a motor, and where, as far as the actuation file leaves it open."""
    if "housed_in" in held:
        return {}
    if name not in robot.joints:
        return {"housed_in": robot.root}
    link, place = housing(robot, name, locked)
    return {"housed_in": link, "place": _leaf(place.tolist(), robot.origin, "derived")}


def _section(data: Mapping[str, Any], key: str, where: str) -> Mapping[str, Any]:
    held = data.get(key) or {}
    if not isinstance(held, Mapping):
        raise InputError(where, key, held, "expects a mapping of names to values")
    return held


def _fields(held: Any, where: str, place: str, example: str) -> Mapping[str, Any]:
    """What an entry holds, which must be fields by name."""
    if not isinstance(held, Mapping):
        raise InputError(where, place, held, f"expects fields by name, such as {{{example}}}")
    return held


def _driven(pattern: str, robot: FileRobot, locked: set[str], where: str) -> list[str]:
    """Joints that a motor of this name or pattern drives.

    Raises:
        InputError: there are none, or they do not move.
    """
    joints = robot.joints
    still = [name for name, joint in joints.items() if joint.kind == "fixed" or name in locked]
    names = [name for name in joints if name not in still]
    held = [name for name in still if fnmatchcase(name, pattern)]
    if held and not any(fnmatchcase(name, pattern) for name in names):
        why = f"is fixed in {robot.source}; leave out its motor"
        if held[0] in locked:
            why = "is under lock, so no motor drives it; leave out one of the two"
        who = "" if held[0] == pattern else f"{held[0]} "
        raise InputError(where, f"actuators.{pattern}", None, who + why)
    return _matching(pattern, names, where, "actuators")


def _matching(pattern: str, names: list[str], where: str, place: str) -> list[str]:
    matching = [name for name in names if fnmatchcase(name, pattern)]
    if not matching:
        kind = "joint" if place == "joints" else "moving joint"
        remedy = parameters.unknown(pattern, names, kind)
        raise InputError(where, f"{place}.{pattern}", None, remedy)
    return matching


def _leaf(value: Any, source: str, label: str = "vendor") -> dict[str, Any]:
    return {"value": value, "label": label, "source": source}


def _joint(joint: FileJoint, source: str, locked: bool) -> dict[str, Any]:
    fixed = locked or joint.kind == "fixed"
    section = {
        "parent": joint.parent,
        "child": joint.child,
        "type": "fixed" if fixed else "revolute",
        "position": _leaf(joint.position.tolist(), source),
        "turn_deg": _leaf(np.rad2deg(joint.turn).tolist(), source),
    }
    if fixed:
        return section
    lower, upper = (round(float(np.rad2deg(end)), 9) for end in (joint.lower, joint.upper))
    return section | {
        "axis": _leaf(joint.axis.tolist(), source),
        "lower_deg": _leaf(lower, source),
        "upper_deg": _leaf(upper, source),
        "default_deg": _leaf(nearest_to_zero(lower, upper), NEAREST, "assumed"),
        "coulomb": _leaf(joint.coulomb, source),
        "viscous": _leaf(joint.viscous, source),
    }


def lint(robot: FileRobot, design: TreeDesign) -> list[Finding]:
    """Where the limits that a file states contradict the motors and reductions of a design.

    The motors can give a joint `sum |M| tau_peak` and turn it, alone, at the least `omega_0 / |M|`;
    their rotors appear there with the diagonal of `M diag(J) M^T`.

    Args:
        robot: the file.
        design: the design made of it.

    Returns:
        Warnings, first those where the file promises more than the motors have, then those where
        it has less than they have, or another rotor inertia.
    """
    matrix = transmission.joint_from_motor(design)
    torque = transmission.max_joint_torque(design)
    speed = transmission.single_joint_speed(design)
    rotors = np.diag(leg_reflected_inertia(design))
    motors = list(design.actuator_sections)
    promised: list[Finding] = []
    others: list[Finding] = []
    for row, name in enumerate(design.joint_sections):
        joint = robot.joints[name]
        parts = []
        for motor, ratio in zip(motors, matrix[row], strict=True):
            if ratio:
                parts.append(f"{design.actuator_sections[motor].motor} at {abs(ratio):.4g}:1")
        driven = " and ".join(parts)
        for field, stated, own, unit in (
            ("effort", joint.effort, float(torque[row]), "Nm"),
            ("velocity", joint.velocity, float(speed[row]), "rad/s"),
        ):
            if not np.isfinite(stated) or abs(stated / own - 1) <= AGREES:
                continue
            more = stated > own
            (promised if more else others).append(
                Finding(
                    "warning",
                    f"joint {name}",
                    f"{field} is {stated:.4g} {unit}, {stated / own:.3g} times the {own:.4g} {unit}"
                    f" of {driven}",
                    f"set it to {own:.4g}, or name other motors and reductions"
                    if more
                    else f"raise it to {own:.4g} unless the rest is held back on purpose",
                )
            )
        if np.isfinite(joint.armature) and abs(joint.armature / rotors[row] - 1) > AGREES:
            others.append(
                Finding(
                    "warning",
                    f"joint {name}",
                    f"armature is {joint.armature:.4g} kg m^2, {joint.armature / rotors[row]:.3g} "
                    f"times the rotors of {driven}",
                    f"set it to {rotors[row]:.4g}",
                )
            )
    return [*promised, *others]
