"""Frames of links and joints against MuJoCo's."""

from __future__ import annotations

import mujoco
import numpy as np

from hyperleg_design.gap.signals.loading import load_subject


def test_frames_are_where_mujoco_puts_them(robot_files):
    from hyperleg_design.gap.model.frames import link_poses

    subject = load_subject(robot_files["arm"])
    position = np.random.default_rng(1).uniform(-2, 2, (5, 6))
    axes, origins = link_poses(subject, position, np.arange(len(subject.links)))
    data = mujoco.MjData(subject.model)
    for tick in range(5):
        data.qpos[:] = position[tick]
        mujoco.mj_kinematics(subject.model, data)
        for row, link in enumerate(subject.links):
            np.testing.assert_allclose(origins[tick, row], data.body(link).xpos, atol=1e-12)
            np.testing.assert_allclose(
                axes[tick, row], data.body(link).xmat.reshape(3, 3), atol=1e-12
            )
