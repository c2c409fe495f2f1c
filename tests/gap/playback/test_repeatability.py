"""How well a robot repeats itself: the size of the noise."""

from __future__ import annotations

import numpy as np
import pytest
import robots

from hyperleg_design.gap.playback.measure import measure
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject


def noisy(log, seed, torque=0.02):
    rng = np.random.default_rng(seed)
    rounded = robots.quantised(log, 5e-4)
    return rounded.changed(
        signals={
            c: v + rng.normal(0, torque, len(v)) if c.startswith("motor_torque/") else v
            for c, v in rounded.signals.items()
        }
    )


def conditioned(robot_files, name, *logs):
    subject = load_subject(robot_files[name], logs)
    return [condition(log, subject) for log in logs]


def test_split_floor_is_the_noise_of_the_torques(robot_files, runs):
    (test,) = conditioned(robot_files, "pendulum", noisy(runs["pendulum"], 3, torque=0.05))
    row = measure([test], predict=False).select("torque")[0]
    # white noise of 0.05 Nm at 200 Hz keeps a tenth of its power below 10 Hz
    assert row.floor == pytest.approx(0.05 * np.sqrt(0.1), rel=0.15)
    assert row.gap == pytest.approx(row.floor, rel=0.3)


def test_repeats_of_a_motion_are_found_and_give_the_floor(robot_files, runs):
    logs = [noisy(runs["arm"], seed, torque=0.5) for seed in (0, 1)]
    gap = measure(conditioned(robot_files, "arm", *logs), predict=False)
    assert gap.floor_from == "repeats"
    assert gap.select("torque", "joint", "shoulder_pan")[0].floor == pytest.approx(
        0.5 * np.sqrt(0.1), rel=0.2
    )
