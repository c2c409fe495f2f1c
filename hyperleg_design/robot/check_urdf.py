"""Whether a URDF describes a robot: any URDF, not only ours.

Beyond what ROS's `check_urdf` sees (syntax, one root, names), this looks at the numbers: masses,
inertias that a body can have, ranges that can be reached, axes.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError, in_short
from hyperleg_design.robot.finding import Finding

JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
SIZES = {
    "box": ("size", 3),
    "cylinder": ("radius length", 1),
    "sphere": ("radius", 1),
    "capsule": ("radius length", 1),
}
"""Attributes of each primitive, and how many numbers each holds."""
LARGEST_GYRATION = 5.0
"""Radius of gyration past which a robot's link looks like a mistake of unit [m]."""


def check_urdf(source: str | Path) -> list[Finding]:
    """Everything wrong with a URDF.

    Args:
        source: a path, or the text itself.

    Returns:
        Findings, errors first; empty where nothing is wrong.

    Raises:
        InputError: the file cannot be read.
    """
    root, findings = parse_xml(source)
    if root is None:
        return findings
    if root.tag != "robot":
        return [
            Finding(
                "error",
                f"line {root.sourceline}",
                f"the root element is <{root.tag}>",
                "a URDF starts with <robot name=...>",
            )
        ]
    if not root.get("name"):
        findings.append(Finding("error", "<robot>", "has no name", "add name="))
    if any("}" in str(e.tag) for e in root.iter()):
        return [
            Finding(
                "error",
                "<robot>",
                "holds xacro elements",
                "expand it first: xacro FILE > robot.urdf",
            )
        ]
    links, joints = root.findall("link"), root.findall("joint")
    findings += _names(links) + _names(joints)
    if not links:
        return [*findings, Finding("error", "<robot>", "has no links", "add at least one <link>")]
    findings += _tree(links, joints)
    carried = {end for joint in joints if joint.get("type") == "fixed" for end in _ends(joint)}
    for link in links:
        findings += _inertial(link, link.get("name") in carried) + _drawings(link)
        findings += _meshes(link, source)
    for joint in joints:
        findings += _joint(joint, {j.get("name") for j in joints})
    findings += _weightless(links, joints)
    if not any(f.severity == "error" for f in findings):
        findings += _loads(root)
    return sorted(findings, key=lambda f: f.severity != "error")


def parse_xml(source: str | Path) -> tuple[Any, list[Finding]]:
    """Parse an XML file or text.

    Args:
        source: path of the file, or the text itself, which begins with `<`.

    Returns:
        The root element and no findings, or None and the error of its syntax.

    Raises:
        InputError: the file cannot be read.
    """
    from lxml import etree  # type: ignore[import-untyped]

    if isinstance(source, str) and source.lstrip().startswith("<"):
        content = source.encode()
    else:
        path = Path(source)
        try:
            content = path.read_bytes()
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or error
            raise InputError(
                str(path), "", None, f"cannot be read ({reason}); give the path of a file"
            ) from None
    try:
        parser = etree.XMLParser(
            resolve_entities=False, no_network=True, remove_comments=True, remove_pis=True
        )
        return etree.fromstring(content, parser), []
    except etree.XMLSyntaxError as error:
        return None, [
            Finding(
                "error",
                f"line {error.lineno or 1}",
                f"is not XML: {error.msg}",
                "close and quote every element there",
            )
        ]


def _place(element: Any) -> str:
    return f"{element.tag} {element.get('name') or '(no name)'} (line {element.sourceline})"


def _names(elements: Iterable[Any]) -> list[Finding]:
    elements = list(elements)
    findings = [
        Finding("error", _place(e), "has no name", "add name=")
        for e in elements
        if not e.get("name")
    ]
    counts = Counter(e.get("name") for e in elements if e.get("name"))
    for element in reversed(elements):
        if counts.get(element.get("name"), 0) > 1:
            counts[element.get("name")] = 0
            findings.append(
                Finding(
                    "error",
                    _place(element),
                    "has a name that stands twice",
                    "names must be unique; rename one",
                )
            )
    return findings


def _ends(joint: Any) -> tuple[str | None, str | None]:
    parent, child = joint.find("parent"), joint.find("child")
    return (None if parent is None else parent.get("link")), (
        None if child is None else child.get("link")
    )


