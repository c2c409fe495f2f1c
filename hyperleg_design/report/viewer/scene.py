"""One robot in viser's scene: a frame a link with the link's solids in it, and force arrows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.report.pictures.picture import Solid
from hyperleg_design.report.pictures.solids import link_solids
from hyperleg_design.robot.kinematics.posture import Pose, default_angles, link_poses, lowest_point
from hyperleg_design.robot.kinematics.tree import build_tree

if TYPE_CHECKING:
    from collections.abc import Mapping

    import trimesh

    from hyperleg_design.report.viewer.walk import RecordedWalk
    from hyperleg_design.robot.parameters.described import RobotDesign

_FORCE = (44, 122, 75)


class RobotView:
    """A robot in the scene, which can be exchanged for another and put into postures."""

    def __init__(self, server: Any, name: str, place: Sequence[float]) -> None:
        """Nothing is shown yet.

        Args:
            server: viser's.
            name: of the robot in the scene.
            place: point of the floor at which it stands [m], `(3,)`.
        """
        self._server, self._name, self._place = server, name, np.asarray(place, float)
        self._root: Any = None
        self._links: dict[str, Any] = {}
        self._arrows: Any = None
        self.contacts: list[tuple[np.ndarray, np.ndarray]] = []
        """Points in the base's frame [m] and forces in the world [N] of what `play` shows."""

    def show(self, design: RobotDesign) -> None:
        """Draw a design in its default posture, in place of what was shown.

        Args:
            design: one robot.
        """
        self._server.scene.remove_by_name(self._name)
        self._links, self._arrows = {}, None
        self.tree = build_tree(design)
        self._root = self._server.scene.add_frame(self._name, show_axes=False)
        for link, solids in link_solids(design, self.tree).items():
            self._links[link] = self._server.scene.add_frame(
                f"{self._name}/{link}", show_axes=False
            )
            for number, solid in enumerate(solids):
                put_solid(self._server, f"{self._name}/{link}/{number}", solid)
        self._joints = {joint.name for joint in self.tree.moving}
        self.pose(default_angles(self.tree))

    def pose(self, angles: Mapping[str, float], base: Pose | None = None, arrows: Any = ()) -> None:
        """Put the robot into a posture.

        Args:
            angles: by joint [rad].
            base: rotation and position of the base, x and y left out; by default upright, with the
                lowest pad on the floor, or where the design fixes it.
            arrows: points in the base's frame [m] and vectors in the world [m].
        """
        poses = link_poses(self.tree, angles)
        if base is None:
            height = self.tree.height if not self.tree.floating else -lowest_point(self.tree, poses)
            base = np.eye(3), np.array([0.0, 0.0, height])
        turn, position = base[0], self._place + np.array([0.0, 0.0, base[1][2]])
        with self._server.atomic():
            self._root.wxyz, self._root.position = quaternion(turn), position
            for link, (rotation, place) in poses.items():
                handle = self._links[link]
                handle.wxyz, handle.position = quaternion(rotation), place
            self._show_arrows([(position + turn @ point, vector) for point, vector in arrows])

    def _show_arrows(self, arrows: Sequence[tuple[np.ndarray, np.ndarray]]) -> None:
        points = np.array([[start, start + vector] for start, vector in arrows])
        if not len(points):
            if self._arrows is not None:
                self._arrows.visible = False
            return
        self._arrows = self._server.scene.add_arrows(
            f"{self._name}_forces",
            points,
            _FORCE,
            shaft_radius=0.008,
            head_radius=0.02,
            head_length=0.045,
        )

    def play(self, walk: RecordedWalk, row: int, weight: float, scale: float) -> None:
        """Show a tick of a walk, on the spot.

        Args:
            walk: of a robot with this one's joints.
            row: tick.
            weight: of the robot [N].
            scale: length of an arrow for one body weight [m].
        """
        angles = walk.angles(row)
        own = {name: angle for name, angle in angles.items() if name in self._joints}
        self.contacts = walk.contacts(row, self.tree, link_poses(self.tree, own))
        arrows = [(point, scale / weight * force) for point, force in self.contacts]
        self.pose(own, walk.base(row), arrows)


def put_solid(server: Any, name: str, solid: Solid) -> Any:
    """Add a solid to viser's scene.

    Args:
        server: viser's server.
        name: of the node.
        solid: what is added.

    Returns:
        Its handle.
    """
    mesh = _mesh(solid)
    return server.scene.add_mesh_simple(
        name,
        mesh.vertices,
        mesh.faces,
        color=tuple(int(solid.colour[i : i + 2], 16) for i in (1, 3, 5)),
        opacity=solid.opacity if solid.opacity < 1 else None,
        flat_shading=solid.kind == "box",
        wxyz=quaternion(solid.rotation),
        position=solid.position,
    )


def _mesh(solid: Solid) -> trimesh.Trimesh:
    import trimesh

    if solid.kind == "box":
        return trimesh.creation.box(extents=solid.size)
    if solid.kind == "cylinder":
        return trimesh.creation.cylinder(radius=solid.size[0], height=solid.size[1])
    if solid.kind == "capsule":
        mesh = trimesh.creation.capsule(radius=solid.size[0], height=solid.size[1])
        # trimesh's begins at its lower end in some versions
        mesh.apply_translation([0.0, 0.0, -float(mesh.bounds.mean(0)[2])])
        return mesh
    return trimesh.creation.icosphere(radius=solid.size[0], subdivisions=2)


def quaternion(rotation: np.ndarray) -> np.ndarray:
    """Convert a rotation to a quaternion.

    Args:
        rotation: `(3, 3)`.

    Returns:
        w x y z, `(4,)`.
    """
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_matrix(rotation).as_quat())[[3, 0, 1, 2]]
