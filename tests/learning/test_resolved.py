from __future__ import annotations

import json

import pytest

from hyperleg_design.learning.preset import load_preset, preset_from_mapping
from hyperleg_design.learning.resolved import preset_mapping, task_mapping
from hyperleg_design.simulation.tasks import load_task, task_from_mapping, task_names


@pytest.mark.parametrize("name", task_names())
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
