"""From a design to URDF, through xacro: the tree goes to a YAML file that the template reads."""

from __future__ import annotations

import hashlib
import json
import math
import re
import tempfile
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from hyperleg_design import resources
from hyperleg_design.robot.kinematics.kinematic_tree import Link, Shape, Tree, TreeJoint
from hyperleg_design.robot.kinematics.tree import build_tree

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign

TEMPLATE = "robot.urdf.xacro"
TEMPLATE_DIGEST = "86c812895368fa181a629bcaa213c80951626200cfe293d450b733bea4a3034b"
"""SHA-256 of the shipped template, which uses numbers of the tree in one way besides writing them
out: it asks whether a mass is above zero. It is expanded once for all robots that differ in numbers
only; another template is expanded for each robot."""
_MARK = re.compile(r"-?7\.(\d{5})1e\+200")
"""What stands for a number while the template is expanded; no robot has numbers as large."""


def tree_mapping(tree: Tree) -> dict[str, Any]:
    """Write a kinematic tree as plain mappings, the input of the xacro template.

    Args:
        tree: the robot.

    Returns:
        `links` and `joints`, each by name.
    """
    return {
        "links": {link.name: _link(link) for link in tree.links},
        "joints": {joint.name: _joint(joint) for joint in tree.joints},
    }


def tree_yaml(tree: Tree) -> str:
    """Write a kinematic tree as YAML, with numbers in full precision.

    Args:
        tree: the robot.

    Returns:
        The text of `tree_mapping`.
    """
    return _yaml(tree_mapping(tree))


def _yaml(mapping: Mapping[str, Any]) -> str:
    return yaml.dump(
        mapping,
        Dumper=getattr(yaml, "CSafeDumper", yaml.SafeDumper),
        sort_keys=False,
        default_flow_style=None,
        width=140,
    )


def urdf(design: RobotDesign, tree: Tree | None = None) -> str:
    """URDF of one robot; its tree may be given if it is already there.

    Args:
        design: one robot; batches are refused.
        tree: kinematic tree of the design where it was computed before.

    Returns:
        The XML text, SI units, numbers in full precision.

    Raises:
        InputError: a batch of designs.
    """
    tree = tree or build_tree(design)
    mapping = tree_mapping(tree)
    template = resources.content_folder("descriptions") / TEMPLATE
    if hashlib.sha256(template.read_bytes()).hexdigest() != TEMPLATE_DIGEST:
        return expanded(template, mapping, tree.name)
    values: list[float] = []
    outline = json.dumps(_outline(mapping, values))
    literals, order = _prepared(template, outline, tree.name)
    filled = [text + str(values[i]) for text, i in zip(literals, order, strict=False)]
    return "".join([*filled, literals[-1]])


def expanded(template: Path, mapping: Mapping[str, Any], name: str) -> str:
    """Expand the xacro template.

    Args:
        template: the file.
        mapping: links and joints, as `tree_mapping` gives them.
        name: of the robot.

    Returns:
        The XML text of the URDF.
    """
    import xacro

    with tempfile.TemporaryDirectory(prefix="hyperleg-") as folder:
        path = Path(folder) / "tree.yaml"
        path.write_text(_yaml(mapping))
        document = xacro.process_file(str(template), mappings={"tree": str(path)})
    # xacro reads the root's attributes before any argument
    document.documentElement.setAttribute("name", name)
    body: str = document.documentElement.toprettyxml(indent="  ")
    return f'<?xml version="1.0"?>\n{body}'


def _outline(value: Any, values: list[float]) -> Any:
    """A mapping with a mark of the same sign in place of each number, which goes to `values`.

    Numbers that are zero stay, because the template asks whether a mass is.
    """
    if isinstance(value, Mapping):
        return {key: _outline(inner, values) for key, inner in value.items()}
    if isinstance(value, list):
        return [_outline(inner, values) for inner in value]
    if not isinstance(value, float) or value == 0 or not math.isfinite(value):
        return value
    values.append(value)
    return math.copysign(float(f"7.{len(values) - 1:05d}1e+200"), value)


@lru_cache(maxsize=64)
def _prepared(template: Path, outline: str, name: str) -> tuple[list[str], list[int]]:
    """The expanded template of all robots with the same outline: the texts between numbers, and
    which number follows each of them.
    """
    text = expanded(template, json.loads(outline), name)
    parts = _MARK.split(text)
    return parts[::2], [int(number) for number in parts[1::2]]


def _link(link: Link) -> dict[str, Any]:
    i = link.inertia
    return {
        "mass": link.mass,
        "com": link.com.tolist(),
        "inertia": [float(v) for v in (i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2])],
        "visuals": [_shape(s) for s in link.visuals],
        "pads": [_shape(s) for s in link.pads],
    }


def _shape(shape: Shape) -> dict[str, Any]:
    return {
        "kind": shape.kind,
        "size": [float(v) for v in shape.size],
        "position": [float(v) for v in shape.position],
    }


def _joint(joint: TreeJoint) -> dict[str, Any]:
    turn = {"turn": [float(v) for v in joint.turn]} if any(joint.turn) else {}
    return {
        "parent": joint.parent,
        "child": joint.child,
        "position": [float(v) for v in joint.position],
        **turn,
        "axis": [float(v) for v in joint.axis],
        "fixed": joint.fixed,
        "lower": joint.lower,
        "upper": joint.upper,
        "effort": joint.effort,
        "velocity": joint.velocity,
        "coulomb": float(joint.coulomb),
        "viscous": float(joint.viscous),
    }
