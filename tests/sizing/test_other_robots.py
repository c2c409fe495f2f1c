import dataclasses
import importlib.metadata

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.description import urdf
from hyperleg_design.robot.design import load_design
from hyperleg_design.sizing import other_robots
from hyperleg_design.sizing.inertia import leg_inertia
from hyperleg_design.sizing.other_robots import (
    SOURCES,
    RobotSource,
    compare,
    find_source,
    measure,
    robots_folder,
)

URDF_SOURCES = [s for s in SOURCES if s.file.endswith(".urdf")]


@pytest.fixture(scope="module")
def robots():
    return {robot.source.name: robot for robot in compare()}


def test_every_robot_is_a_sensible_leg(robots):
    assert {"Cassie", "Talos", "Unitree G1", "Bolt", "iCub", "Romeo", "Human"} <= set(robots)
    for name, robot in robots.items():
        leg = robot.leg
        assert 0 < leg.distal_mass < leg.swing_mass <= leg.leg_mass, name
        assert 0.05 < leg.distal_share < 0.5, name
        assert 0.2 < leg.leg_length < 1.1, name
        # the centre of mass is within the leg, and inertia is at least that of the mass at its
        # centre
        assert leg.com_distance < leg.leg_length, name
        assert leg.swing_inertia > leg.swing_mass * leg.com_distance**2, name
        assert np.isnan(leg.total_mass) == (not robot.source.whole), name
        if robot.source.whole:
            assert robot.source.legs * leg.leg_mass < leg.total_mass, name


@pytest.mark.parametrize("source", URDF_SOURCES, ids=lambda s: s.name)
def test_swing_inertia_is_pinocchios_with_the_knee_straightened(source, robots):
    import pinocchio as pin

    robot = robots[source.name]
    model = pin.buildModelFromUrdf(str(robots_folder() / source.file), pin.JointModelFreeFlyer())
    data, q = model.createData(), pin.neutral(model)
    knee, hip = model.getJointId(source.knee), model.getJointId(source.hip_pitch)
    q[model.idx_qs[knee]] += robot.knee_turned
    matrix = pin.crba(model, data, q)
    place = model.idx_vs[hip]
    assert robot.leg.swing_inertia == pytest.approx(matrix[place, place], rel=1e-9)
    pin.centerOfMass(model, data, q)
    first = model.getJointId(source.first_hip)
    expected = [data.mass[j] for j in (first, hip, knee)]
    np.testing.assert_allclose(
        [robot.leg.leg_mass, robot.leg.swing_mass, robot.leg.distal_mass], expected, rtol=1e-9
    )
    # the foot is as far from the hip, across its axis, as this knee lets it
    pin.framesForwardKinematics(model, data, q)
    sole = (
        data.oMf[model.getFrameId(source.foot)].act(np.array(source.sole))
        - data.oMi[hip].translation
    )
    axis = pin.computeJointJacobian(model, data, q, hip)[3:, place]
    axis = data.oMi[hip].rotation @ axis
    across = np.linalg.norm(sole - (sole @ axis) * axis)
    assert robot.leg.leg_length == pytest.approx(across + source.foot_radius, rel=1e-9)


def test_own_description_measures_as_the_batched_analysis_does(tmp_path, monkeypatch):
    design = load_design("hyperleg")
    (tmp_path / "hyperleg.urdf").write_text(urdf(design))
    monkeypatch.setattr(other_robots, "robots_folder", lambda: tmp_path)
    source = RobotSource(
        name="HyperLeg",
        kind="biped",
        file="hyperleg.urdf",
        first_hip="left_hip_yaw",
        hip_pitch="left_hip_pitch",
        knee="left_knee",
        ankle="left_ankle_pitch",
        foot="left_foot",
        sole=(0.0, 0.0, -float(design.foot.ankle_height)),
    )
    found, expected = measure(source), leg_inertia(design)
    assert found.knee_turned == pytest.approx(0, abs=1e-12)
    for name, value in vars(expected).items():
        assert getattr(found.leg, name) == pytest.approx(value, rel=1e-9), name


