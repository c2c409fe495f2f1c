"""Whether a URDF describes a robot: any URDF, not only ours.

Beyond what ROS's `check_urdf` sees (syntax, one root, names), this looks at the numbers: masses,
inertias that a body can have, ranges that can be reached, axes.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import in_short
from hyperleg_design.robot.checks.check_units import LARGEST_STEP, check_units, step_of
from hyperleg_design.robot.checks.check_urdf_joint import check_joint
from hyperleg_design.robot.checks.check_urdf_link import check_link
from hyperleg_design.robot.checks.check_urdf_mass import check_mass
from hyperleg_design.robot.checks.finding import Finding
from hyperleg_design.robot.checks.mesh_files import check_packages
from hyperleg_design.robot.checks.urdf_xml import ends_of, numbers, parse_xml, place_of


def check_urdf(source: str | Path, *, meshes: bool = True) -> list[Finding]:
    """Everything wrong with a URDF.

    Args:
        source: a path, or the text itself.
        meshes: whether to look for the meshes that a file names.

    Returns:
        Findings, errors first; empty where nothing is wrong.

    Raises:
        InputError: the file cannot be read.
    """
    root, findings = parse_xml(source, "robot", "a URDF starts with <robot name=...>")
    if root is None:
        return findings
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
    carried = {end for joint in joints if joint.get("type") == "fixed" for end in ends_of(joint)}
    is_text = isinstance(source, str) and source.lstrip().startswith("<")
    drawn = Path(source) if meshes and not is_text else None
    for link in links:
        findings += check_link(link, drawn, carried=link.get("name") in carried)
    for joint in joints:
        findings += check_joint(joint, {j.get("name") for j in joints})
    findings += _weightless(links, joints)
    if drawn is not None:
        findings += check_packages(root, drawn)
    units = [finding for joint in joints for finding in check_units(joint)]
    if not any(f.severity == "error" for f in findings):
        far = any(np.linalg.norm(step_of(joint)) > LARGEST_STEP for joint in joints)
        findings += _loads(root, metre=1000.0 if far else 1.0)
    findings += units
    return sorted(findings, key=lambda f: f.severity != "error")


def _names(elements: Iterable[Any]) -> list[Finding]:
    elements = list(elements)
    findings = [
        Finding("error", place_of(e), "has no name", "add name=")
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
                    place_of(element),
                    "has a name that stands twice",
                    "names must be unique; rename one",
                )
            )
    return findings


def _tree(links: list[Any], joints: list[Any]) -> list[Finding]:
    """One root, every link behind it, no loops."""
    findings: list[Finding] = []
    names = {link.get("name"): link for link in links}
    joint_of: dict[str, Any] = {}
    children: dict[str, list[str]] = {}
    for joint in joints:
        parent, child = ends_of(joint)
        for role, link in (("parent", parent), ("child", child)):
            if link is None:
                findings.append(
                    Finding(
                        "error",
                        place_of(joint),
                        f"has no <{role} link=...>",
                        "a joint connects two links",
                    )
                )
            elif link not in names:
                findings.append(
                    Finding(
                        "error",
                        place_of(joint),
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
                    place_of(joint),
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
                place_of(names[looped[0]]),
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
                    place_of(names[name]),
                    f"is loose{size}: no joint connects it to {main!r}",
                    "add the joint, or remove the link",
                )
            )
    return findings


def _weightless(links: list[Any], joints: list[Any]) -> list[Finding]:
    """Links that move though nothing rigidly connected to them weighs anything."""
    group = {link.get("name"): link.get("name") for link in links}

    def head(name: Any) -> Any:
        while group[name] != name:
            name = group[name]
        return name

    moving = {}
    for joint in joints:
        parent, child = ends_of(joint)
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
            place_of(by_name[name]),
            f"moves with joint {joint.get('name')!r} but has no mass",
            remedy,
        )
        for name, joint in moving.items()
        if weight[head(name)] == 0
    ]


def _loads(root: Any, metre: float) -> list[Finding]:
    """Whether Pinocchio, which analyses it, takes it, and whether its mass fits its size, where a
    metre has this length in the file.
    """
    import pinocchio
    from lxml import etree  # type: ignore[import-untyped]

    try:
        model = pinocchio.buildModelFromXML(etree.tostring(root, encoding="unicode"))
    except (ValueError, RuntimeError) as error:
        return [
            Finding(
                "error",
                "<robot>",
                f"Pinocchio does not load it: {in_short(error, 200)}",
                "correct that element",
            )
        ]
    return check_mass(model, metre)
