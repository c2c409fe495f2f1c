"""Other people's robots become designs, and their limits are compared with the motors named."""

from __future__ import annotations

import mujoco
import numpy as np
import pinocchio as pin
import pytest
import yaml

from hyperleg_design.cli import main
from hyperleg_design.errors import InputError
from hyperleg_design.robot.description import urdf
from hyperleg_design.robot.importing import import_robot
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.mjcf import mjcf
from hyperleg_design.robot.models import rigid_body_model
from hyperleg_design.sizing.other_robots import robots_folder
from tests.robot.tree_files import leg

ROBOTS = {
    "solo_description/robots/solo12.urdf": {"actuators": {"*": {"motor": "mj5208", "gear": 9}}},
    "ur_description/urdf/ur5_robot.urdf": {
        "actuators": {"*": {"motor": "U10", "gear": 100}},
        "trunk": {"motion": "fixed"},
    },
    "talos_data/robots/talos_full_v2.urdf": {
        "lock": ["gripper_*"],
        "actuators": {"*": {"motor": "U10", "gear": 60}},
    },
}
LEG = {"hip": {"motor": "RI70", "gear": 7}, "knee": {"motor": "RI60", "gear": 9}}


def actuation(path, **data):
    path.write_text(yaml.safe_dump(data or {"actuators": LEG}))
    return path


@pytest.mark.parametrize("file", ROBOTS)
def test_masses_and_dynamics_are_those_that_pinocchio_reads(file, tmp_path):
    design, _ = import_robot(
        robots_folder() / file, actuation(tmp_path / "motors.yaml", **ROBOTS[file])
    )
    rigid = rigid_body_model(design)
    root = [pin.JointModelFreeFlyer()] if rigid.floating else []
    theirs = pin.buildModelFromUrdf(str(robots_folder() / file), *root)
    data, rng = theirs.createData(), np.random.default_rng(0)
    q, own = pin.neutral(theirs), pin.neutral(rigid.model)
    places = {}
    for name in design.joint_sections:
        angle = rng.uniform(-0.5, 0.5)
        joint = theirs.joints[theirs.getJointId(name)]
        mine = rigid.model.joints[rigid.model.getJointId(name)]
        q[joint.idx_q], own[mine.idx_q] = angle, angle
        places[mine.idx_v] = joint.idx_v
    assert np.allclose(pin.centerOfMass(theirs, data, q), rigid.center_of_mass(own), atol=1e-9)
    full = np.array(pin.crba(theirs, data, q))
    full = np.triu(full) + np.triu(full, 1).T
    mine, other = list(places), list(places.values())
    matrix = rigid.mass_matrix(own) - rigid.reflected
    assert np.allclose(matrix[np.ix_(mine, mine)], full[np.ix_(other, other)], atol=1e-9)


def test_our_own_files_come_back_as_the_same_robot(tmp_path):
    design = leg()
    motors = actuation(tmp_path / "motors.yaml", actuators=LEG, trunk={"height": 0.5})
    q = np.array([0.3, -0.7])
    for name, text in (("leg.urdf", urdf(design)), ("leg.xml", mjcf(design))):
        (tmp_path / name).write_text(text)
        again, findings = import_robot(tmp_path / name, motors)
        if name == "leg.xml":
            assert again.trunk.motion == "fixed"
        else:
            assert again.trunk.motion == "floating"
            again = again.with_values({"trunk.motion": "fixed"})
        assert findings == []
        assert np.allclose(
            rigid_body_model(again).mass_matrix(q), rigid_body_model(design).mass_matrix(q)
        )


def test_limits_that_contradict_the_motors_are_named(tmp_path):
    text = urdf(leg())
    peak = 7 * 2.68
    assert f'effort="{peak}' in text.replace("18.760000000000002", "18.76")
    text = text.replace('effort="18.76', 'effort="40.0" was="18.76')
    path = tmp_path / "leg.urdf"
    path.write_text(text)
    _, findings = import_robot(path, actuation(tmp_path / "motors.yaml"))
    (finding,) = findings
    assert (finding.severity, finding.place) == ("warning", "joint hip")
    for word in ("effort is 40 Nm", "2.13 times", "18.76", "RI70 at 7:1"):
        assert word in str(finding)
    weaker = {"actuators": LEG | {"knee": {"motor": "RI60", "gear": 18}}}
    _, findings = import_robot(path, actuation(tmp_path / "motors.yaml", **weaker))
    assert [f.place for f in findings] == ["joint hip", "joint knee", "joint knee"]
    velocity, effort = findings[1:]
    assert "velocity" in str(velocity)
    assert "2 times" in str(velocity)
    assert "effort" in str(effort)
    assert "0.5 times" in str(effort)


