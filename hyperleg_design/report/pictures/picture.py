"""The robot in three dimensions, drawn by pyvista without a screen.

Drawing happens in a process of its own: graphics libraries end the whole process where they fail,
and a report should not die of a missing picture.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from hyperleg_design.errors import HyperlegError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.described import prefixed
from hyperleg_design.robot.names import ACTUATOR_OF_MOTOR, MOTORS, SIDES
from hyperleg_design.robot.posture import axis_rotation, default_angles, link_poses, lowest_point
from hyperleg_design.robot.tree import SIGN, Tree, build_tree
from hyperleg_design.writing import write_bytes

if TYPE_CHECKING:
    from hyperleg_design.robot.described import RobotDesign
    from hyperleg_design.robot.design import Design
    from hyperleg_design.robot.tree_design import TreeDesign

FRAME, DARK, PAD = "#c9cdd4", "#8b93a1", "#2b2d33"
TOE = {"active": "#e07b39", "locked": "#9aa0aa"}
MOTOR_COLOUR = {
    "hip_yaw": "#4c72b0",
    "hip_roll": "#4c72b0",
    "hip_pitch": "#4c72b0",
    "knee": "#55a868",
    "ankle": "#8172b3",
    "toe": "#e07b39",
}
TIMEOUT = 180.0
"""Longest that one picture may take [s]."""


@dataclass(frozen=True)
class Solid:
    """A coloured primitive in the world."""

    kind: str
    """`box`, `cylinder` (z), `sphere` or `capsule` (z)."""
    size: tuple[float, ...]
    """Full sizes, radius and length, or radius [m]."""
    rotation: np.ndarray
    position: np.ndarray
    colour: str
    opacity: float = 1.0


@dataclass(frozen=True)
class Scene:
    """The bodies, lines, labels and camera of one picture."""

    solids: tuple[Solid, ...] = ()
    lines: tuple[tuple[np.ndarray, np.ndarray, str, float], ...] = ()
    """Lines: start and end [m], colour, width [px]."""
    labels: tuple[tuple[np.ndarray, str, str], ...] = ()
    """Place [m], text, colour."""
    arrows: tuple[tuple[np.ndarray, np.ndarray, str], ...] = ()
    """Arrows: start [m], vector [m], colour."""
    camera: tuple[tuple[float, float, float], tuple[float, float, float]] = (
        (2.0, -2.0, 0.9),
        (0.0, 0.0, 0.45),
    )
    """Eye and focus [m]."""
    height: float = 1.1
    """What the picture's height spans [m]."""
    size: tuple[int, int] = (900, 1000)
    """Width and height of the picture [px]."""
    font: int = 20


def render(scene: Scene, path: str | os.PathLike[str]) -> Path:
    """Draw a scene into a PNG file.

    Args:
        scene: what is drawn.
        path: of the file.

    Returns:
        The path.

    Raises:
        HyperlegError: this machine cannot draw (no OpenGL), or drawing fails.
    """
    return write_bytes(path, drawn(scene, path))


def drawn(what: Any, path: str | os.PathLike[str]) -> bytes:
    """Draw a scene or a motion with `report.pictures.draw`, in a process of its own.

    Args:
        what: anything that `report.draw` knows.
        path: for messages.

    Returns:
        A PNG file, or an `.npy` file of frames.

    Raises:
        HyperlegError: this machine cannot draw (no OpenGL), or drawing fails.
    """
    environment = dict(os.environ)
    if not environment.get("DISPLAY") and sys.platform.startswith("linux"):
        environment.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    with tempfile.TemporaryDirectory(prefix="hyperleg-") as folder:
        source, target = Path(folder) / "scene.pickle", Path(folder) / "picture"
        source.write_bytes(pickle.dumps(what))
        command = [
            sys.executable,
            "-m",
            "hyperleg_design.report.pictures.draw",
            str(source),
            str(target),
        ]
        try:
            done = subprocess.run(
                command,
                capture_output=True,
                text=True,
                timeout=TIMEOUT,
                env=environment,
                check=False,
            )
        except subprocess.TimeoutExpired:
            raise HyperlegError(f"{path}: drawing took longer than {TIMEOUT:g} s") from None
        if done.returncode or not target.exists():
            last = (done.stderr.strip().splitlines() or ["no message"])[-1]
            raise HyperlegError(
                f"{path}: cannot draw in 3-D on this machine ({last}); install an OpenGL library "
                f"such as libegl1"
            )
        return target.read_bytes()


def robot_solids(
    design: RobotDesign,
    *,
    angles: Mapping[str, float] | None = None,
    offset: Sequence[float] = (0.0, 0.0, 0.0),
    yaw: float = 0.0,
    opacity: float = 1.0,
    motors: bool = True,
    tree: Tree | None = None,
    pelvis: tuple[np.ndarray, np.ndarray] | None = None,
) -> list[Solid]:
    """Place the solids of a robot that stands with its lowest sole pad at the height of `offset`,
    or whose pelvis has a given pose.

    Args:
        design: one robot.
        angles: joint angles [rad] by joint name, zero where not named.
        offset: of the point below the pelvis's origin [m].
        yaw: turn of the whole robot [rad].
        opacity: 0 to 1.
        motors: draw the motors where the design houses them.
        tree: the design's tree, if it is already there.
        pelvis: rotation `(3, 3)` and position [m] of the pelvis in the world, instead of `offset`
            and `yaw`.

    Returns:
        The solids in the world.
    """
    tree = tree or build_tree(design)
    poses = link_poses(tree, angles)
    base = (
        np.zeros(3)
        if pelvis is not None
        else np.asarray(offset, float) - np.array([0.0, 0.0, lowest_point(tree, poses)])
    )
    solids = []
    for link, own in link_solids(design, tree, opacity=opacity, motors=motors).items():
        rotation, position = poses[link]
        solids += [
            replace(
                s,
                rotation=rotation @ s.rotation,
                position=base + position + rotation @ s.position,
            )
            for s in own
        ]
    if pelvis is not None:
        turn, place = pelvis
        return [
            replace(s, rotation=turn @ s.rotation, position=place + turn @ s.position)
            for s in solids
        ]
    if not yaw:
        return solids
    turn, centre = axis_rotation(np.array([0.0, 0.0, 1.0]), yaw), np.asarray(offset, float)
    return [
        replace(s, rotation=turn @ s.rotation, position=centre + turn @ (s.position - centre))
        for s in solids
    ]


