from __future__ import annotations

import numpy as np
import pinocchio
import pytest

from hyperleg_design.robot.described_file import read_robot
from hyperleg_design.robot.housing import housing

ROBOT = """<robot name="r"><link name="frame"/>
<link name="trunk"><inertial><mass value="{trunk}"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="leg"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="bolt" type="{bolt}"><parent link="{parent}"/><child link="{child}"/>
<origin xyz="0.3 -0.1 0.2" rpy="0.4 -0.5 0.6"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="hip" type="revolute"><parent link="frame"/><child link="leg"/>
<origin xyz="0.7 0.2 -0.1" rpy="0.1 0.2 0.3"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""


def robot(path, trunk=5.0, bolt="fixed", parent="frame", child="trunk"):
    path.write_text(ROBOT.format(trunk=trunk, bolt=bolt, parent=parent, child=child))
    return read_robot(path), pinocchio.buildModelFromUrdf(str(path))


@pytest.mark.parametrize("ends", [("frame", "trunk"), ("trunk", "frame")])
def test_a_motor_sits_at_its_joint_in_the_heaviest_link_fixed_to_the_parent(ends, tmp_path):
    read, model = robot(tmp_path / "r.urdf", parent=ends[0], child=ends[1])
    link, place = housing(read, "hip")
    assert link == "trunk"
    frame = model.frames[model.getFrameId("trunk")].placement
    assert np.allclose(frame.act(place), model.jointPlacements[1].translation, atol=1e-12)


def test_a_parent_with_mass_of_its_own_keeps_the_motor(tmp_path):
    read, _ = robot(tmp_path / "r.urdf", bolt="revolute")
    link, place = housing(read, "hip")
    assert link == "frame"
    assert np.allclose(place, [0.7, 0.2, -0.1])
    assert housing(read, "hip", locked=["bolt"])[0] == "trunk"