def _tree(links: list[Any], joints: list[Any]) -> list[Finding]:
    """One root, every link behind it, no loops."""
    findings: list[Finding] = []
    names = {link.get("name"): link for link in links}
    joint_of: dict[str, Any] = {}
    children: dict[str, list[str]] = {}
    for joint in joints:
        parent, child = _ends(joint)
        for role, link in (("parent", parent), ("child", child)):
            if link is None:
                findings.append(
                    Finding(
                        "error",
                        _place(joint),
                        f"has no <{role} link=...>",
                        "a joint connects two links",
                    )
                )
            elif link not in names:
                findings.append(
                    Finding(
                        "error",
                        _place(joint),
                        f"its {role}, {link!r}, is no link",
                        f"name one of the {len(names)} links",
                    )
                )
        if parent not in names or child not in names or parent is None or child is None:
            continue
        if child in joint_of:
            other = joint_of[child].get("name")
            findings.append(
                Finding(
                    "error",
                    _place(joint),
                    f"its child, {child!r}, hangs on joint {other!r} already",
                    "a link has one parent",
                )
            )
            continue
        joint_of[child] = joint
        children.setdefault(parent, []).append(child)

    def behind(start: str) -> set[str]:
        seen, stack = {start}, [start]
        while stack:
            new = [c for c in children.get(stack.pop(), ()) if c not in seen]
            seen.update(new)
            stack += new
        return seen

    trees = {name: behind(name) for name in names if name is not None and name not in joint_of}
    reached = set().union(*trees.values()) if trees else set()
    looped = [name for name in names if name is not None and name not in reached]
    if looped:
        shown = ", ".join(looped[:5])
        findings.append(
            Finding(
                "error",
                _place(names[looped[0]]),
                f"stands in a loop of joints ({shown})",
                "a URDF is a tree; open the loop",
            )
        )
    main = max(trees, key=lambda name: len(trees[name]), default=None)
    for name, tree in trees.items():
        if name != main:
            size = f" and {len(tree) - 1} behind it" if len(tree) > 1 else ""
            findings.append(
                Finding(
                    "error",
                    _place(names[name]),
                    f"is loose{size}: no joint connects it to {main!r}",
                    "add the joint, or remove the link",
                )
            )
    return findings


def numbers(text: str | None, count: int) -> np.ndarray | None:
    """Parse the numbers of an attribute.

    Args:
        text: of the attribute; None where it is missing.
        count: how many numbers are expected.

    Returns:
        `(count,)`; None if there are more or fewer, or one is not finite.
    """
    try:
        values = np.array([float(v) for v in (text or "").split()])
    except ValueError:
        return None
    return values if len(values) == count and np.all(np.isfinite(values)) else None


def _inertial(link: Any, carried: bool) -> list[Finding]:
    """Mass and inertia; `carried` says that the link is fixed to another, where a point without
    inertia does no harm.
    """
    part = link.find("inertial")
    if part is None:
        return []
    place = _place(link)
    findings = _origin(part, place)
    mass, inertia = part.find("mass"), part.find("inertia")
    weight = None if mass is None else numbers(mass.get("value"), 1)
    if weight is None:
        shown = None if mass is None else mass.get("value")
        findings.append(
            Finding(
                "error", place, f"mass is {shown!r}", "expects <mass value=...>, one number in kg"
            )
        )
    elif weight[0] < 0:
        findings.append(Finding("error", place, f"mass is {weight[0]:g} kg", "a mass is positive"))
    if inertia is None:
        return [
            *findings,
            Finding(
                "error", place, "has a mass but no <inertia>", "add ixx, iyy, izz, ixy, ixz, iyz"
            ),
        ]
    values = [
        numbers(inertia.get(key, "0" if key in ("ixy", "ixz", "iyz") else None), 1)
        for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    ]
    if any(v is None for v in values):
        return [
            *findings,
            Finding(
                "error",
                place,
                "inertia lacks a number",
                "expects ixx, iyy, izz, ixy, ixz, iyz in kg m^2",
            ),
        ]
    if weight is not None and weight[0] > 0:
        findings += _tensor(
            np.array([float(v[0]) for v in values if v is not None]),
            float(weight[0]),
            place,
            carried,
        )
    return findings


