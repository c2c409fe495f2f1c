"""The robot as an SVG drawing for a page, its joints coloured by their share of the gap."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.model import robot_file
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.simulation.model import simulation_spec

WIDTH, TALLEST, LOWEST = 460.0, 300.0, 150.0
"""Width of the drawing, and its largest and least height; a page scales it."""
MARGIN, MIDDLE = 14.0, 130.0
"""Around the drawing, and the largest width of the robot in it: names stand on both sides."""
TURN, TILT = np.radians(30.0), np.radians(14.0)
"""Turn of the view about the vertical, from the side on which most joints bend, and its tilt from
above [rad]: left and right legs do not hide each other."""
NAMED, LEAST_NAMED = 5, 0.02
"""Largest number of joints that are named, and the least share of one."""
LINE = 15.0
"""Height of a name."""
SMALL, LARGE = 3.5, 8.0
"""Radii of joints without a share and with the largest."""
COLOURS = ((0.0, (154, 163, 175)), (0.5, (224, 144, 47)), (1.0, (198, 40, 40)))
"""Red, green and blue of a share of the largest share; legible on a light and a dark page."""
CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
ROUND = 12
"""Points of a circle."""


@dataclass(frozen=True, eq=False)
class Shapes:
    """What is drawn, in the world [m]: a cloud of points a body part, and the places of joints."""

    parts: tuple[np.ndarray, ...]
    """`(k, 3)` each; a part is drawn as the convex outline of its points."""
    sticks: tuple[np.ndarray, ...]
    """From each joint to the one before it, or to the base, and to the centre of mass of the body
    that it moves `(2, 3)` each; of robots whose files draw no shapes there is nothing else."""
    places: np.ndarray
    """Of the joints `(n, 3)`."""
    axes: np.ndarray
    """Of the joints `(n, 3)`."""


def robot_svg(subject: Subject, shares: Mapping[str, float]) -> str:
    """Draw the robot at rest as an SVG element.

    Args:
        subject: the robot.
        shares: of the gap, by joint or motor name; links count for the joint that carries them.

    Returns:
        The element as text.
    """
    shapes = shapes_of(subject)
    share = np.array([share_of(subject, joint, shares) for joint in subject.joints])
    view = _view(shapes.axes)
    clouds = [points @ view for points in shapes.parts]
    flat = shapes.places @ view
    every = np.concatenate([*clouds, flat, *(ends @ view for ends in shapes.sticks)])[:, :2]
    low, high = every.min(0), every.max(0)
    span = np.maximum(high - low, 1e-6)
    scale = float(min((TALLEST - 2 * MARGIN) / span[1], MIDDLE / span[0]))
    height = max(float(span[1]) * scale + 2 * MARGIN, LOWEST)
    centre = (low + high) / 2

    def on_page(points: np.ndarray) -> np.ndarray:
        moved = (points[:, :2] - centre) * scale
        return np.column_stack([WIDTH / 2 + moved[:, 0], height / 2 - moved[:, 1]])

    order = np.argsort([float(cloud[:, 2].mean()) for cloud in clouds], kind="stable")
    lines = [_stick(on_page(ends @ view)) for ends in shapes.sticks]
    lines += [_outline(on_page(clouds[i])) for i in order.tolist()]
    dots, most = on_page(flat), float(share.max(initial=0.0))
    for i in np.argsort(share, kind="stable").tolist():
        part = share[i] / most if most > 0 else 0.0
        lines.append(
            f'<circle cx="{dots[i, 0]:.1f}" cy="{dots[i, 1]:.1f}" '
            f'r="{SMALL + (LARGE - SMALL) * part:.1f}" fill="{_colour(part)}" class="joint">'
            f"<title>{escape(subject.joints[i])}: {100 * share[i]:.0f} %</title></circle>"
        )
    lines += _names(subject.joints, share, dots, height)
    return (
        f'<svg viewBox="0 0 {WIDTH:g} {height:.0f}" role="img" '
        f'aria-label="The robot, its joints coloured by their share of the gap">'
        + "".join(lines)
        + "</svg>"
    )


def shapes_of(subject: Subject) -> Shapes:
    """Collect the shapes and joints of a robot at rest.

    They are those of its file where that can be read again, because the nominal model has few
    shapes left.

    Args:
        subject: the robot.

    Returns:
        The shapes.
    """
    import mujoco

    try:
        model = _drawn_model(subject)
        joints = [model.joint(name).id for name in subject.joints]
    except (InputError, ValueError, KeyError, RuntimeError):
        model, joints = subject.model, [subject.model.joint(n).id for n in subject.joints]
    data = mujoco.MjData(model)
    for joint, angle in zip(joints, subject.default, strict=True):
        data.qpos[model.jnt_qposadr[joint]] = angle
    mujoco.mj_kinematics(model, data)
    parts = tuple(
        cloud for geom in range(model.ngeom) if (cloud := _points(model, data, geom)) is not None
    )
    places, axes = data.xanchor[joints], data.xaxis[joints]
    return Shapes(parts, _sticks(model, data, joints), places, axes)


def _drawn_model(subject: Subject) -> Any:
    from pathlib import Path

    if subject.design is not None:
        return simulation_spec(subject.design).compile()
    return robot_file.read_spec(Path(subject.path)).compile()


def _points(model: Any, data: Any, geom: int) -> np.ndarray | None:
    """Points on a geom in the world `(k, 3)` [m]; none for planes, fields and what is invisible."""
    import mujoco

    kind, size = int(model.geom_type[geom]), model.geom_size[geom]
    types = mujoco.mjtGeom
    if model.geom_rgba[geom, 3] == 0.0:
        return None
    angle = np.arange(ROUND) * 2 * np.pi / ROUND
    circle = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(ROUND)])
    ball = np.concatenate([circle, circle[:, [0, 2, 1]], circle[:, [2, 0, 1]]])
    if kind == types.mjGEOM_MESH:
        mesh = int(model.geom_dataid[geom])
        first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        own = model.mesh_vert[first : first + count]
    elif kind == types.mjGEOM_BOX:
        own = CORNERS * size
    elif kind in (types.mjGEOM_SPHERE, types.mjGEOM_ELLIPSOID):
        own = ball * (size if kind == types.mjGEOM_ELLIPSOID else size[0])
    elif kind == types.mjGEOM_CYLINDER:
        end = np.array([0, 0, size[1]])
        own = np.concatenate([circle * size[0] + end, circle * size[0] - end])
    elif kind == types.mjGEOM_CAPSULE:
        end = np.array([0, 0, size[1]])
        own = np.concatenate([ball * size[0] + end, ball * size[0] - end])
    else:
        return None
    return np.asarray(own @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom])


def _sticks(model: Any, data: Any, joints: Sequence[int]) -> tuple[np.ndarray, ...]:
    """See `Shapes.sticks`."""
    sticks = []
    joint_of_body = {int(model.jnt_bodyid[joint]): joint for joint in joints}
    for joint in joints:
        body = int(model.jnt_bodyid[joint])
        parent = above = int(model.body_parentid[body])
        while above and above not in joint_of_body:
            above = int(model.body_parentid[above])
        start = data.xanchor[joint_of_body[above]] if above in joint_of_body else data.xpos[parent]
        if parent:
            sticks.append(np.stack([start, data.xanchor[joint]]))
        sticks.append(np.stack([data.xanchor[joint], data.xipos[body]]))
    return tuple(sticks)


def _view(axes: np.ndarray) -> np.ndarray:
    """Right, up and towards the eye as columns `(3, 3)`: along the axis that most joints have, in
    the horizontal, turned and from above.
    """
    level = axes[:, :2]
    matrix = level.T @ level
    towards = np.array([0.0, -1.0])
    if matrix.trace() > 1e-6:
        _, vectors = np.linalg.eigh(matrix)
        towards = vectors[:, -1] * (-1.0 if vectors[1, -1] > 0 else 1.0)
    turned = np.array(
        [
            np.cos(TURN) * towards[0] - np.sin(TURN) * towards[1],
            np.sin(TURN) * towards[0] + np.cos(TURN) * towards[1],
        ]
    )
    eye = np.array([*(np.cos(TILT) * turned), np.sin(TILT)])
    right = np.array([-turned[1], turned[0], 0.0])
    return np.column_stack([right, np.cross(eye, right), eye])


def _outline(points: np.ndarray) -> str:
    """The convex outline of points on the page, or a stroke where they are in line."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        corners = points[ConvexHull(points).vertices]
    except (QhullError, ValueError):
        along = points - points.mean(0)
        direction = np.linalg.svd(along, full_matrices=False)[2][0]
        return _stick(points[np.argsort(along @ direction)[[0, -1]]])
    return f'<polygon points="{_listed(corners)}" class="part"/>'


