from __future__ import annotations

import json

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.learning.preset_file import load_preset, preset_from_mapping
from hyperleg_design.learning.resolved import preset_mapping, task_mapping
from hyperleg_design.resources import sim_names
from hyperleg_design.simulation.design_spread import load_design_spread
from hyperleg_design.simulation.tasks import load_task, task_from_mapping


@pytest.mark.parametrize("name", sim_names("task"))
def test_a_task_comes_back_from_json(name: str) -> None:
    mapping = json.loads(json.dumps(task_mapping(load_task(name))))
    again = task_from_mapping(mapping, "json")
    assert json.loads(json.dumps(task_mapping(again))) == mapping
    assert again.deviations == load_task(name).deviations
    assert again.commands.__dict__ == load_task(name).commands.__dict__


@pytest.mark.parametrize(
    ("name", "task"), [("laptop", "walk"), ("laptop", "goal"), ("paper", "walk_paper")]
)
def test_a_preset_comes_back_from_json(name: str, task: str) -> None:
    mapping = json.loads(json.dumps(preset_mapping(load_preset(name), task)))
    again = preset_from_mapping(mapping, "json")
    assert json.loads(json.dumps(preset_mapping(again, task))) == mapping
    assert again.stages(task) is not None
    assert again.total_iterations(task) == load_preset(name).total_iterations(task)


def test_a_task_of_many_designs_comes_back_from_json() -> None:
    ranges = load_design_spread("toe").ranges
    task = load_task("walk_upright").conditioned(ranges)
    mapping = json.loads(json.dumps(task_mapping(task)))
    again = task_from_mapping(mapping, "json")
    assert again.designs == ranges
    assert all(parts[-1] == "design" for parts in again.observations.values())
    assert json.loads(json.dumps(task_mapping(again))) == mapping


@pytest.mark.parametrize("part", ["designs", "observations"])
def test_design_part_and_ranges_need_each_other(part: str) -> None:
    mapping = task_mapping(load_task("walk_upright").conditioned(load_design_spread("toe").ranges))
    if part == "designs":
        del mapping["designs"]
    else:
        mapping["observations"] = task_mapping(load_task("walk_upright"))["observations"]
    with pytest.raises(InputError, match="designs"):
        task_from_mapping(mapping, "json")