def test_rotor_inertia_of_an_mjcf_is_compared(tmp_path):
    path = tmp_path / "leg.xml"
    path.write_text(
        """<mujoco><worldbody><body name="base"><freejoint/><geom size="0.1" mass="1"/>
        <body name="thigh" pos="0 0 -0.1"><joint name="hip" axis="0 1 0" range="-90 90"
        armature="0.02" pos="0 0 0.05"/><geom size="0.05" mass="1" pos="0 0 -0.1"/></body>
        </body></worldbody></mujoco>"""
    )
    motors = actuation(tmp_path / "m.yaml", actuators={"hip": LEG["hip"]})
    design, (finding,) = import_robot(path, motors)
    assert "armature is 0.02" in str(finding)
    assert np.allclose(design["joints.hip.position"], [0, 0, -0.05])
    assert np.allclose(design["links.thigh.com"], [0, 0, -0.15])
    assert design["joints.hip.lower_deg"] == pytest.approx(-90)


BROKEN = {
    "two roots": ("</robot>", '<link name="spare"/></robot>', ["spare"]),
    "repeated": ('<link name="thigh">', '<link name="shank">', ["shank"]),
    "loop": ('<parent link="base"/>', '<parent link="shank"/>', ["thigh, shank", "loop"]),
    "millimetres": (
        'xyz="0.0 0.0 -0.2"/>\n    <parent',
        'xyz="0.0 0.0 -200.0"/>\n    <parent',
        ["knee", "200", "millimetres"],
    ),
    "degrees": ('upper="3.14', 'upper="180.0" was="3.14', ["180", "degrees"]),
    "mesh": (
        "</link>",
        '<visual><geometry><mesh filename="package://no/such.stl"/></geometry></visual></link>',
        ["package://no/such.stl", "missing", "--no-meshes"],
    ),
    "mesh beside it": (
        "</link>",
        '<visual><geometry><mesh filename="thigh.stl"/></geometry></visual></link>',
        ["thigh.stl", "missing", "--no-meshes"],
    ),
    "no XML": ("</robot>", "", ["line"]),
}


@pytest.mark.parametrize("case", BROKEN)
def test_broken_files_are_one_clear_error_and_nothing_is_written(case, tmp_path, capsys):
    old, new, words = BROKEN[case]
    text = urdf(leg())
    assert old in text
    path, out = tmp_path / "leg.urdf", tmp_path / "design.yaml"
    path.write_text(text.replace(old, new, 1))
    motors = actuation(tmp_path / "motors.yaml")
    code = main(["import", str(path), "--actuation", str(motors), "--out", str(out)])
    shown = capsys.readouterr()
    assert code == 2
    assert shown.err.count("\n") == 1
    for word in ["leg.urdf", *words]:
        assert word in shown.err
    assert not out.exists()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["leg.urdf", "motors.yaml"]


@pytest.mark.parametrize(
    "name", ["thigh.stl", "meshes/thigh.stl", "file:///gone/thigh.stl", "package://gone/thigh.stl"]
)
def test_meshes_may_be_missing_wherever_they_should_be(name, tmp_path, capsys):
    path = tmp_path / "leg.urdf"
    drawn = f'<visual><geometry><mesh filename="{name}"/></geometry></visual></link>'
    path.write_text(urdf(leg()).replace("</link>", drawn, 1))
    command = ["import", str(path), "--actuation", str(actuation(tmp_path / "motors.yaml"))]
    assert main([*command, "--no-meshes"]) == 0
    assert "leg: 2 joints" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (
            {"actuators": {"hip": LEG["hip"]}},
            ["joints.knee", "no motor; name one under actuators", "lock"],
        ),
        ({"actuators": LEG, "lock": ["elbow"]}, ["lock.elbow", "no such moving joint"]),
        (
            {"actuators": LEG, "lock": ["hip"]},
            ["actuators.hip: is under lock, so no motor drives it"],
        ),
        (
            {"actuators": {"h*": LEG["hip"], "knee": LEG["knee"]}, "lock": ["hip"]},
            ["actuators.h*: hip is under lock"],
        ),
        ({"actuators": LEG, "joints": {"elbow": {}}}, ["joints.elbow", "no such joint"]),
        ({"actuators": LEG, "lock": "hip"}, ["lock = 'hip'", "expects a list"]),
        ({"actuators": {"*": "RI70"}}, ["actuators.* = 'RI70'", "{motor: RI70, gear: 9}"]),
        ({"actuators": LEG, "joints": {"hip": 50}}, ["joints.hip = 50", "{stiffness: 50}"]),
        ({"actuators": LEG, "pads": {"shank": 0.01}}, ["pads.shank = 0.01", "{radius: 0.01}"]),
        (
            {"actuators": LEG, "transmission": {"joint_from_motor": [["x", 0], [0, 9]]}},
            ["joint_from_motor = [['x', 0], [0, 9]]", "2 rows of 2"],
        ),
        ({"actuators": LEG, "motors": {}}, ["motors", "no such field"]),
        (
            {"actuators": LEG, "transmission": {"joint_from_motor": [[7.0]]}},
            ["joint_from_motor", "2 rows of 2"],
        ),
        (
            {"actuators": LEG, "transmission": {"joint_from_motor": [[7.0, 7.0], [7.0, 7.0]]}},
            ["transmission", "singular"],
        ),
    ],
)
def test_actuation_that_does_not_fit_is_named(data, words, tmp_path):
    path = tmp_path / "leg.urdf"
    path.write_text(urdf(leg()))
    with pytest.raises(InputError) as caught:
        import_robot(path, actuation(tmp_path / "motors.yaml", **data))
    for word in ["motors.yaml", *words]:
        assert word in str(caught.value)


