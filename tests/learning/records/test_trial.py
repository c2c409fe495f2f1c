from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.learning.records import trial as module
from hyperleg_design.learning.records.trial import trial
from hyperleg_design.robot.design import Design
from hyperleg_design.simulation.tasks import load_task


def test_a_robot_that_does_nothing_stands_and_goes_nowhere(
    hyperleg: Design, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "WALK", 0.6)
    found = trial(
        hyperleg,
        load_task("walk"),
        lambda observation: np.zeros((len(observation), 14)),
        simulations=6,
    )
    assert found["survival"] == 1.0
    assert abs(found["speed"]) < 0.3
    assert found["speed_error"] == pytest.approx(1.33 - found["speed"], abs=0.1)
    assert (found["double_support"], found["flight"]) == (1.0, 0.0)
    assert found["cadence"] == 0.0


def test_falls_are_counted_and_nothing_is_measured_on_the_fallen(
    hyperleg: Design, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "WALK", 4.0)
    found = trial(
        hyperleg,
        load_task("walk"),
        lambda observation: np.full((len(observation), 14), 3.0),
        simulations=4,
    )
    assert found["survival"] == 0.0
    assert np.isnan(found["speed"])


def test_a_course_that_is_not_run(hyperleg: Design, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "COURSE", 0.4)
    found = trial(
        hyperleg,
        load_task("goal"),
        lambda observation: np.zeros((len(observation), 14)),
        simulations=4,
    )
    assert (found["finished"], found["survival"]) == (0.0, 1.0)
    assert np.isnan(found["time"])


def test_the_same_seed_gives_the_same_trial(
    hyperleg: Design, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "WALK", 0.3)
    rng = np.random.default_rng(0).normal(size=(4, 14))
    first, again = (
        trial(hyperleg, load_task("walk"), lambda observation: rng, simulations=4, seed=5)
        for _ in range(2)
    )
    assert first == again
