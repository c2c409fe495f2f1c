"""Starting states: on the floor, inside the joints' ranges, and as the task spreads them."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from hyperleg_design.simulation.settings import Start
from hyperleg_design.simulation.stepping.start import _quaternion

STILL = Start(joint_position=0, joint_velocity=0, linear_velocity=0, tilt=0, yaw=0, stride_share=0)


def states(environment, index=0):
    chunk = environment.chunks[0]
    return chunk.drive.qpos.copy(), chunk.drive.qvel.copy(), environment.models[index]


def lowest_pad(model, qpos, pads):
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    mujoco.mj_kinematics(model, data)
    return min(data.geom(pad).xpos[2] - model.geom(pad).size[0] for pad in pads)


@pytest.mark.parametrize("start", [STILL, Start(), Start(stride_share=1.0)])
def test_the_lowest_pad_touches_the_floor(make, start):
    environment = make(simulations=6, start=start)
    environment.reset()
    qpos, _, model = states(environment)
    heights = [lowest_pad(model, row, environment.layout.pads) for row in qpos]
    np.testing.assert_allclose(heights, 0.0, atol=1e-6)


def test_joints_start_within_their_ranges_and_near_the_default_posture(make):
    wide = Start(joint_position=1.0, stride_share=0)
    environment = make(simulations=32, start=wide)
    environment.reset()
    qpos, _, _ = states(environment)
    layout = environment.layout
    assert np.all(qpos[:, 7:] >= layout.lower - 1e-9)
    assert np.all(qpos[:, 7:] <= layout.upper + 1e-9)
    assert np.all(np.abs(qpos[:, 7:] - layout.default) <= 1.0 + 1e-9)
    assert np.any(qpos[:, 7:] == layout.lower)


def test_without_a_spread_all_stand_alike_and_still(make):
    environment = make(simulations=3, start=STILL)
    environment.reset()
    qpos, qvel, _ = states(environment)
    np.testing.assert_allclose(qpos[:, 7:], np.tile(environment.layout.default, (3, 1)))
    np.testing.assert_allclose(qpos[:, 3:7], np.tile([1.0, 0, 0, 0], (3, 1)))
    assert not qvel.any()


def test_angles_turn_about_z_then_y_then_x():
    from scipy.spatial.transform import Rotation

    roll, pitch, yaw = np.random.default_rng(0).uniform(-1, 1, (3, 20))
    expected = Rotation.from_euler("ZYX", np.stack([yaw, pitch, roll], 1)).as_quat()
    own = _quaternion(roll, pitch, yaw)[:, [1, 2, 3, 0]]
    np.testing.assert_allclose(np.abs((own * expected).sum(1)), 1.0, atol=1e-12)