def test_errors_name_the_file_that_is_wrong(tmp_path):
    path = tmp_path / "leg.urdf"
    path.write_text(urdf(leg()).replace('mass value="1.0"', 'mass value="1000.0"', 1))
    with pytest.raises(InputError, match=r"leg\.urdf: links\.base\.mass = 1000"):
        import_robot(path, actuation(tmp_path / "motors.yaml"))
    with pytest.raises(InputError, match=r"gone\.yaml: cannot be read"):
        import_robot(tmp_path / "gone.urdf", tmp_path / "gone.yaml")


def test_a_sliding_joint_is_refused_until_it_is_locked(tmp_path):
    path = tmp_path / "leg.urdf"
    path.write_text(urdf(leg()).replace('type="revolute"', 'type="prismatic"', 1))
    with pytest.raises(InputError, match=r"joint hip.*prismatic.*lock"):
        import_robot(path, actuation(tmp_path / "motors.yaml"))
    path.write_text(path.read_text().replace('type="revolute"', 'type="prismatic"'))
    with pytest.raises(
        InputError, match=r"joint hip.*so are knee; list them or patterns under lock"
    ):
        import_robot(path, actuation(tmp_path / "motors.yaml"))
    path.write_text(urdf(leg()).replace('type="revolute"', 'type="prismatic"', 1))
    motors = actuation(tmp_path / "m.yaml", lock=["hip"], actuators={"knee": LEG["knee"]})
    design, _ = import_robot(path, motors)
    assert list(design.joint_sections) == ["knee"]
    motors = actuation(tmp_path / "m.yaml", lock=["h*"], actuators={"*": LEG["knee"]})
    assert list(import_robot(path, motors)[0].joint_sections) == ["knee"]


def test_the_command_writes_a_design_that_loads(tmp_path, capsys):
    path, out = tmp_path / "leg.urdf", tmp_path / "mine.yaml"
    path.write_text(urdf(leg()))
    motors = actuation(tmp_path / "motors.yaml")
    assert main(["import", str(path), "--actuation", str(motors), "--out", str(out)]) == 0
    assert "limits agree with the motors" in capsys.readouterr().out
    assert list(load_robot(out).joint_sections) == ["hip", "knee"]


def test_only_a_file_that_import_wrote_is_replaced(tmp_path, capsys):
    path, out = tmp_path / "leg.urdf", tmp_path / "mine.yaml"
    path.write_text(urdf(leg()))
    motors = actuation(tmp_path / "motors.yaml")
    command = ["import", str(path), "--actuation", str(motors), "--out"]
    thesis = tmp_path / "thesis.yaml"
    thesis.write_text("years: 5\n")
    for other in (path, motors, thesis):
        before = other.read_bytes()
        assert main([*command, str(other)]) == 2
        assert f"{other}: is a file that hyperleg import did not write" in capsys.readouterr().err
        assert other.read_bytes() == before
    assert main([*command, str(out)]) == 0
    assert main([*command, str(out)]) == 0
    out.write_text(out.read_text() + "# mine\n")
    assert main([*command, str(out)]) == 2
    assert "edited since" in capsys.readouterr().err