def _tensor(values: np.ndarray, mass: float, place: str, carried: bool) -> list[Finding]:
    xx, yy, zz, xy, xz, yz = values
    principal = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    shown = ", ".join(f"{v:.4g}" for v in principal)
    if principal[0] <= 1e-12 * principal[2]:
        harmless = carried and principal[0] >= -1e-12 * principal[2]
        return [
            Finding(
                "warning" if harmless else "error",
                place,
                f"inertia is not positive definite (principal moments {shown} kg m^2)",
                "check signs and products",
            )
        ]
    if principal[2] > (principal[0] + principal[1]) * (1 + 1e-9):
        return [
            Finding(
                "error",
                place,
                f"no body has this inertia (principal moments {shown} kg m^2)",
                "the largest must not exceed the sum of the others",
            )
        ]
    gyration = math.sqrt(principal[2] / mass)
    if gyration > LARGEST_GYRATION:
        return [
            Finding(
                "warning",
                place,
                f"radius of gyration is {gyration:.3g} m",
                "check units: kg, m, kg m^2",
            )
        ]
    return []


def _origin(element: Any, place: str) -> list[Finding]:
    origin = element.find("origin")
    if origin is None:
        return []
    bad = [
        key
        for key in ("xyz", "rpy")
        if origin.get(key) is not None and numbers(origin.get(key), 3) is None
    ]
    return [
        Finding("error", place, f"origin has {key}={origin.get(key)!r}", "expects three numbers")
        for key in bad
    ]


def _drawings(link: Any) -> list[Finding]:
    findings = []
    for drawing in [*link.findall("visual"), *link.findall("collision")]:
        place = f"{drawing.tag} of {_place(link)}"
        findings += _origin(drawing, place)
        geometry = drawing.find("geometry")
        if geometry is None or len(geometry) != 1:
            findings.append(
                Finding(
                    "error",
                    place,
                    "has no geometry, or several",
                    "expects one of box, cylinder, sphere, mesh in <geometry>",
                )
            )
            continue
        attributes, count = SIZES.get(geometry[0].tag, ("", 0))
        for key in attributes.split():
            size = numbers(geometry[0].get(key), count)
            if size is None or np.any(size <= 0):
                findings.append(
                    Finding(
                        "error",
                        place,
                        f"{geometry[0].tag} has {key}={geometry[0].get(key)!r}",
                        "expects positive lengths in m",
                    )
                )
    return findings


def _meshes(link: Any, source: str | Path) -> list[Finding]:
    """Mesh files of a link that are not where the URDF says; `package://` names are left to ROS."""
    findings = []
    for mesh in link.iter("mesh"):
        name = (mesh.get("filename") or "").removeprefix("file://")
        if "://" in name or (isinstance(source, str) and source.lstrip().startswith("<")):
            continue
        if not name or not (Path(source).parent / name).is_file():
            findings.append(
                Finding(
                    "error",
                    _place(link),
                    f"has a mesh that is missing: filename = {name!r}",
                    "correct the path, which starts at the URDF's folder, or add the file",
                )
            )
    return findings


def _joint(joint: Any, names: set[str | None]) -> list[Finding]:
    place, kind = _place(joint), joint.get("type")
    findings = _origin(joint, place)
    if kind not in JOINT_TYPES:
        return [
            *findings,
            Finding(
                "error", place, f"type is {kind!r}", f"expects one of {', '.join(JOINT_TYPES)}"
            ),
        ]
    if kind in ("revolute", "continuous", "prismatic", "planar"):
        findings += _axis(joint, place)
    if kind in ("revolute", "prismatic"):
        findings += _limit(joint, place, kind)
    mimic = joint.find("mimic")
    if mimic is not None and mimic.get("joint") not in names:
        findings.append(
            Finding(
                "error",
                place,
                f"mimics {mimic.get('joint')!r}, which is no joint",
                "name a joint of this robot",
            )
        )
    dynamics = joint.find("dynamics")
    for key in ("damping", "friction"):
        value = None if dynamics is None else dynamics.get(key)
        number = numbers(value, 1)
        if value is not None and (number is None or number[0] < 0):
            findings.append(
                Finding("error", place, f"{key} is {value!r}", "expects a number, zero or more")
            )
    return findings


def _axis(joint: Any, place: str) -> list[Finding]:
    axis = joint.find("axis")
    text = "1 0 0" if axis is None else axis.get("xyz", "1 0 0")
    direction = numbers(text, 3)
    if direction is None:
        return [Finding("error", place, f"axis is {text!r}", "expects three numbers")]
    length = float(np.linalg.norm(direction))
    if length < 1e-9:
        return [Finding("error", place, "axis is zero", "give the axis a direction")]
    if abs(length - 1) > 1e-3:
        return [
            Finding(
                "warning",
                place,
                f"axis has length {length:.4g}",
                "programs differ in what they make of that; use a unit vector",
            )
        ]
    return []


