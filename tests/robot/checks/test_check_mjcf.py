from __future__ import annotations

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.ablation import variants
from hyperleg_design.robot.checks.check_mjcf import check_mjcf
from hyperleg_design.robot.mjcf import mjcf

GOOD = """<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body name="arm" pos="0 0 1">
      <joint name="hinge" axis="0 1 0" range="-90 90"/>
      <geom name="rod" type="capsule" size="0.02" fromto="0 0 0 0 0 -0.3"/>
    </body>
  </worldbody>
  <actuator><motor name="m" joint="hinge" ctrlrange="-1 1"/></actuator>
  <keyframe><key name="home" qpos="0.1"/></keyframe>
</mujoco>
"""


@pytest.mark.parametrize("variant", ["toe", "toe_locked", "toe_removed_matched", "toe_removed"])
def test_nothing_is_wrong_with_what_we_write(hyperleg, variant):
    assert check_mjcf(mjcf(variants(hyperleg)[variant])) == []


@pytest.mark.parametrize(
    ("old", "new", "severity", "words"),
    [
        ("</worldbody>", "", "error", "not XML"),
        ("<mujoco>", "<mujoco><sky/>", "error", "does not compile"),
        ('joint="hinge" ctrl', 'joint="hing" ctrl', "error", "hing"),
        ('range="-90 90"', 'range="90 -90"', "error", "reversed"),
        ('qpos="0.1"', 'qpos="0.1 0.2"', "error", "does not compile"),
        ('qpos="0.1"', 'qpos="3"', "warning", "keyframe home: joint hinge is at 3"),
        ('pos="0 0 1"', 'pos="0 0 0.2"', "warning", "overlap"),
        ('range="-90 90"', "", "warning", "no range"),
        ('<motor name="m" joint="hinge" ctrlrange="-1 1"/>', "", "warning", "no actuators"),
        ("<worldbody>", '<option timestep="0.1"/><worldbody>', "warning", "timestep is 0.1"),
        ('<joint name="hinge" axis="0 1 0" range="-90 90"/>', "", "error", ""),
    ],
)
def test_a_fault_is_found(old, new, severity, words):
    assert check_mjcf(GOOD) == []
    assert old in GOOD
    found = check_mjcf(GOOD.replace(old, new, 1))
    assert any(f.severity == severity and words in str(f) for f in found)
    assert all(f.remedy and "\n" not in str(f) for f in found)


def test_what_is_no_mjcf(tmp_path):
    assert "<robot>" in str(check_mjcf("<robot name='x'/>")[0])
    assert "nothing moves" in str(
        check_mjcf("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")[0]
    )
    with pytest.raises(InputError, match="cannot be read"):
        check_mjcf(tmp_path / "no.xml")


def test_included_files_are_found_beside_the_file(write):
    write(
        "part.xml",
        "<mujoco><worldbody><body name='b'><joint name='j' range='-1 1'/><geom "
        "size='0.1'/></body></worldbody></mujoco>",
    )
    main = write(
        "main.xml",
        "<mujoco><include file='part.xml'/><actuator><motor joint='j'/></actuator></mujoco>",
    )
    assert check_mjcf(main) == []
    missing = write("other.xml", "<mujoco><include file='gone.xml'/></mujoco>")
    assert "gone.xml" in str(check_mjcf(missing)[0])
