"""When helpers are gone, from schedules whose end is known and from schedules that are run."""

from __future__ import annotations

import copy

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.learning.final_reward import final_share, settled_after
from hyperleg_design.learning.preset_file import load_preset, preset_from_mapping
from hyperleg_design.learning.schedule import Schedule
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.tasks import Reward, load_task

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


def final_rewards(preset, task):
    """Reward terms that count at the end of a training; those of weight zero are left out."""
    rewards = {
        name: (reward.weight, dict(reward.parameters)) for name, reward in task.rewards.items()
    }
    for stage in preset.stages(task.name):
        changes = [
            (name, key, value)
            for name, given in stage.rewards.items()
            for key, value in given.items()
        ]
        changes += [
            (ramp.target[1], ramp.target[2], ramp.high)
            for ramp in stage.ramps
            if ramp.target[0] == "rewards"
        ]
        for name, key, value in changes:
            parameters = rewards[name][1]
            if key == "weight":
                rewards[name] = (value, parameters)
            else:
                parameters[key] = value
    return {name: Reward(weight, given) for name, (weight, given) in rewards.items() if weight}


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


PRESETS = {
    "walk_free": "rewards",
    "walk_upright": "study",
    "walk_clock": "rewards",
    "walk_power": "rewards",
    "walk_force": "rewards",
}


@pytest.mark.parametrize(("name", "preset"), PRESETS.items())
def test_every_step_of_the_study_runs_under_its_final_reward(name, preset):
    study, guided, task = load_preset(preset), load_preset("guided"), load_task(name)
    stages = study.stages(name)
    assert study.final_share == final_share(stages) == 1.0
    assert not any(stage.assist for stage in stages)
    ratio = study.total_iterations(name) / guided.total_iterations("walk_guided")
    assert ratio >= 0.5  # with what it starts from, the last third is under the final reward
    assert final_rewards(study, task) == task.rewards


def test_the_primary_study_ends_with_the_papers_reward_and_a_penalty_on_joint_limits():
    study, paper = load_preset("study"), load_task("walk_paper")
    final = final_rewards(study, load_task("walk_free"))
    assert final.pop("joint_limits").weight < 0
    assert final == {n: r for n, r in paper.rewards.items() if n != "joint_limits"}


@pytest.mark.parametrize("name", sorted(set(PRESETS) - {"walk_clock"}))
def test_no_policy_of_the_study_observes_a_gait_clock(name):
    observed = {part for parts in load_task(name).observations.values() for part in parts}
    assert "clock" not in observed


def test_the_guided_beginning_ends_with_the_reward_of_the_upright_walk_and_no_clock():
    guided, task = load_preset("guided"), load_task("walk_guided")
    assert final_rewards(guided, task) == load_task("walk_upright").rewards
    shown = [r for s in guided.stages("walk_guided") for r in s.ramps if r.target[0] == "clock"]
    assert (shown[-1].high, task.clock.shown) == (0.0, 0.0)
    assert settled_after(guided.stages("walk_guided")) < float("inf")


def test_each_variation_differs_from_the_primary_study_in_one_thing():
    primary = final_rewards(load_preset("study"), load_task("walk_free"))
    changed = {}
    for name in sorted(set(PRESETS) - {"walk_free"}):
        final = final_rewards(load_preset(PRESETS[name]), load_task(name))
        changed[name] = {t for t in {**primary, **final} if primary.get(t) != final.get(t)}
    assert changed == {
        "walk_upright": {"power", "tilt", "human_cycle", "stance_flexion"},
        "walk_clock": {"contact_match"},
        "walk_power": {"power"},
        "walk_force": {"ground_force"},
    }


HELPERS = {"flight", "hip_deviation"}


def test_the_last_third_of_the_t_test_has_the_papers_reward_and_marked_terms():
    preset, task = load_preset("t_test"), load_task("t_test_free")
    assert final_share(preset.stages("t_test_free")) == pytest.approx(1 / 3)
    final, paper = final_rewards(preset, task), load_task("goal_paper").rewards
    own = {"power", "goal_arrival", "position_progress"}
    assert {n: final[n] for n in own} == {n: paper[n] for n in own}
    assert set(final) - own <= set(task.deviations)
    assert task.deviations["termination"] == "weight -2000, the paper's is -200"
    assert not HELPERS & set(final)


def test_the_guided_t_test_ends_with_the_rewards_of_the_t_test_but_for_path_speed_and_falls():
    preset, task = load_preset("t_test_guided"), load_task("t_test_guided")
    final = final_rewards(preset, task)
    own = final_rewards(load_preset("t_test"), load_task("t_test_free"))
    assert {n for n in final if final[n] != own[n]} == {
        "path_deviation",
        "termination",
        "goal_speed",
    }
    assert own["termination"].weight < final["termination"].weight < 0
    assert final["path_deviation"].weight < own["path_deviation"].weight < 0
    assert set(own) == set(final)
    assert set(task.rewards) - set(final) == HELPERS
    assert preset.stages("t_test_guided")[-1].commands["course_share"] > 0
    for name in ("t_test_guided", "t_test_free"):
        task = load_task(name)
        assert "clock" not in {part for parts in task.observations.values() for part in parts}
        assert all("path" in parts for parts in task.observations.values())
        assert task.limits.duration >= 30.0


def test_a_task_may_have_the_stages_of_another():
    data = tiny_mapping()
    data["tasks"]["walk_paper"] = "walk"
    preset = preset_from_mapping(data, "p.yaml")
    assert [s.name for s in preset.stages("walk_paper")] == ["first", "second"]
    data["tasks"]["walk_paper"] = "run"
    with pytest.raises(InputError) as caught:
        preset_from_mapping(data, "p.yaml")
    assert caught.value.field == "tasks.walk_paper"
