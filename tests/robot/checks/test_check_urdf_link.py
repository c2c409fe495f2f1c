"""Links of a URDF: masses, and points without one."""

from __future__ import annotations

from hyperleg_design.robot.checks.check_urdf import check_urdf
from tests.robot.checks.urdfs import GOOD


def test_a_point_fixed_to_a_link_is_only_a_doubt():
    point = '<inertial><mass value="0.1"/><inertia ixx="0" iyy="0" izz="0"/></inertial>'
    (finding,) = check_urdf(GOOD.replace('<link name="tip"/>', f'<link name="tip">{point}</link>'))
    assert finding.severity == "warning"
    assert "mass of 0.1 kg but no inertia" in finding.message


def test_weight_on_a_fixed_link_counts_for_the_moving_one():
    text = GOOD.replace('<child link="lower"/>', '<child link="tip"/>').replace(
        '<parent link="lower"/><child link="tip"/>', '<parent link="tip"/><child link="lower"/>'
    )
    assert check_urdf(text) == []
