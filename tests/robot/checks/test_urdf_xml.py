import numpy as np
import pytest
from lxml import etree

from hyperleg_design.errors import InputError
from hyperleg_design.robot.checks.urdf_xml import (
    check_origin,
    ends_of,
    numbers,
    parse_xml,
    place_of,
)


def element(text):
    return etree.fromstring(text)


def test_another_root_is_an_error_with_its_line_and_remedy():
    root, (finding,) = parse_xml("<mujoco/>", "robot", "a URDF starts with <robot>")
    assert root is None
    assert str(finding) == "error: line 1: the root element is <mujoco>; a URDF starts with <robot>"
    root, findings = parse_xml("<mujoco/>")
    assert (root.tag, findings) == ("mujoco", [])


def test_broken_syntax_names_its_line():
    root, (finding,) = parse_xml("<robot>\n<link>\n</robot>", "robot")
    assert root is None
    assert finding.place == "line 3"


def test_a_file_that_is_not_there_is_an_input_error(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        parse_xml(tmp_path / "none.urdf")


def test_outside_entities_are_not_read(tmp_path):
    secret = tmp_path / "secret"
    secret.write_text("hidden")
    text = f'<!DOCTYPE robot [<!ENTITY x SYSTEM "{secret.as_uri()}">]><robot>&x;</robot>'
    root, _ = parse_xml(f"<?xml version='1.0'?>{text}")
    assert "hidden" not in "".join(root.itertext())


@pytest.mark.parametrize("text", [None, "", "1 2", "1 2 3 4", "1 2 x", "1 2 nan", "1 2 inf"])
def test_numbers_are_all_there_and_finite(text):
    np.testing.assert_array_equal(numbers(" 1 -2.5  3e1 ", 3), [1.0, -2.5, 30.0])
    assert numbers(text, 3) is None


def test_joints_and_places_are_named():
    joint = element('<joint name="a"><child link="c"/></joint>')
    assert ends_of(joint) == (None, "c")
    assert place_of(joint) == "joint a (line 1)"
    assert place_of(element("<link/>")) == "link (no name) (line 1)"


def test_an_origin_has_three_numbers_each():
    good = element('<joint><origin xyz="0 0 1"/></joint>')
    bad = element('<joint><origin xyz="0 0" rpy="a b c"/></joint>')
    assert check_origin(good, "here") == check_origin(element("<joint/>"), "here") == []
    assert [f.message for f in check_origin(bad, "here")] == [
        "origin has xyz='0 0'",
        "origin has rpy='a b c'",
    ]
