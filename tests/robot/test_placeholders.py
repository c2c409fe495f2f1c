"""Links that stand for no body are imported, with a warning where they have an inertia of none."""

from __future__ import annotations

import numpy as np

from hyperleg_design.robot.described_file import FileLink
from hyperleg_design.robot.description import urdf
from hyperleg_design.robot.importing import import_robot
from hyperleg_design.robot.placeholders import real_inertia
from tests.robot.test_importing import actuation
from tests.robot.tree_files import leg


def test_the_inertia_of_a_body_stays_and_rounding_goes():
    for inertia, real in (
        (np.diag([2.0, 3.0, 4.0]), np.diag([2.0, 3.0, 4.0])),
        (np.diag([-1.0, 3.0, 4.0]), np.diag([-1.0, 3.0, 4.0])),
        (np.diag([-1e-8, 3e-8, 4e-8]), 4e-8 * np.eye(3)),
        (np.diag([-1e-20, 0.0, 1e-20]), np.zeros((3, 3))),
    ):
        assert np.array_equal(real_inertia(FileLink(1.0, np.zeros(3), inertia)), real)


def test_an_inertia_of_no_body_on_a_mere_frame_is_a_warning(tmp_path):
    wrong = """<link name="antenna"><inertial><mass value="1e-6"/><inertia ixx="2.4e-8"
    iyy="2.8e-8" izz="3.8e-8" ixy="6.1e-8" ixz="0" iyz="0"/></inertial></link>
    <link name="point"><inertial><mass value="0.2"/><inertia ixx="-5e-20" iyy="0" izz="0"/>
    </inertial></link>
    <joint name="mast" type="fixed"><parent link="base"/><child link="antenna"/></joint>
    <joint name="end" type="fixed"><parent link="shank"/><child link="point"/></joint></robot>"""
    path = tmp_path / "leg.urdf"
    path.write_text(urdf(leg()).replace("</robot>", wrong))
    design, (finding,) = import_robot(path, actuation(tmp_path / "motors.yaml"))
    assert (finding.severity, finding.place) == ("warning", "link antenna")
    assert "no body has this inertia" in finding.message
    assert np.allclose(design["links.antenna.inertia"][:3], 9.09e-8, rtol=1e-2)
    assert not np.any(design["links.point.inertia"])