def _stick(ends: np.ndarray) -> str:
    return f'<polyline points="{_listed(ends)}" class="stick"/>'


def _listed(points: np.ndarray) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points[:, :2])


def _names(joints: Sequence[str], share: np.ndarray, dots: np.ndarray, height: float) -> list[str]:
    """Names of the joints with the largest shares, on the nearer side, none above another."""
    chosen = [i for i in np.argsort(-share, kind="stable")[:NAMED] if share[i] >= LEAST_NAMED]
    lines = []
    for right in (True, False):
        side = sorted(
            (i for i in chosen if (dots[i, 0] >= WIDTH / 2) == right), key=lambda i: dots[i, 1]
        )
        lowest = MARGIN
        for place, i in enumerate(side):
            room = height - MARGIN - LINE * (len(side) - 1 - place)
            y = min(max(float(dots[i, 1]), lowest), room)
            lowest = y + LINE
            x = WIDTH / 2 + (MIDDLE / 2 + 18) * (1 if right else -1)
            anchor = "start" if right else "end"
            away = 4 if right else -4
            lines.append(
                f'<line x1="{dots[i, 0]:.1f}" y1="{dots[i, 1]:.1f}" x2="{x:.1f}" y2="{y:.1f}"/>'
                f'<text x="{x + away:.1f}" y="{y + 4:.1f}" text-anchor="{anchor}">'
                f"{escape(_short(joints[i]))} {100 * share[i]:.0f} %</text>"
            )
    return lines


