"""Robots that write their tree out, compared in Pinocchio, MuJoCo and by hand."""

from __future__ import annotations

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from hyperleg_design.robot.build import build
from hyperleg_design.robot.checks.check_mjcf import check_mjcf
from hyperleg_design.robot.checks.check_urdf import check_urdf
from hyperleg_design.robot.description import urdf
from hyperleg_design.robot.kinematics.dimensions import total_mass
from hyperleg_design.robot.kinematics.posture import link_poses
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.mjcf import mjcf, mujoco_model
from hyperleg_design.robot.models import quaternion_matrix, rigid_body_model
from tests.robot.tree_files import SHIPPED, leg


@pytest.fixture(scope="module", params=SHIPPED)
def design(request):
    return load_robot(request.param)


def test_mass_matrix_with_rotors_is_the_same_in_pinocchio_and_mujoco(design):
    rigid, model = rigid_body_model(design), mujoco_model(design)
    data, rng = mujoco.MjData(model), np.random.default_rng(1)
    for _ in range(3):
        q = pin.integrate(rigid.model, rigid.neutral(), 0.3 * rng.normal(size=rigid.model.nv))
        data.qpos[:] = rigid.to_mujoco(q)[0]
        mujoco.mj_forward(model, data)
        full = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, full)
        turn = np.eye(model.nv)
        if rigid.floating:
            turn[:3, :3] = quaternion_matrix(q[3:7])
        assert np.allclose(turn.T @ full @ turn, rigid.mass_matrix(q), atol=1e-12)


def test_masses_inertias_and_places_are_the_same_in_the_urdf_read_by_pinocchio(design):
    tree, rigid = build_tree(design), rigid_body_model(design)
    read = pin.buildModelFromXML(urdf(design), *([pin.JointModelFreeFlyer()] * tree.floating))
    data, rng = read.createData(), np.random.default_rng(2)
    angles = {joint.name: float(rng.uniform(-0.3, 0.3)) for joint in tree.moving}
    q, own = pin.neutral(read), rigid.neutral()
    if tree.floating:
        q[2] = own[2]
    for name, angle in angles.items():
        q[read.joints[read.getJointId(name)].idx_q] = angle
        own[rigid.model.joints[rigid.model.getJointId(name)].idx_q] = angle
    com = pin.centerOfMass(read, data, q) + np.array([0, 0, 0 if tree.floating else tree.height])
    assert np.allclose(com, rigid.center_of_mass(own), atol=1e-12)
    total = sum(inertia.mass for inertia in read.inertias)
    assert total == pytest.approx(float(total_mass(design)), rel=1e-12)
    height = tree.height if rigid.model.njoints == len(tree.moving) + 1 else own[2]
    for link, (_, place) in link_poses(tree, angles).items():
        assert np.allclose(
            rigid.frame_position(own, link), place + np.array([0, 0, height]), atol=1e-12
        )
    pin.ccrba(read, data, q, np.zeros(read.nv))
    theirs = np.array(data.Ig.inertia)
    pin.ccrba(rigid.model, rigid.data, own, np.zeros(rigid.model.nv))
    assert np.allclose(theirs, np.array(rigid.data.Ig.inertia), atol=1e-12)


def test_equal_angles_are_mirrored_postures():
    for name in ("mini_cheetah", "parallel_ankle"):
        tree = build_tree(load_robot(name))
        rng = np.random.default_rng(4)
        limb = {
            j.name.split("left_")[1]: rng.uniform(-0.5, 0.5)
            for j in tree.moving
            if "left_" in j.name
        }
        angles = {}
        for joint in tree.moving:
            own = joint.name.split("left_")[-1].split("right_")[-1]
            angles[joint.name] = limb[own]
        poses = link_poses(tree, angles)
        for link, (rotation, place) in poses.items():
            if "left_" in link:
                other, there = poses[link.replace("left_", "right_")]
                mirror = np.diag([1.0, -1.0, 1.0])
                assert np.allclose(there, mirror @ place)
                assert np.allclose(other, mirror @ rotation @ mirror)


def test_files_have_no_faults_and_read_back(design, tmp_path):
    assert check_urdf(urdf(design)) == []
    assert [f for f in check_mjcf(mjcf(design)) if f.severity == "error"] == []
    folder = build(design, tmp_path / "out")
    again = load_robot(folder / "design.yaml")
    assert urdf(again) == urdf(design)
    assert mjcf(again) == mjcf(design)
    assert (
        build(again, tmp_path / "again").joinpath("design.yaml").read_bytes()
        == (folder / "design.yaml").read_bytes()
    )


def test_every_value_is_labelled_and_has_a_source(design):
    for path, origin in design.origins.items():
        assert origin.label in ("paper", "vendor", "derived", "assumed"), path
        assert origin.source, path


@pytest.mark.parametrize("motion", ["fixed", "floating"])
def test_a_root_named_world_is_a_body_of_its_own_in_mujoco(motion):
    links = {n: {"mass": 1.0, "gyration": [0.1] * 3} for n in ("world", "thigh", "shank")}
    joints = {
        "hip": {"parent": "world", "child": "thigh"},
        "knee": {"parent": "thigh", "child": "shank", "position": [0, 0, -0.2]},
    }
    motors = {n: {"motor": "RI70", "gear": 7, "housed_in": "world"} for n in joints}
    trunk = {"link": "world", "motion": motion, "height": 0.5}
    design = leg(trunk=trunk, links=links, joints=joints, actuators=motors)
    model = mujoco_model(design)
    assert model.nv == 2 + 6 * (motion == "floating")
    assert model.body("world_body").mass == pytest.approx(1.0)
    assert rigid_body_model(design).model.existBodyName("world_body")
