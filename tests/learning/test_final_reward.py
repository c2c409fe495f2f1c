"""When helpers are gone, from schedules whose end is known and from schedules that are run."""

from __future__ import annotations

import copy

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.learning.final_reward import final_rewards, final_share, settled_after
from hyperleg_design.learning.preset import preset_from_mapping
from hyperleg_design.learning.schedule import Schedule
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.tasks import load_task

from .conftest import tiny_mapping


def stages(*entries):
    data = tiny_mapping()
    data["tasks"] = {"walk": [{"name": str(i), **entry} for i, entry in enumerate(entries)]}
    return preset_from_mapping(data, "p.yaml").stages("walk")


RAMP = {"set": "rewards.power", "from": 0.0, "to": -1e-4, "steps": 40}


@pytest.mark.parametrize(
    ("entries", "settled"),
    [
        (({"steps": 100},), 0),
        (({"steps": 100, "assist": 1.0, "assist_gone_by": 0.3},), 30),
        (({"steps": 100, "assist": 1.0},), 100),
        (({"steps": 100, "assist": 1.0}, {"steps": 100, "assist_gone_by": 0.5}), 150),
        (({"steps": 100, "assist": 1.0}, {"steps": 100, "assist": 0.0}), 100),
        (({"steps": 100, "ramps": [RAMP]},), 40),
        (
            (
                {
                    "steps": 100,
                    "assist": 1.0,
                    "assist_gone_by": 0.3,
                    "ramps": [{**RAMP, "begins": "assist_gone"}],
                },
            ),
            70,
        ),
        (({"steps": 100}, {"steps": 100, "rewards": {"power": -1e-3}}), 100),
        (({"steps": 30, "ramps": [RAMP]}, {"steps": 100}), float("inf")),
        (({"steps": 100, "ramps": [{**RAMP, "set": "commands.turning", "to": 1}]},), 0),
    ],
)
def test_when_nothing_changes_any_more(entries, settled):
    parts = stages(*entries)
    assert settled_after(parts) == settled
    total = sum(stage.steps for stage in parts)
    assert final_share(parts) == pytest.approx(max(0.0, 1 - settled / total))


def test_a_preset_that_keeps_its_helpers_too_long_is_refused():
    data = copy.deepcopy(tiny_mapping())
    data["tasks"] = {"walk": [{"name": "all", "steps": 100, "assist": 1.0, "assist_gone_by": 0.7}]}
    assert preset_from_mapping({**data, "final_share": 0.3}, "p.yaml").final_share == 0.3
    with pytest.raises(InputError) as caught:
        preset_from_mapping({**data, "final_share": 1 / 3}, "p.yaml")
    assert caught.value.field == "tasks.walk"


def test_the_schedule_sets_what_the_preset_ends_with(hyperleg):
    """However a training goes, its last share of iterations runs under one and the same reward."""
    data = copy.deepcopy(tiny_mapping())
    ramp = {**RAMP, "begins": "assist_gone", "steps": 320}
    first = {"name": "helped", "steps": 640, "assist": 1.0, "assist_gone_by": 0.5, "ramps": [ramp]}
    data["tasks"] = {"walk": [first, {"name": "final", "steps": 640}]}
    preset, task = preset_from_mapping(data, "p.yaml"), load_task("walk")
    settled = settled_after(preset.stages("walk")) / preset.steps_per_iteration
    for episode, share in ((0.0, 0.0), (400.0, 1.0)):
        environment = Environment(hyperleg, task, simulations=2, threads=1)
        schedule = Schedule(preset, "walk")
        while schedule.iteration < schedule.total:
            schedule.apply(environment)
            if schedule.iteration >= settled:
                rewards = {n: r for n, r in environment.chunks[0].rewards.items() if r.weight}
                assert rewards == final_rewards(preset, task)
                assert environment.assist is None
            schedule.advance(episode, share)
        environment.close()