def test_posed_sdf_reads_like_the_urdf_of_the_same_leg(tmp_path, monkeypatch):
    # a thigh and a shank, both rods along x of their links, which hang down; a loop-closing joint
    # comes last
    link = """<link name="{0}"><pose>{1}</pose><inertial><mass>{2}</mass><pose>{3} 0 0 0 0 0</pose>
        <inertia><ixx>0.01</ixx><iyy>0.02</iyy><izz>0.03</izz></inertia></inertial></link>"""
    joint = (
        '<joint name="{0}" type="revolute"><parent>{1}</parent><child>{2}</child><axis><xyz>0 '
        "1 0</xyz></axis></joint>"
    )
    text = "".join(
        [
            link.format("body", "0 0 1 0 0 0", 5, 0),
            link.format("thigh", "0 0 1 0 1.5707963267948966 0", 2, 0.1),
            link.format("shank", "0 0 0.6 0 1.5707963267948966 0", 1, 0.2),
            joint.format("hip", "body", "thigh"),
            joint.format("knee", "thigh", "shank"),
            joint.format("rod", "body", "shank"),
        ]
    )
    (tmp_path / "leg.sdf").write_text(f'<sdf version="1.6"><model name="m">{text}</model></sdf>')
    monkeypatch.setattr(other_robots, "robots_folder", lambda: tmp_path)
    source = RobotSource(
        "Rods", "biped", "leg.sdf", "hip", "hip", "knee", "", "shank", (0.4, 0.0, 0.0), 0.05
    )
    leg = measure(source).leg
    assert leg.total_mass == pytest.approx(8)
    assert leg.leg_mass == leg.swing_mass == pytest.approx(3)
    assert leg.distal_mass == pytest.approx(1)
    assert leg.leg_length == pytest.approx(0.85)
    assert leg.swing_inertia == pytest.approx(0.02 + 0.02 + 2 * 0.1**2 + 1 * 0.6**2)
    assert leg.com_distance == pytest.approx((2 * 0.1 + 0.6) / 3)


def test_cassie_weighs_what_its_links_do(robots):
    # links of one leg as the SDF lists them
    below = 0.7578 + 0.577 + 0.782 + 0.126 + 0.1261 + 0.1186 + 0.1498 + 0.1567
    leg = robots["Cassie"].leg
    assert leg.distal_mass == pytest.approx(below)
    assert leg.leg_mass == pytest.approx(below + 1.82 + 1.171 + 5.52)
    assert leg.total_mass == pytest.approx(10.33 + 2 * leg.leg_mass)
    assert np.isnan(robots["Cassie"].knee_turned)


def test_hyperleg_has_the_lightest_lower_leg_of_the_humanoids(robots):
    own = leg_inertia(load_design("hyperleg"))
    for name in ("Talos", "iCub", "Romeo", "Unitree G1", "Alexander", "Human"):
        assert own.distal_share < robots[name].leg.distal_share


def test_robots_are_found_by_name():
    assert find_source("cassie").name == "Cassie"
    assert [r.source.name for r in compare(["talos", "Bolt"])] == ["Talos", "Bolt"]
    with pytest.raises(InputError, match="expects one of"):
        find_source("asimo")


def test_missing_package_and_missing_names_are_one_clear_error(monkeypatch, tmp_path):
    talos = find_source("Talos")
    for field in ("first_hip", "hip_pitch", "knee", "ankle", "foot"):
        with pytest.raises(InputError, match=f"Talos.{field}"):
            measure(dataclasses.replace(talos, **{field: "nowhere"}))
    with pytest.raises(InputError, match="no such file"):
        measure(dataclasses.replace(talos, file="talos_data/robots/none.urdf"))

    def absent(name):
        raise importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(importlib.metadata, "files", absent)
    monkeypatch.setattr(other_robots.sys, "prefix", str(tmp_path))
    with pytest.raises(InputError, match="pip install example-robot-data"):
        robots_folder()
    (tmp_path / "share" / "example-robot-data" / "robots").mkdir(parents=True)
    assert robots_folder() == (tmp_path / "share" / "example-robot-data" / "robots").resolve()
