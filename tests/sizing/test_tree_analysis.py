"""Analyses of robots that write their tree out."""

from __future__ import annotations

import json
from xml.etree import ElementTree

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.report.sizing.comparison import compare, compare_text
from hyperleg_design.report.tree_text import tree_analysis_text
from hyperleg_design.robot.description import urdf
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.mjcf import mujoco_model
from hyperleg_design.robot.models import rigid_body_model
from hyperleg_design.robot.transmission import max_joint_torque
from hyperleg_design.robot.trees.tree_load import tree_design_from_mapping
from hyperleg_design.simulation.isaac import isaac_actuators
from hyperleg_design.sizing.analysis import analyze
from hyperleg_design.sizing.capability import largest_force
from hyperleg_design.sizing.postures import posture
from tests.robot.tree_files import SHIPPED, leg, leg_file


@pytest.fixture(scope="module", params=SHIPPED)
def design(request):
    return load_robot(request.param)


def test_analysis_is_plain_and_agrees_with_the_rigid_body_model(design):
    found = json.loads(json.dumps(analyze(design)))
    model = rigid_body_model(design)
    matrix = model.mass_matrix(posture(design, "default", model)) - model.reflected
    start = model.base_dof
    for row, name in enumerate(found["joints"]):
        assert found["link_inertia"][name] == pytest.approx(matrix[start + row, start + row])
    text = tree_analysis_text(found)
    assert all(name in text for name in (*found["joints"], *found["motors"]))


def test_a_shared_ankle_gives_each_joint_alone_what_both_motors_give():
    found = analyze(load_robot("parallel_ankle"))
    assert found["zonotope_to_box_volume"] == pytest.approx(0.5)
    ratio = found["reduction"][4][4]
    assert found["torque_alone"]["ankle_pitch"] == pytest.approx(2 * 4.1 * ratio)


def test_the_force_of_a_limb_is_what_its_motors_hold(design):
    force = largest_force(design, "default", side=design.copies[0])
    assert force.binding
    matrix = np.array(analyze(design)["reduction"])
    assert np.allclose(matrix @ force.motor_torque, force.joint_torque)
    assert np.all(force.pad_force[:, 2] >= -1e-6)


def test_a_robot_without_pads_says_so():
    design = tree_design_from_mapping(leg_file(pads={}), "leg", "leg.yaml")
    found = analyze(design)
    assert found["contact_force"]["vertical"]["force"] is None
    assert "no pads" in found["contact_force"]["vertical"]["reason"]
    assert "no pads" in tree_analysis_text(found)


def test_robots_of_both_families_stand_beside_each_other():
    designs = [load_robot("mini_cheetah"), load_robot("mini_cheetah"), load_robot("hyperleg")]
    found = compare(designs)
    assert list(found) == ["mini_cheetah", "mini_cheetah (2)", "hyperleg"]
    assert "total_mass" in compare_text(found)
    with pytest.raises(InputError, match="no planned walk"):
        compare(designs[:1], demand=True)


def test_at_half_the_voltage_all_limits_at_standstill_are_those_of_the_stall_torque():
    motors = {"actuators.hip.motor": "MF0076008", "actuators.hip.gear": 20}
    design = leg().with_values({**motors, "electrical.voltage_ratio": 0.5})
    hip = 20 * 2.418
    found = analyze(design)
    assert found["max_joint_torque"]["hip"] == pytest.approx(hip, rel=1e-3)
    assert found["torque_alone"]["hip"] == pytest.approx(hip, rel=1e-3)
    model = mujoco_model(design)
    assert model.actuator("hip").ctrlrange == pytest.approx([-hip / 20, hip / 20], rel=1e-3)
    (limit,) = ElementTree.fromstring(urdf(design)).findall("joint[@name='hip']/limit")
    assert float(limit.get("effort")) == pytest.approx(hip, rel=1e-3)
    assert isaac_actuators(design)["actuators"]["hip"]["effort_limit"] == pytest.approx(
        hip, rel=1e-3
    )


def test_the_force_of_derated_joints_is_that_of_weaker_motors():
    design = load_robot("teaching_leg")
    half = analyze(design.with_values({f"joints.{j}.derate": 0.5 for j in ("hip", "knee")}))
    full = analyze(design)
    for direction, force in half["contact_force"].items():
        assert force["force"] < 0.6 * full["contact_force"][direction]["force"]
        assert force["derated"]
    assert full["contact_force"]["vertical"]["derated"] == []
    # a planar leg on a point foot: J^T f = g - tau, with tau within the derated torques
    weak = design.with_values({"joints.hip.derate": 0.5})
    push = largest_force(weak, "default", side=weak.copies[0], derated=True)
    limit = max_joint_torque(weak)
    assert np.all(np.abs(push.joint_torque) <= limit * (1 + 1e-4))
    assert np.abs(push.joint_torque[0]) == pytest.approx(limit[0], rel=1e-4)
    free = largest_force(weak, "default", side=weak.copies[0])
    assert free.force[2] == pytest.approx(full["contact_force"]["vertical"]["force"])
    text = tree_analysis_text(analyze(weak))
    assert "joint hip (derated)" in text
