"""A robot in the viewer's scene: solids of the right size, links where kinematics puts them."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from hyperleg_design.report.pictures.picture import Solid
from hyperleg_design.report.viewer import scene
from hyperleg_design.robot.kinematics.posture import default_angles, link_poses, lowest_point
from hyperleg_design.robot.load import load_robot

pytest.importorskip("trimesh")
SIZES = {"box": (0.2, 0.4, 0.6), "cylinder": (0.1, 0.6), "capsule": (0.1, 0.6), "sphere": (0.1,)}
EXTENTS = {
    "box": (0.2, 0.4, 0.6),
    "cylinder": (0.2, 0.2, 0.6),
    "capsule": (0.2, 0.2, 0.8),
    "sphere": (0.2, 0.2, 0.2),
}


class FakeServer:
    """Keeps what is put into the scene."""

    def __init__(self):
        self.nodes, self.scene = {}, self

    def add(self, name, *arguments, **values):
        self.nodes[name] = SimpleNamespace(arguments=arguments, visible=True, **values)
        return self.nodes[name]

    add_frame = add_mesh_simple = add_arrows = add

    def remove_by_name(self, name):
        gone = [node for node in self.nodes if node.split("/")[0] == name]
        for node in gone:
            del self.nodes[node]

    def atomic(self):
        return self

    def __enter__(self):
        return self

    def __exit__(self, *error):
        return None


@given(st.lists(st.floats(-3, 3), min_size=3, max_size=3))
def test_quaternions_turn_as_their_rotation_does(vector):
    rotation = Rotation.from_rotvec(vector)
    w, x, y, z = scene.quaternion(rotation.as_matrix())
    again = Rotation.from_quat([x, y, z, w])
    assert (again.inv() * rotation).magnitude() == pytest.approx(0, abs=1e-7)


@pytest.mark.parametrize("kind", SIZES)
def test_solids_have_their_size_about_their_middle(kind):
    solid = Solid(kind, SIZES[kind], np.eye(3), np.array([1.0, 2.0, 3.0]), "#ff8001", 0.5)
    server = FakeServer()
    node = scene.put_solid(server, "a", solid)
    vertices, faces = node.arguments
    np.testing.assert_allclose(np.ptp(vertices, axis=0), EXTENTS[kind], rtol=0.02)
    np.testing.assert_allclose(vertices.max(0), -vertices.min(0), atol=0.005)
    assert faces.max() < len(vertices)
    assert (node.color, node.opacity) == ((255, 128, 1), 0.5)
    np.testing.assert_array_equal(node.position, [1.0, 2.0, 3.0])


@pytest.fixture
def shown():
    design, server = load_robot("mini_cheetah"), FakeServer()
    view = scene.RobotView(server, "robot", (0.0, 2.0, 0.0))
    view.show(design)
    return design, server, view


def test_a_robot_stands_at_its_place_with_the_lowest_pad_on_the_floor(shown):
    _, server, view = shown
    root = server.nodes["robot"]
    poses = link_poses(view.tree, default_angles(view.tree))
    np.testing.assert_allclose(root.position[:2], [0.0, 2.0])
    assert root.position[2] + lowest_point(view.tree, poses) == pytest.approx(0.0)


def test_links_are_where_kinematics_puts_them(shown):
    _, server, view = shown
    angles = {name: angle + 0.2 for name, angle in default_angles(view.tree).items()}
    view.pose(angles)
    for link, (rotation, place) in link_poses(view.tree, angles).items():
        node = server.nodes[f"robot/{link}"]
        np.testing.assert_allclose(node.position, place)
        w, x, y, z = node.wxyz
        np.testing.assert_allclose(
            Rotation.from_quat([x, y, z, w]).as_matrix(), rotation, atol=1e-9
        )


def test_forces_turn_with_the_base_only_at_their_points(shown):
    _, server, view = shown
    turn = Rotation.from_euler("z", 90, degrees=True).as_matrix()
    base, force = (turn, np.array([5.0, 5.0, 0.4])), np.array([0.0, 0.0, 0.3])
    view.pose(default_angles(view.tree), base, [(np.array([1.0, 0.0, 0.0]), force)])
    ((start, end),) = server.nodes["robot_forces"].arguments[0]
    np.testing.assert_allclose(start, [0.0, 3.0, 0.4], atol=1e-12)  # on the spot, not at x = 5
    np.testing.assert_allclose(end - start, force)
    view.pose(default_angles(view.tree))
    assert not server.nodes["robot_forces"].visible


def test_another_robot_replaces_the_first(shown):
    _, server, view = shown
    view.show(load_robot("teaching_leg"))
    assert {n.split("/")[1] for n in server.nodes if n.startswith("robot/")} == set(
        link_poses(view.tree, default_angles(view.tree))
    )
    assert server.nodes["robot"].position[2] == pytest.approx(view.tree.height)
