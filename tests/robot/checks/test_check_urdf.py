from __future__ import annotations

from pathlib import Path

import pinocchio
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

from hyperleg_design.errors import InputError
from hyperleg_design.robot.checks.check_urdf import check_urdf
from hyperleg_design.robot.description import urdf
from tests.robot.checks.urdfs import GOOD

FAULTS = {
    "syntax": ('</link>\n  <link name="tip"/>', '\n  <link name="tip"/>', "is not XML"),
    "no name": ('name="arm"', "", "no name"),
    "loose link": ('<link name="tip"/>', '<link name="tip"/><link name="spare"/>', "is loose"),
    "loose tree": ('<parent link="upper"/>', '<parent link="tip"/>', "loop"),
    "two links of a name": (
        '<link name="tip"/>',
        '<link name="tip"/><link name="tip"/>',
        "stands twice",
    ),
    "two joints of a name": ('name="tip_joint"', 'name="elbow"', "stands twice"),
    "nameless link": ('<link name="tip"/>', '<link name="tip"/><link/>', "no name"),
    "missing child": ('<child link="lower"/>', '<child link="lowr"/>', "'lowr', is no link"),
    "missing parent": ('<parent link="base"/>', "", "no <parent link=...>"),
    "two parents": (
        "</robot>",
        '<joint name="x" type="fixed"><parent link="base"/><child link="tip"/></joint></robot>',
        "hangs on joint",
    ),
    "own parent": (
        '<parent link="lower"/><child link="tip"/>',
        '<parent link="tip"/><child link="tip"/>',
        "loop",
    ),
    "no mass": ('<mass value="1"/>', "", "mass is None"),
    "negative mass": ('<mass value="1"/>', '<mass value="-1"/>', "mass is -1 kg"),
    "text mass": ('<mass value="1"/>', '<mass value="1kg"/>', "mass is '1kg'"),
    "mass not finite": ('<mass value="1"/>', '<mass value="nan"/>', "mass is 'nan'"),
    "weightless": ('<mass value="1"/>', '<mass value="0"/>', "has no mass"),
    "no inertia": ('<inertia ixx="0.01" iyy="0.01" izz="0.002"/>', "", "no <inertia>"),
    "half an inertia": ('ixx="0.01" ', "", "lacks a number"),
    "negative inertia": ('ixx="0.01"', 'ixx="-0.01"', "not positive definite"),
    "large product": ('ixy="0.0001"', 'ixy="0.1"', "not positive definite"),
    "no body's inertia": ('izz="0.002"', 'izz="0.05"', "no body has this inertia"),
    "reversed": ('lower="-1" upper="2"', 'lower="2" upper="-1"', "reversed"),
    "no range": ('lower="-1" upper="2"', "", "empty"),
    "text limit": ('lower="-1" upper="2"', 'lower="-1 rad" upper="2"', "lower is '-1 rad'"),
    "no limit": ('<limit lower="-1" upper="2" effort="10" velocity="5"/>', "", "no <limit>"),
    "no effort": ('upper="2" effort="10"', 'upper="2"', "effort is None"),
    "zero effort": ('upper="2" effort="10"', 'upper="2" effort="0"', "effort is '0'"),
    "negative velocity": (
        'upper="2" effort="10" velocity="5"',
        'upper="2" effort="10" velocity="-5"',
        "velocity is '-5'",
    ),
    "zero axis": (
        '<axis xyz="0 1 0"/>\n    <limit lower="-1" upper="2"',
        '<axis xyz="0 0 0"/>\n    <limit lower="-1" upper="2"',
        "axis is zero",
    ),
    "short axis": (
        '<axis xyz="0 1 0"/>\n    <limit lower="-1" upper="2"',
        '<axis xyz="0 1"/>\n    <limit lower="-1" upper="2"',
        "axis is '0 1'",
    ),
    "joint type": ('name="elbow" type="revolute"', 'name="elbow" type="hinge"', "type is 'hinge'"),
    "bad origin": ('<origin xyz="0 0 0.2"/>', '<origin xyz="0 0"/>', "xyz='0 0'"),
    "bad box": ('size="0.1 0.1 0.2"', 'size="0.1 -0.1 0.2"', "box has size"),
    "no geometry": ('<geometry><sphere radius="0.02"/></geometry>', "", "no geometry"),
    "friction": ('friction="0"', 'friction="-1"', "friction is '-1'"),
    "mimic": (
        '<dynamics damping="0.1" friction="0"/>',
        '<mimic joint="wrist"/>',
        "'wrist', which is no joint",
    ),
    "xacro": (
        '<link name="tip"/>',
        '<link name="tip"/><xacro:x xmlns:xacro="http://www.ros.org/wiki/xacro"/>',
        "xacro",
    ),
}