def link_solids(
    design: RobotDesign, tree: Tree, *, opacity: float = 1.0, motors: bool = True
) -> dict[str, list[Solid]]:
    """Collect the solids of each link in the link's own frame.

    Args:
        design: one robot of any family.
        tree: of the design.
        opacity: 0 to 1.
        motors: draw the motors where the design houses them.

    Returns:
        Solids by link.
    """
    toe = TOE.get(str(design["toe.joint"]), TOE["locked"]) if tree.hyperleg else FRAME
    solids: dict[str, list[Solid]] = {}
    for link in tree.links:
        own = solids.setdefault(link.name, [])
        for shape in link.visuals:
            kind = "capsule" if shape.kind == "cylinder" and tree.hyperleg else shape.kind
            colour = FRAME
            if link.name.endswith("toe_plate"):
                colour = toe
            elif shape.kind == "sphere":
                colour = DARK
            fade = 0.35 if kind in ("capsule", "cylinder") and motors else opacity
            own.append(
                Solid(
                    kind,
                    shape.size,
                    np.eye(3),
                    np.array(shape.position),
                    colour,
                    min(opacity, fade),
                )
            )
        own += [
            Solid("sphere", pad.size, np.eye(3), np.array(pad.position), PAD, opacity)
            for pad in link.pads
        ]
    if motors:
        add = _motor_solids if tree.hyperleg else _tree_motor_solids
        for name, solid in add(cast("Any", design), tree, opacity):
            solids[name].append(solid)
    return solids


def _motor_radius(mass: float) -> float:
    """Of a disc of 6500 kg/m^3, steel and copper, that is 0.8 of its radius thick [m]."""
    return float(np.cbrt(mass / (6500 * np.pi * 0.8)))


_ACROSS = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""Turns a cylinder's z axis onto y."""


def _motor_solids(design: Design, tree: Tree, opacity: float) -> Iterator[tuple[str, Solid]]:
    """Motors of HyperLeg's legs as discs of their mass, each with the link that houses it."""
    from hyperleg_design.robot.motors import motor_arrays

    mass = motor_arrays(design).mass
    for side in SIDES:
        for index, motor in enumerate(MOTORS):
            if motor not in transmission.motor_names(design):
                continue
            name = ACTUATOR_OF_MOTOR[index]
            actuator = getattr(design.actuators, name)
            radius = _motor_radius(mass[index])
            if actuator.housed_in == "pelvis":
                link = "pelvis"
                lift = {"hip_yaw": 0.05, "hip_roll": 0.0, "hip_pitch": 0.0}.get(name, 0.1)
                turn = {
                    "hip_yaw": np.eye(3),
                    "hip_roll": np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]),
                }.get(name, _ACROSS)
                place = np.array(
                    [0.07 if name == "hip_roll" else 0.0, SIGN[side] * design.hip.spacing / 2, lift]
                )
            else:
                link, turn = f"{side}_{actuator.housed_in}", _ACROSS
                shift = {"ankle_left": 0.016, "ankle_right": -0.016}.get(motor, 0.0)
                outward = 0.06 if name == "hip_pitch" else 0.0
                depth = actuator.position_fraction * getattr(design, actuator.housed_in).length
                place = np.array([0.0, SIGN[side] * outward + shift * 1.4, -depth])
            thickness = radius * (0.8 if name != "ankle" else 0.7)
            yield (
                link,
                Solid("cylinder", (radius, thickness), turn, place, MOTOR_COLOUR[name], opacity),
            )


def _tree_motor_solids(
    design: TreeDesign, tree: Tree, opacity: float
) -> Iterator[tuple[str, Solid]]:
    """Motors of a robot that writes its tree out as discs of their mass, each with its link."""
    from hyperleg_design.robot.motors import find_motor
    from hyperleg_design.robot.tree_limb import copied

    colours = tuple(dict.fromkeys(MOTOR_COLOUR.values()))
    for copy, section in design.copy_sections.items():
        for index, actuator in enumerate(design.actuator_sections.values()):
            in_root = actuator.housed_in == design.trunk.link
            link = tree.base if in_root else prefixed(copy, str(actuator.housed_in))
            place = copied(section, np.asarray(actuator.place, float), move=in_root)
            radius = _motor_radius(find_motor(str(actuator.motor)).mass)
            yield (
                link,
                Solid(
                    "cylinder",
                    (radius, 0.8 * radius),
                    _ACROSS,
                    place,
                    colours[index % len(colours)],
                    opacity,
                ),
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
