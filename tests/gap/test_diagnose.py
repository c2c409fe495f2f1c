from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.diagnose import diagnose
from hyperleg_design.gap.log import Log

from .robots import ARM, servo_run, waves

LOAD = '<body name="flange" pos="0 0.1 0"><inertial pos="0 0.05 0" mass="2.8" diaginertia="0.01 0.01 0.01"/></body>'
SIZE = [1, 0.6, 0.8, 0.8, 0.8, 0.8]


def noisy(log: Log, seed: int) -> Log:
    """The log of an arm that follows a planner of its own: torques, no targets, noise."""
    rng = np.random.default_rng(seed)
    noise = {"position": 2e-5, "velocity": 2e-3, "motor_torque": 0.1}
    kept = {c: v for c, v in log.signals.items() if not c.startswith("position_target")}
    return log.changed(signals={c: v + noise[c.split("/")[0]] * rng.normal(size=len(v)) for c, v in kept.items()})


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Log, Log]:
    path = tmp_path_factory.mktemp("arm") / "arm.xml"
    path.write_text(ARM)
    heavy = ARM.replace('<body name="flange" pos="0 0.1 0"/>', LOAD)
    healthy = noisy(servo_run(ARM, waves(6, SIZE, seed=3), 12.0, base="fixed", session="a"), 1)
    loaded = noisy(servo_run(heavy, waves(6, SIZE, seed=4), 12.0, base="fixed", session="b"), 3)
    return path, healthy, loaded


def test_a_load_nobody_told_of_is_named_at_the_last_link(arm: tuple[Path, Log, Log]) -> None:
    path, healthy, loaded = arm
    found = diagnose(path, [loaded], [healthy], threads=1).mapping()
    assert found["verdict"] == "explained"
    cause = found["causes"][0]
    assert (cause["effect"], cause["location"]) == ("payload", "wrist_3_link")
    assert found["gap"]["closed"] > 0.95
    assert cause["parameters"]["mass"]["value"] == pytest.approx(2.8, rel=0.05)
    again = diagnose(path, [loaded], [healthy], threads=2).mapping()
    assert json.dumps(again) == json.dumps(found)


def test_logs_of_another_robot_are_refused(arm: tuple[Path, Log, Log]) -> None:
    with pytest.raises(InputError):
        diagnose("hyperleg", [arm[2]], threads=1)
