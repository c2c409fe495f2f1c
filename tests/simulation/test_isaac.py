from __future__ import annotations

import json

import mujoco
import numpy as np
import pytest

from hyperleg_design import cli
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.mjcf import mujoco_model
from hyperleg_design.simulation.isaac import FILE, isaac_actuators


@pytest.mark.parametrize("name", ["toe", "toe_removed", "mini_cheetah"])
def test_armature_is_what_the_motors_add_to_mujocos_mass_matrix(name):
    design = load_robot(name)
    found = isaac_actuators(design)
    model = mujoco_model(design, floor=False)
    full, bare = np.zeros((2, model.nv, model.nv))
    for matrix, armature in ((full, 1.0), (bare, 0.0)):
        model.tendon_armature[:] *= armature
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        mujoco.mj_fullM(model, data, matrix)
    added = full - bare
    for joint, values in found["actuators"].items():
        dof = model.joint(joint).dofadr[0]
        assert values["armature"] == pytest.approx(added[dof, dof], rel=1e-9)
    off = added - np.diag(np.diag(added))
    assert found["armature_between"] == pytest.approx(np.abs(off).max(), rel=1e-9, abs=1e-12)


def test_limits_of_a_joint_with_a_motor_of_its_own():
    found = isaac_actuators(load_robot("toe"))
    hip = found["actuators"]["left_hip_pitch"]
    assert hip["effort_limit"] == pytest.approx(25 * 5.04)
    assert hip["saturation_effort"] == pytest.approx(25 * 84.75, rel=1e-3)
    assert hip["velocity_limit"] == pytest.approx(300 / 25)
    assert "left_hip_pitch" not in found["coupled"]
    assert {"left_knee", "right_ankle_roll", "left_toe"} <= set(found["coupled"])


def test_the_command_adds_the_file(tmp_path, capsys):
    assert cli.main(["build", "--for", "isaac", "--out", str(tmp_path / "r"), "--json"]) == 0
    assert FILE in json.loads(capsys.readouterr().out)["files"]
    assert len(json.loads((tmp_path / "r" / FILE).read_text())["actuators"]) == 14
