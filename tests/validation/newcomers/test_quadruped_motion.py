"""Targets of the quadruped put its feet where they are wanted."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from hyperleg_design.validation.newcomers.quadruped import careful_file
from hyperleg_design.validation.newcomers.quadruped_log import FEET
from hyperleg_design.validation.newcomers.quadruped_motion import (
    HEIGHT,
    MOTIONS,
    SOLE,
    STANCE,
    joint_angles,
)


def test_joint_angles_put_the_feet_of_the_model_at_their_places():
    model = mujoco.MjModel.from_xml_string(careful_file())
    data, rng = mujoco.MjData(model), np.random.default_rng(3)
    feet = np.column_stack([STANCE, np.full(4, SOLE - HEIGHT)])
    wanted = feet + rng.uniform(-0.05, 0.05, (20, 4, 3))
    for places, angles in zip(wanted, joint_angles(wanted), strict=True):
        data.qpos[:] = np.r_[0, 0, 0, 1, 0, 0, 0, angles]
        mujoco.mj_kinematics(model, data)
        reached = [data.geom_xpos[model.body(name).geomadr[0]] for name in FEET]
        np.testing.assert_allclose(reached, places, atol=1e-6)


@pytest.mark.parametrize("motion", list(MOTIONS))
def test_targets_move_without_jumps_within_the_joints(motion):
    clock = np.arange(4000) * 0.0025
    wanted = MOTIONS[motion](np.random.default_rng(1), clock)
    model = mujoco.MjModel.from_xml_string(careful_file())
    assert (wanted > model.jnt_range[1:, 0]).all()
    assert (wanted < model.jnt_range[1:, 1]).all()
    assert np.abs(np.diff(wanted, axis=0)).max() < 0.05
    assert np.ptp(wanted, 0).max() > 0.1
