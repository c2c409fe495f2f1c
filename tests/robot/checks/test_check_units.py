"""Numbers in other units are seen by `check` and refused by `import`, by the same rules."""

from __future__ import annotations

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.checks.check_mjcf import check_mjcf
from hyperleg_design.robot.checks.check_urdf import check_urdf
from hyperleg_design.robot.described_file import read_robot
from hyperleg_design.robot.description import urdf
from tests.robot.tree_files import leg

MJCF = """<mujoco><worldbody><body name="base" pos="0 0 9"><geom size="0.1" mass="1"/>
<body name="thigh" pos="0 0 -0.2"><joint name="hip" axis="0 1 0" range="-90 90"/>
<geom size="0.05" mass="1" pos="0 0 -0.1"/></body></body></worldbody></mujoco>"""
FAR = ('xyz="0.0 0.0 -0.2"/>\n    <parent', 'xyz="0.0 0.0 -200.0"/>\n    <parent')


def errors(findings):
    return [str(f) for f in findings if f.severity == "error"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (*FAR, ["joint knee", "is 200 m from thigh", "millimetres"]),
        ('upper="3.14', 'upper="180.0" was="3.14', ["joint hip", "180 rad", "degrees"]),
    ],
)
def test_check_and_import_refuse_the_same_of_a_urdf(old, new, words, tmp_path):
    path = tmp_path / "leg.urdf"
    text = urdf(leg())
    assert old in text
    path.write_text(text.replace(old, new, 1))
    (error,) = errors(check_urdf(path))
    with pytest.raises(InputError) as refused:
        read_robot(path)
    for word in words:
        assert word in error
        assert word in str(refused.value)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('pos="0 0 -0.2"', 'pos="0 0 -200"', ["is 200 m from base", "millimetres"]),
        ('range="-90 90"', 'range="-5157 90"', ["-90.01 .. 1.571 rad", "degrees"]),
    ],
)
def test_check_and_import_refuse_the_same_of_an_mjcf(old, new, words, tmp_path):
    assert errors(check_mjcf(MJCF)) == []
    path = tmp_path / "leg.xml"
    path.write_text(MJCF.replace(old, new))
    (error,) = errors(check_mjcf(path))
    with pytest.raises(InputError) as refused:
        read_robot(path)
    for word in words:
        assert word in error
        assert word in str(refused.value)


def test_a_robot_may_stand_far_from_the_origin_of_the_world(tmp_path):
    path = tmp_path / "leg.xml"
    path.write_text(MJCF)
    assert read_robot(path).joints["base_mount"].position[2] == 9


def test_speeds_in_degrees_are_seen_and_round_ones_stand_for_no_limit():
    text = urdf(leg())
    (speed,) = {part.split('"')[0] for part in text.split('velocity="')[1:2]}

    def warned(value):
        found = check_urdf(text.replace(f'velocity="{speed}"', f'velocity="{value}"', 1))
        return [str(f) for f in found]

    assert warned("1000") == warned("10000") == warned("120") == warned("2e6") == []
    (warning,) = warned("1719")
    for word in ("warning: joint hip", "velocity is 1719 rad/s", "degrees a second (30 rad/s)"):
        assert word in warning


def test_grams_are_seen_beside_millimetres():
    text = urdf(leg()).replace(*FAR, 1)
    assert not [f for f in check_urdf(text) if "grams" in f.remedy]
    grams = text.replace('mass value="1.0"', 'mass value="1000.0"')
    (finding,) = [f for f in check_urdf(grams) if "grams" in f.remedy]
    assert finding.severity == "warning"
