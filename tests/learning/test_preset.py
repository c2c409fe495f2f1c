"""Sizes of a training: iterations from steps, and values that no learner takes."""

from __future__ import annotations

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.learning.preset import Algorithm, Network, Preset, Stage, WarmStart


def preset(*steps: float) -> Preset:
    stages = tuple(Stage(name=str(i), steps=count) for i, count in enumerate(steps))
    return Preset(name="mine", simulations=8, rollout=4, tasks={"walk": stages})


@pytest.mark.parametrize(
    ("steps", "iterations"), [(32, 1), (1, 1), (47, 1), (49, 2), (320, 10), (335, 10)]
)
def test_a_stage_takes_the_nearest_whole_number_of_iterations_at_least_one(
    steps: float, iterations: int
) -> None:
    made = preset(steps)
    assert made.steps_per_iteration == 32
    assert made.iterations(made.stages("walk")[0]) == iterations


def test_a_task_takes_the_iterations_of_its_stages() -> None:
    assert preset(64, 1, 320).total_iterations("walk") == 2 + 1 + 10


def test_a_task_without_stages_is_told_with_those_that_have_some() -> None:
    with pytest.raises(InputError, match=r"mine: tasks = 'juggle'.*it has walk"):
        preset(1).stages("juggle")


@pytest.mark.parametrize(
    ("mirror", "mirrored"), [("half", True), ("append", True), ("never", False)]
)
def test_only_never_leaves_the_mirror_out(mirror: str, mirrored: bool) -> None:
    assert Algorithm(mirror=mirror).mirrored is mirrored


@pytest.mark.parametrize(
    ("section", "leaves", "field"),
    [
        (Algorithm, {"discount": 1.2}, "discount"),
        (Algorithm, {"learning_rate": 0.0}, "learning_rate"),
        (Algorithm, {"adapted": "daily"}, "adapted"),
        (Network, {"activation": "sigmoid"}, "activation"),
        (Network, {"deviation": -1.0}, "deviation"),
        (WarmStart, {"forward": 133}, "forward"),
        (Preset, {"name": "mine", "tasks": {}, "final_share": 1.5}, "final_share"),
    ],
)
def test_values_that_no_training_has_are_refused(section: type, leaves: dict, field: str) -> None:
    with pytest.raises(InputError) as caught:
        section(**leaves)
    assert caught.value.field == field
