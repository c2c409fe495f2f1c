"""From a design to URDF, through xacro: the tree goes to a YAML file that the template reads."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from hyperleg_design import resources
from hyperleg_design.robot.kinematic_tree import Link, Shape, Tree, TreeJoint
from hyperleg_design.robot.tree import build_tree

if TYPE_CHECKING:
    from hyperleg_design.robot.described import RobotDesign

TEMPLATE = "robot.urdf.xacro"


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
    return yaml.dump(
        tree_mapping(tree),
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
    import xacro

    tree = tree or build_tree(design)
    with tempfile.TemporaryDirectory(prefix="hyperleg-") as folder:
        path = Path(folder) / "tree.yaml"
        path.write_text(tree_yaml(tree))
        document = xacro.process_file(
            str(resources.content_folder("descriptions") / TEMPLATE), mappings={"tree": str(path)}
        )
    document.documentElement.setAttribute(
        "name", tree.name
    )  # xacro reads the root's attributes before any argument
    body: str = document.documentElement.toprettyxml(indent="  ")
    return f'<?xml version="1.0"?>\n{body}'


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