def _short(name: str, most: int = 17) -> str:
    return name if len(name) <= most else name[: most - 1] + "…"


def _colour(part: float) -> str:
    """Of a share over the largest one."""
    places = [place for place, _ in COLOURS]
    mixed = [round(float(np.interp(part, places, [c[k] for _, c in COLOURS]))) for k in range(3)]
    return "#" + "".join(f"{value:02x}" for value in mixed)


def share_of(subject: Subject, joint: str, shares: Mapping[str, float]) -> float:
    """Compute a joint's share of the gap: its own, those of the links that it carries, and its part
    of those of the motors that turn it.

    Args:
        subject: the robot.
        joint: name of the joint.
        shares: of the gap, by name of joint, link or motor.

    Returns:
        The share [-].
    """
    share = float(shares.get(joint, 0.0))
    if not subject.one_to_one:
        row = np.abs(subject.joint_from_motor[subject.joints.index(joint)])
        whole = np.abs(subject.joint_from_motor).sum(0)
        parts = row / np.maximum(whole, 1e-12)
        share += sum(
            float(shares.get(m, 0.0)) * part
            for m, part in zip(subject.motors, parts, strict=True)
            if m not in subject.joints
        )
    tree = subject.tree
    carried = [
        link
        for link, place in zip(tree.links, tree.link_joint, strict=True)
        if place >= 0 and tree.joints[int(place)] == joint
    ]
    return share + sum(
        float(shares.get(link, 0.0)) for link in carried if link not in subject.joints
    )