def _limit(joint: Any, place: str, kind: str) -> list[Finding]:
    limit = joint.find("limit")
    if limit is None:
        return [
            Finding(
                "error",
                place,
                "has no <limit>",
                f"a {kind} joint needs lower, upper, effort and velocity",
            )
        ]
    findings: list[Finding] = []
    ends = {key: numbers(limit.get(key, "0"), 1) for key in ("lower", "upper")}
    findings += [
        Finding("error", place, f"{key} is {limit.get(key)!r}", "expects a number")
        for key, value in ends.items()
        if value is None
    ]
    if ends["lower"] is not None and ends["upper"] is not None:
        findings += _range(float(ends["lower"][0]), float(ends["upper"][0]), place, kind)
    driven = {"effort": numbers(limit.get("effort"), 1)}
    driven["velocity"] = numbers(limit.get("velocity"), 1)
    passive = all(value is not None and value[0] == 0 for value in driven.values())
    if passive and not findings:
        return findings  # no motor drives this joint, such as a toe on a spring
    for key, unit in (("effort", "Nm or N"), ("velocity", "rad/s or m/s")):
        value = driven[key]
        if value is None or value[0] <= 0:
            findings.append(
                Finding(
                    "error",
                    place,
                    f"{key} is {limit.get(key)!r}",
                    f"expects a positive number in {unit}; at zero the joint cannot move",
                )
            )
    return findings


def _range(lower: float, upper: float, place: str, kind: str) -> list[Finding]:
    unit = "rad" if kind == "revolute" else "m"
    shown = f"range is {lower:.4g} .. {upper:.4g} {unit}"
    if lower > upper:
        return [
            Finding(
                "error", place, f"{shown}, reversed: no posture lies in it", "swap lower and upper"
            )
        ]
    if lower == upper:
        return [
            Finding(
                "error",
                place,
                f"{shown}, empty: the joint cannot move",
                "widen it, or make the joint fixed",
            )
        ]
    if kind == "revolute" and max(abs(lower), abs(upper)) > 2 * math.pi + 1e-6:
        return [
            Finding(
                "warning", place, f"{shown}, more than a turn", "URDF takes radians, not degrees"
            )
        ]
    if not lower <= 0 <= upper:
        return [
            Finding(
                "warning",
                place,
                f"{shown}, so the zero posture cannot be reached",
                "programs start there; shift the joint's frame if you can",
            )
        ]
    return []


def _weightless(links: list[Any], joints: list[Any]) -> list[Finding]:
    """Links that move though nothing rigidly connected to them weighs anything."""
    group = {link.get("name"): link.get("name") for link in links}

    def head(name: Any) -> Any:
        while group[name] != name:
            name = group[name]
        return name

    moving = {}
    for joint in joints:
        parent, child = _ends(joint)
        if parent not in group or child not in group:
            continue
        if joint.get("type") == "fixed":
            group[head(child)] = head(parent)
        else:
            moving[child] = joint
    weight: dict[Any, float] = {}
    for link in links:
        mass = link.find("inertial/mass")
        value = None if mass is None else numbers(mass.get("value"), 1)
        weight[head(link.get("name"))] = weight.get(head(link.get("name")), 0.0) + (
            0.0 if value is None else float(value[0])
        )
    by_name = {link.get("name"): link for link in links}
    remedy = "add an <inertial> with mass and inertia"
    return [
        Finding(
            "error",
            _place(by_name[name]),
            f"moves with joint {joint.get('name')!r} but has no mass",
            remedy,
        )
        for name, joint in moving.items()
        if weight[head(name)] == 0
    ]


def _loads(root: Any) -> list[Finding]:
    """Whether Pinocchio, which analyses it, takes it."""
    import pinocchio
    from lxml import etree

    try:
        pinocchio.buildModelFromXML(etree.tostring(root, encoding="unicode"))
    except (ValueError, RuntimeError) as error:
        return [
            Finding(
                "error",
                "<robot>",
                f"Pinocchio does not load it: {in_short(error, 200)}",
                "correct that element",
            )
        ]
    return []
