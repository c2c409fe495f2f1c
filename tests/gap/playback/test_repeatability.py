"""How well a robot repeats itself: the size of the noise."""

from __future__ import annotations

import numpy as np
import pytest
import robots
from diagnosed import conditioned

from hyperleg_design.gap.playback.measure import measure


def test_split_floor_is_the_noise_of_the_torques(robot_files, runs):
    (test,) = conditioned(robot_files["pendulum"], robots.noisy(runs["pendulum"], 3, torque=0.05))
    row = measure([test], predict=False).select("torque")[0]
    # white noise of 0.05 Nm at 200 Hz keeps a tenth of its power below 10 Hz
    assert row.floor == pytest.approx(0.05 * np.sqrt(0.1), rel=0.15)
    assert row.gap == pytest.approx(row.floor, rel=0.3)


def test_repeats_of_a_motion_are_found_and_give_the_floor(robot_files, runs):
    logs = [robots.noisy(runs["arm"], seed, torque=0.5) for seed in (0, 1)]
    gap = measure(conditioned(robot_files["arm"], *logs), predict=False)
    assert gap.floor_from == "repeats"
    assert gap.select("torque", "joint", "shoulder_pan")[0].floor == pytest.approx(
        0.5 * np.sqrt(0.1), rel=0.2
    )
