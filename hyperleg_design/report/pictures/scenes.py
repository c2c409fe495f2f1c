"""Scenes of a robot that reports draw: its dimensions, joint axes and masses, and its variants side
by side.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.report.pictures.picture import Scene, Solid
from hyperleg_design.report.pictures.solids import robot_solids
from hyperleg_design.robot import transmission
from hyperleg_design.robot.kinematics.posture import default_angles, link_poses, lowest_point
from hyperleg_design.robot.kinematics.tree import build_tree

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design
    from hyperleg_design.robot.parameters.described import RobotDesign


def robot_scene(design: RobotDesign) -> Scene:
    """Prepare a picture of a robot of any family in its default posture.

    Args:
        design: one robot.

    Returns:
        The scene; it shows the whole robot, whatever its size.
    """
    tree = build_tree(design)
    solids = robot_solids(design, angles=default_angles(tree), yaw=np.deg2rad(40), tree=tree)
    places = np.array([solid.position for solid in solids] or [np.zeros(3)])
    reach = np.array([solid.reach for solid in solids] or [np.zeros(3)])
    low, high = (places - reach).min(0), (places + reach).max(0)
    middle, extent = (low + high) / 2, max(float((high - low).max()), 0.2)
    camera = (tuple(middle + np.array([5.0 * extent, 0.0, extent])), tuple(middle))
    return Scene(
        tuple(solids), (), (), camera=camera, height=1.25 * extent, size=(1000, 820), font=24
    )


def dimensions_scene(design: Design) -> Scene:
    """Prepare a picture of the robot from the left side with its lengths.

    Args:
        design: one robot.

    Returns:
        The scene.
    """
    tree = build_tree(design)
    hip = float(design.thigh.length + design.shank.length + design.foot.ankle_height)
    top = hip + float(design.pelvis.height)
    knee, ankle = hip - float(design.thigh.length), float(design.foot.ankle_height)
    near = np.array([0.0, -0.35, 0.0])
    front, back = 0.27, -0.17
    ticks = [
        (0.0, ankle, f"ankle {ankle * 1e3:.0f}"),
        (ankle, knee, f"shank {design.shank.length * 1e3:.0f}"),
        (knee, hip, f"thigh {design.thigh.length * 1e3:.0f}"),
        (hip, top, f"pelvis {design.pelvis.height * 1e3:.1f}"),
    ]
    lines, labels = [], []
    for low, high, text in ticks:
        lines += _dimension(
            np.array([front, 0, low]) + near,
            np.array([front, 0, high]) + near,
            np.array([0.02, 0, 0]),
        )
        labels.append((np.array([front + 0.02, 0, (low + high) / 2]) + near, text, "#333333"))
    for low, high, x, text in (
        (0.0, hip, back, f"leg {hip * 1e3:.0f}"),
        (0.0, top, back - 0.155, f"height {top * 1e3:.1f}"),
    ):
        lines += _dimension(
            np.array([x, 0, low]) + near, np.array([x, 0, high]) + near, np.array([0.02, 0, 0])
        )
        place = np.array([x - 0.03, 0, high + 0.022])
        labels.append((place + near, text, "#333333"))
    foot = (
        -float(design.foot.heel_length),
        0.0,
        float(design.foot.ball_length),
        float(design.foot.ball_length + design.toe.length),
    )
    for (a, b), text in zip(
        ((foot[0], foot[1]), (foot[1], foot[2]), (foot[2], foot[3])),
        ("heel", "ball", "toe"),
        strict=True,
    ):
        lines += _dimension(
            np.array([a, 0, -0.03]) + near, np.array([b, 0, -0.03]) + near, np.array([0, 0, 0.012])
        )
        place = np.array([(a + b) / 2 - 0.04, 0, -0.088 if text == "ball" else -0.058])
        labels.append((place + near, f"{text} {(b - a) * 1e3:.0f}", "#333333"))
    return Scene(
        tuple(robot_solids(design, tree=tree)),
        tuple(lines),
        tuple(labels),
        camera=((0.06, -4.0, 0.46), (0.06, 0.0, 0.46)),
        height=1.16,
        size=(820, 1000),
        font=24,
    )


def _dimension(
    start: np.ndarray, end: np.ndarray, tick: np.ndarray
) -> list[tuple[np.ndarray, np.ndarray, str, float]]:
    return [
        (start, end, "#555555", 2.0),
        (start - tick / 2, start + tick / 2, "#555555", 2.0),
        (end - tick / 2, end + tick / 2, "#555555", 2.0),
    ]


def frames_scene(design: Design) -> Scene:
    """Prepare a picture of the joint axes of both legs; arrows point along the axes about which
    angles are positive.

    Args:
        design: one robot.

    Returns:
        The scene.
    """
    tree = build_tree(design)
    angles = default_angles(tree)
    poses = link_poses(tree, angles)
    base = np.array([0.0, 0.0, -lowest_point(tree, poses)])
    colours = {
        "yaw": "#2f6db3",
        "roll": "#c44e52",
        "pitch": "#3b8f57",
        "knee": "#3b8f57",
        "toe": "#e07b39",
    }
    arrows, labels = [], []
    for joint in tree.moving:
        rotation, position = poses[joint.child]
        kind = joint.name.rsplit("_", 1)[-1]
        axis = rotation @ np.array(joint.axis)
        start = base + position
        arrows.append((start, 0.13 * axis, colours[kind]))
        if joint.name.startswith("left"):
            lift = {"roll": 0.03}.get(kind, 0.0) * np.array([0.0, 0.0, 1.0])
            labels.append(
                (
                    start + 0.15 * axis + lift,
                    joint.name.removeprefix("left_").replace("_", " "),
                    colours[kind],
                )
            )
    return Scene(
        tuple(robot_solids(design, angles=angles, opacity=0.45, motors=False, tree=tree)),
        (),
        tuple(labels),
        tuple(arrows),
        camera=((2.2, 2.6, 1.25), (0.02, 0.08, 0.46)),
        height=1.16,
        size=(820, 1000),
        font=24,
    )


def masses_scene(design: Design) -> Scene:
    """Prepare a picture of the segments' masses, as balls of their size at the centres of mass, and
    of the motors.

    Args:
        design: one robot.

    Returns:
        The scene.
    """
    from hyperleg_design.robot.masses import mass_table

    tree = build_tree(design)
    poses = link_poses(tree)
    base = np.array([0.0, 0.0, -lowest_point(tree, poses)])
    table = mass_table(design)
    shown = {
        "pelvis": table.pelvis,
        "thigh": table.thigh,
        "shank": table.shank,
        "foot": table.foot,
        "toe_plate": table.toe,
    }
    balls, labels, lines = [], [], []
    for name, mass in shown.items():
        link = tree.link(name if name == "pelvis" else f"left_{name}")
        rotation, position = poses[link.name]
        place = base + position + rotation @ link.com
        balls.append(
            Solid(
                "sphere",
                (float(np.cbrt(max(mass, 1e-3) / 6500 / 4.19)),),
                np.eye(3),
                place,
                "#d1495b",
                0.9,
            )
        )
        lift = {"foot": 0.05, "toe_plate": -0.03}.get(name, 0.0)
        target = np.array([0.3, 0.24, place[2] + lift])
        lines.append((place, target, "#888888", 1.5))
        labels.append(
            (
                target + np.array([0, 0.012, 0]),
                f"{name.removesuffix('_plate')} {mass:.2f} kg",
                "#333333",
            )
        )
    return Scene(
        (*robot_solids(design, opacity=0.45, tree=tree), *balls),
        tuple(lines),
        tuple(labels),
        camera=((4.0, 0.14, 0.47), (0.0, 0.14, 0.47)),
        height=1.12,
        size=(820, 1000),
        font=24,
    )


def variants_scene(designs: Mapping[str, Design]) -> Scene:
    """Prepare a picture of robots side by side, each with its name and mass.

    Args:
        designs: robots by name.

    Returns:
        The scene.
    """
    from hyperleg_design.robot.masses import mass_table

    solids, labels = [], []
    gap = 0.66
    start = -gap * (len(designs) - 1) / 2
    for index, (name, design) in enumerate(designs.items()):
        tree = build_tree(design)
        y = start + gap * index
        solids += robot_solids(
            design, angles=default_angles(tree), offset=(0.0, y, 0.0), yaw=np.deg2rad(40), tree=tree
        )
        label = (
            f"{name.replace('_', ' ')}\n{float(mass_table(design).total):.2f} kg, "
            f"{2 * len(transmission.motor_names(design))} motors"
        )
        labels.append((np.array([0.1, y - 0.2, 1.1]), label, "#333333"))
    width = 0.2 + gap * len(designs)
    size = (int(820 * width / 1.25), 820)
    return Scene(
        tuple(solids),
        (),
        tuple(labels),
        camera=((4.0, 0.0, 1.1), (0.0, 0.0, 0.53)),
        height=1.25,
        size=size,
        font=24,
    )