def two_feet(sphere='<sphere radius="0.02"/>'):
    """A body with a leg that ends in a foot, hanging freely in the world."""
    inertial = (
        '<inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" '
        'iyz="0"/></inertial>'
    )
    return f"""<robot name="hopper"><link name="world"/><link name="body">{inertial}</link>
    <link name="shank">{inertial}</link>
    <link name="tip">{inertial}<collision><origin xyz="0 0 -0.1"/><geometry>{sphere}</geometry>
    </collision></link>
    <joint name="free" type="floating"><parent link="world"/><child link="body"/></joint>
    <joint name="knee" type="revolute"><parent link="body"/><child link="shank"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="10" velocity="10"/></joint>
    <joint name="end" type="fixed"><parent link="shank"/><child link="tip"/></joint></robot>"""


def test_a_floating_joint_from_the_world_is_a_free_base(tmp_path):
    (tmp_path / "hopper.urdf").write_text(two_feet())
    motors = {"actuators": {"knee": {"motor": "RI60", "gear": 9}}, "pads": {"tip": {}}}
    design, _ = import_robot(tmp_path / "hopper.urdf", actuation(tmp_path / "m.yaml", **motors))
    assert (design.trunk.link, design.trunk.motion) == ("body", "floating")
    assert list(design.link_sections) == ["body", "shank", "tip"]
    (pad,) = design.pad_sections.values()
    assert (pad.link, list(pad.position), pad.radius) == ("tip", [0.0, 0.0, -0.1], 0.02)


def test_a_root_named_world_is_a_fixed_base(tmp_path, capsys):
    path, out = tmp_path / "arm.urdf", tmp_path / "arm.yaml"
    path.write_text(two_feet().replace('type="floating"', 'type="fixed"'))
    motors = actuation(tmp_path / "m.yaml", actuators={"knee": {"motor": "RI60", "gear": 9}})
    assert main(["import", str(path), "--actuation", str(motors), "--out", str(out)]) == 0
    assert "root link world is fixed; trunk: {motion: floating}" in capsys.readouterr().out
    model = mujoco.MjModel.from_xml_string(mjcf(load_robot(out)))
    assert model.nq == 1
    path.write_text(path.read_text().replace('"world"', '"ground"'))
    assert import_robot(path, motors)[0].trunk.motion == "floating"


def test_pads_of_links_without_spheres(tmp_path):
    (tmp_path / "hopper.urdf").write_text(two_feet('<box size="0.1 0.1 0.1"/>'))
    motors = {"actuators": {"knee": {"motor": "RI60", "gear": 9}}, "pads": {"tip": {}}}
    toe = actuation(tmp_path / "toe.yaml", **motors | {"pads": {"toe*": {"radius": 0.01}}})
    with pytest.raises(InputError, match=r"pads\.toe\*: no such link; there are body, shank, tip"):
        import_robot(tmp_path / "hopper.urdf", toe)
    with pytest.raises(InputError, match=r"pads\.tip.*no link of this name has a colliding sphere"):
        import_robot(tmp_path / "hopper.urdf", actuation(tmp_path / "m.yaml", **motors))
    motors["pads"] = {"tip": {"radius": 0.03}}
    design, _ = import_robot(tmp_path / "hopper.urdf", actuation(tmp_path / "m.yaml", **motors))
    (pad,) = design.pad_sections.values()
    assert (list(pad.position), pad.radius) == ([0.0, 0.0, 0.0], 0.03)


def test_the_first_error_says_where_the_others_are(tmp_path):
    path = tmp_path / "leg.urdf"
    path.write_text(urdf(leg()).replace('mass value="1.0"', 'mass value="-1.0"'))
    with pytest.raises(InputError, match=rf"hyperleg check {path} lists all 3 errors"):
        import_robot(path, actuation(tmp_path / "motors.yaml"))
    path.write_text(urdf(leg()).replace('mass value="1.0"', 'mass value="-1.0"', 1))
    with pytest.raises(InputError) as caught:
        import_robot(path, actuation(tmp_path / "motors.yaml"))
    assert "hyperleg check" not in str(caught.value)


def test_a_joint_that_the_file_fixes_has_no_motor(tmp_path):
    path = tmp_path / "leg.urdf"
    path.write_text(urdf(leg()).replace('type="revolute"', 'type="fixed"', 1))
    motors = actuation(tmp_path / "motors.yaml")
    with pytest.raises(InputError, match=r"motors\.yaml: actuators\.hip: is fixed in .*leg\.urdf"):
        import_robot(path, motors)
    path.write_text(path.read_text().replace('type="revolute"', 'type="fixed"'))
    with pytest.raises(InputError, match=r"leg\.urdf: joints: has no joint that moves"):
        import_robot(path, motors)
