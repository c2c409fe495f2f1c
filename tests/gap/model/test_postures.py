"""Joints whose position matters, against the torques that robots of MuJoCo need."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from hyperleg_design.gap.model.postures import posture_dependent, turning
from hyperleg_design.gap.signals.loading import load_subject

BODY = '<inertial pos="0.05 0.02 -0.1" mass="1" diaginertia="0.01 0.02 0.03"/>'
GANTRY = """<mujoco><worldbody><body><joint name="x" type="slide" axis="1 0 0"/>{0}
<body><joint name="z" type="slide" axis="0 0 1" {1}/>{0}
<body pos="0 0 -0.3"><joint name="tilt" axis="0 1 0"/>{0}
<body pos="0.1 0 0"><joint name="tool" type="slide" axis="1 0 0"/>{0}</body></body></body></body>
</worldbody></mujoco>"""
ARM = """<mujoco><worldbody><body><joint name="turn" axis="0 0 1"/>{0}
<body pos="0.2 0 0"><joint name="fold" axis="0 0 1"/>{0}</body></body></worldbody></mujoco>"""
LEANING = ARM.replace('name="turn" axis="0 0 1"', 'name="turn" axis="0 1 1"')
ROBOTS = {
    "gantry": (GANTRY.format(BODY, ""), [False, False, True, True]),
    "spring": (GANTRY.format(BODY, 'stiffness="50"'), [False, True, True, True]),
    "upright": (ARM.format(BODY), [False, True]),
    "leaning": (LEANING.format(BODY), [True, True]),
}


@pytest.mark.parametrize("name", ROBOTS)
def test_a_position_matters_where_torques_change_with_it(name, tmp_path):
    text, expected = ROBOTS[name]
    path = tmp_path / "robot.xml"
    path.write_text(text)
    model = mujoco.MjModel.from_xml_string(text)
    data, rng = mujoco.MjData(model), np.random.default_rng(0)
    position, data.qvel[:], acceleration = rng.normal(size=(3, model.nv))
    torques = []
    for shift in (np.zeros(model.nv), *(0.1 * np.eye(model.nv))):
        data.qpos[:], data.qacc[:] = position + shift, acceleration
        mujoco.mj_inverse(model, data)
        torques.append(data.qfrc_inverse.copy())
    changes = np.abs(np.array(torques[1:]) - torques[0]).max(1) > 1e-9
    assert changes.tolist() == expected
    assert posture_dependent(load_subject(path)).tolist() == expected


def test_what_hangs_on_slides_alone_keeps_its_direction(tmp_path):
    path = tmp_path / "gantry.xml"
    path.write_text(ROBOTS["gantry"][0])
    assert turning(load_subject(path)).tolist() == [False, False, True, True]
