from __future__ import annotations

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.learning.preset_file import load_preset, preset_from_mapping
from hyperleg_design.resources import sim_names

from .conftest import tiny_mapping


def test_shipped_presets_are_read() -> None:
    assert {"laptop", "paper"} <= set(sim_names("preset"))
    for name in sim_names("preset"):
        assert load_preset(name).name == name


def test_paper_preset_is_table_two() -> None:
    paper = load_preset("paper")
    assert (paper.simulations, paper.rollout) == (8192, 24)
    assert paper.total_iterations("walk_paper") == paper.total_iterations("goal_paper") == 3000
    algorithm = paper.algorithm
    assert (algorithm.discount, algorithm.trace, algorithm.clip, algorithm.entropy) == (
        0.99,
        0.95,
        0.2,
        0.01,
    )
    assert (algorithm.learning_rate, algorithm.kl_target, algorithm.adapted) == (
        1e-4,
        0.01,
        "minibatch",
    )
    assert paper.network.hidden == (512, 256, 128)
    assert paper.network.activation == "elu"
    assert all(stage.assist is None for stage in paper.stages("walk_paper"))


def test_last_stages_of_the_laptop_run_without_assist() -> None:
    laptop = load_preset("laptop")
    for stages in laptop.tasks.values():
        assert stages[-1].assist == 0.0 or stages[-1].assist_gone_by < 1.0


@pytest.mark.parametrize(
    ("place", "value", "field"),
    [
        (("simulations",), 2.5, "simulations"),
        (("rollouts",), 3, "rollouts"),
        (("algorithm", "clip"), 3, "algorithm.clip"),
        (("algorithm", "mirror"), "append", "algorithm.adapted"),
        (("network", "hidden"), [0], "network.hidden"),
        (("network", "hidden"), [True], "network.hidden"),
        (("tasks", "walk", 0, "rewards"), {"speed": 1}, "tasks.walk.0.rewards.speed"),
        (("tasks", "walk", 0, "rewards"), {"power": {"width": 1}}, "tasks.walk.0.rewards.power"),
        (("tasks", "walk", 0, "assist"), 2, "tasks.walk.0.assist"),
        (("tasks", "walk", 0, "step"), 2, "tasks.walk.0.step"),
        (("tasks", "walk", 1, "ramps", 0, "set"), "physics.cone", "tasks.walk.1.ramps.0.set"),
        (("tasks", "walk", 1, "ramps", 0, "begins"), "late", "tasks.walk.1.ramps.0.begins"),
        (("tasks", "walk"), [], "tasks.walk"),
        (("tasks",), None, "tasks"),
        (("name",), None, "name"),
    ],
)
def test_bad_presets_name_the_field(place: tuple, value: object, field: str) -> None:
    data = tiny_mapping()
    inner = data
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = value
    with pytest.raises(InputError) as caught:
        preset_from_mapping(data, "mine.yaml")
    assert caught.value.field == field
    assert caught.value.where == "mine.yaml"


def test_a_task_without_stages_and_a_preset_that_does_not_exist() -> None:
    with pytest.raises(InputError, match="has no stages"):
        load_preset("laptop").stages("juggle")
    with pytest.raises(InputError, match="laptop"):
        load_preset("desktop")


def test_a_preset_fills_itself_from_its_base(write) -> None:
    path = write(
        "mine.yaml",
        "name: mine\nbase: designs\nrollout: 8\nalgorithm: {epochs: 7}\n"
        "tasks: {walk: [{name: all, steps: 8192, assist: 0.0}]}\n",
    )
    mine, base, study = load_preset(path), load_preset("designs"), load_preset("study")
    assert (mine.name, list(mine.tasks)) == ("mine", ["walk"])
    assert (mine.rollout, mine.simulations) == (8, base.simulations)
    assert (mine.algorithm.epochs, mine.algorithm.kl_target) == (7, base.algorithm.kl_target)
    assert mine.algorithm.clip == study.algorithm.clip  # the base's base
    assert mine.network.hidden == study.network.hidden
    assert mine.warm_start.critic_iterations == base.warm_start.critic_iterations


@pytest.mark.parametrize("base", ["mine.yaml", "[study]", "3"])
def test_a_base_must_be_another_preset(write, base: str, monkeypatch, tmp_path) -> None:
    monkeypatch.chdir(tmp_path)
    write("mine.yaml", f"name: mine\nbase: {base}\ntasks: {{walk: [{{name: a, steps: 1}}]}}\n")
    with pytest.raises(InputError, match=r"base.*expects the name of a preset"):
        load_preset("mine.yaml")


def test_a_base_that_does_not_exist_is_named(write) -> None:
    path = write("mine.yaml", "name: mine\nbase: nothing\ntasks: {walk: [{name: a, steps: 1}]}\n")
    with pytest.raises(InputError, match=r"mine\.yaml: base = 'nothing': no such file.*study"):
        load_preset(path)