DOUBTS = {
    "degrees": ('lower="-1" upper="2"', 'lower="-9" upper="2"', "radians"),
    "zero posture": ('lower="-1" upper="2"', 'lower="0.5" upper="2"', "zero posture"),
    "long axis": (
        '<axis xyz="0 1 0"/>\n    <limit lower="-1" upper="2"',
        '<axis xyz="0 2 0"/>\n    <limit lower="-1" upper="2"',
        "unit vector",
    ),
    "units of inertia": (
        'ixx="0.01" iyy="0.01" izz="0.002"',
        'ixx="100" iyy="100" izz="20"',
        "units",
    ),
}


def test_nothing_is_wrong_with_a_good_one():
    assert check_urdf(GOOD) == []


@pytest.mark.parametrize("case", FAULTS)
def test_a_fault_is_found_and_placed(case):
    old, new, words = FAULTS[case]
    assert old in GOOD
    found = [f for f in check_urdf(GOOD.replace(old, new, 1)) if words in str(f)]
    assert len(found) >= 1
    assert all(f.severity == "error" and f.remedy for f in found)


@pytest.mark.parametrize("case", DOUBTS)
def test_a_doubt_is_a_warning(case):
    old, new, words = DOUBTS[case]
    found = check_urdf(GOOD.replace(old, new, 1))
    assert [f.severity for f in found] == ["warning"]
    assert words in str(found[0])


def test_places_name_element_and_line():
    found = check_urdf(GOOD.replace('upper="2" effort="10"', 'upper="2" effort="0"'))
    assert [f.place for f in found] == ["joint shoulder (line 12)"]


def test_all_faults_are_told_at_once():
    broken = GOOD
    for case in ("loose link", "negative mass", "no body's inertia", "reversed", "friction"):
        old, new, _ = FAULTS[case]
        broken = broken.replace(old, new, 1)
    found = check_urdf(broken)
    for case in ("loose link", "negative mass", "reversed", "friction"):
        assert any(FAULTS[case][2] in str(f) for f in found), case


@pytest.mark.parametrize("text", ["<mujoco/>", "<robot name='x'/>", "<robot"])
def test_what_is_no_robot(text):
    assert [f.severity for f in check_urdf(text)] == ["error"]


def test_files_that_cannot_be_read(tmp_path: Path):
    for path in (tmp_path / "no.urdf", tmp_path, "a\0b.urdf"):
        with pytest.raises(InputError, match="cannot be read"):
            check_urdf(path)


def test_an_entity_bomb_does_not_go_off():
    bomb = (
        '<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa">'
        + "".join(f'<!ENTITY {chr(98 + i)} "{f"&{chr(97 + i)};" * 10}">' for i in range(12))
        + "]>"
    )
    assert check_urdf(bomb + GOOD.replace('name="arm"', 'name="&m;"'))
    assert check_urdf(bomb + '<robot name="x">&m;</robot>')


@given(st.data())
@settings(max_examples=80)
def test_any_attribute_replaced_by_anything(hyperleg_urdf, data):
    """Whatever stands in an attribute, the answer is a list of findings."""
    root = etree.fromstring(hyperleg_urdf)
    elements = [e for e in root.iter() if isinstance(e.tag, str) and e.attrib]
    element = elements[data.draw(st.integers(0, len(elements) - 1))]
    key = data.draw(st.sampled_from(sorted(element.attrib)))
    if data.draw(st.booleans()):
        element.set(
            key,
            data.draw(
                st.sampled_from(
                    [
                        "",
                        "nan",
                        "1e999",
                        "x",
                        "0 0 0",
                        "-1",
                        "1 2 3 4",
                        "pelvis",
                        "left_knee",
                        "fixed",
                        "0",
                    ]
                )
            ),
        )
    else:
        element.getparent().remove(element) if element is not root else None
    assert all(
        f.severity in ("error", "warning") and f.message and f.remedy
        for f in check_urdf(etree.tostring(root, encoding="unicode"))
    )


@pytest.fixture(scope="module")
def hyperleg_urdf(hyperleg) -> bytes:
    return urdf(hyperleg).encode()


ROBOTS = Path(pinocchio.__file__).parents[4] / "share" / "example-robot-data" / "robots"


@pytest.mark.parametrize(
    ("name", "errors"),
    [
        ("bolt_description/robots/bolt.urdf", []),
        ("g1_description/urdf/g1_29dof_rev_1_0.urdf", []),
        ("double_pendulum_description/urdf/double_pendulum.urdf", ["empty", "effort", "velocity"]),
        ("human_description/robots/human.urdf", ["has no mass"]),
    ],
)
def test_other_peoples_robots(name, errors):
    found = [f.message for f in check_urdf(ROBOTS / name) if f.severity == "error"]
    assert all(any(word in message for message in found) for word in errors)
    assert all(any(word in message for word in errors) for message in found)
