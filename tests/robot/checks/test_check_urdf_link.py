"""Links of a URDF: masses, and points without one."""

from __future__ import annotations

import pytest

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


def tip(mass, **moments):
    """The file with a tip that is fixed to the arm."""
    six = " ".join(
        f'{key}="{moments.get(key, 0.0)!r}"' for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    )
    inertial = f'<inertial><mass value="{mass}"/><inertia {six}/></inertial>'
    return GOOD.replace('<link name="tip"/>', f'<link name="tip">{inertial}</link>')


@pytest.mark.parametrize(
    "moments",
    [
        {},
        {"ixy": 1.4e-20},
        {"ixx": -2.4e-35, "izz": 2.4e-35},
        {"ixx": 4.9e-21, "iyy": 3.5e-20, "izz": 5.5e-20},
        {"ixx": 4.1e-18},
    ],
)
def test_what_rounding_left_of_zero_is_zero(moments):
    (finding,) = check_urdf(tip(4.72, **moments))
    assert finding.severity == "warning"
    assert "mass of 4.72 kg but no inertia" in finding.message
    assert "give it that of its body" in finding.remedy
    text = GOOD.replace('<inertia ixx="0.01" iyy="0.01" izz="0.002"', '<inertia ixx="1e-18"', 1)
    text = text.replace('ixx="1e-18"', 'ixx="1e-18" iyy="0" izz="0"')
    errors = [f for f in check_urdf(text) if f.severity == "error"]
    assert all("but no inertia" in f.message for f in errors)
    assert errors


def test_only_the_inertial_of_a_light_link_may_go():
    (finding,) = check_urdf(tip(1e-6))
    assert (finding.severity, finding.remedy) == (
        "warning",
        "leave out the inertial of a mere frame",
    )


def test_a_frame_of_a_milligram_may_have_an_inertia_of_no_body():
    """Tiago's antennas: products in the places of moments."""
    wrong = {"ixx": 2.4e-8, "iyy": 2.8e-8, "izz": 3.8e-8, "ixy": 6.1e-8}
    (finding,) = check_urdf(tip(1e-6, **wrong))
    assert finding.severity == "warning"
    assert "not positive definite" in finding.message
    (finding,) = check_urdf(tip(1e-6, ixx=1e-9, iyy=1e-9, izz=3e-9))
    assert finding.severity == "warning"
    assert "no body has this inertia" in finding.message
    (finding,) = check_urdf(tip(0.1, **wrong))
    assert finding.severity == "error"
    assert "check signs and products" in finding.remedy
