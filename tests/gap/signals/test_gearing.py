"""Robots with gears in their file: logs of motors on either side mean the same robot, and a healthy
one has no gap.
"""

import numpy as np
import pytest
import robots

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.pipeline.diagnose import diagnose
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject


@pytest.fixture
def robot(robot_files):
    return robot_files["geared"]


@pytest.mark.parametrize("side", ["motor", "joint"])
@pytest.mark.parametrize("names", [("a", "b"), ("hip", "knee")])
@pytest.mark.parametrize("constant", [None, 0.1])
def test_a_log_tells_on_which_side_of_the_gear_it_is(robot, side, names, constant):
    log = robots.geared_run(side, names, constant=constant)
    subject = load_subject(robot, [log])
    assert bool(subject.motor_scale) == (side == "motor")
    assert any("before the gears" in note for note in subject.notes) == (side == "motor")
    signals = condition(log, subject)
    joints = signals.believed
    wanted = (
        robots.GAINS[:, 0] * (signals.target - signals.position)
        - robots.GAINS[:, 1] * signals.velocity
    )
    assert np.abs(joints - wanted)[100:-100].max() < 0.3
    for residual_name, most in {"motion": 0.15, "control": 0.02, "transmission": 0.01}.items():
        found = signals.residual[residual_name][100:-100]
        assert np.sqrt(np.nanmean(found**2)) < most, residual_name


def test_an_idle_log_goes_by_the_names(robot):
    still = robots.geared_run("motor", ("a", "b"))
    silent = {c: np.zeros_like(v) if c.startswith("motor") else v for c, v in still.signals.items()}
    assert load_subject(robot, [Log("still", still.time, silent, still.metadata)]).motor_scale
    named = {c.replace("/a", "/hip").replace("/b", "/knee"): v for c, v in silent.items()}
    assert not load_subject(robot, [Log("still", still.time, named, still.metadata)]).motor_scale


@pytest.mark.slow
def test_a_weak_geared_motor_is_named_with_its_size(robot):
    logs = [robots.geared_run("motor", ("a", "b"), weak=0.75, seed=seed) for seed in (1, 2)]
    found = diagnose(robot, logs, [robots.geared_run("motor", ("a", "b"), seed=3)], threads=1)
    assert found.causes[0].effect in {"torque_constant", "transmission_ratio"}
    assert found.causes[0].location == "hip"
    assert found.causes[0].parameters["scale"].value == pytest.approx(0.75, abs=0.02)
