from __future__ import annotations

import pytest

from hyperleg_design.learning.preset import Preset
from hyperleg_design.learning.preset_file import preset_from_mapping
from hyperleg_design.learning.schedule import DECAY_EVERY, FAST_ENOUGH, LONG_ENOUGH, Schedule
from hyperleg_design.robot.design import Design
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.tasks import load_task
from hyperleg_design.simulation.terms.assist import DECAY, OFF_BELOW

from .conftest import tiny_mapping


@pytest.fixture
def environment(hyperleg: Design) -> Environment:
    return Environment(hyperleg, load_task("walk"), simulations=2, threads=1)


def test_stages_ramps_and_assist(tiny: Preset, environment: Environment) -> None:
    schedule = Schedule(tiny, "walk")
    assert schedule.total == 6
    seen = []
    for _ in range(6):
        schedule.apply(environment)
        rewards, commands = environment.chunks[0].rewards, environment.chunks[0].commander.settings
        gain = 0.0 if environment.assist is None else environment.assist.gain
        seen.append(
            (
                schedule.place,
                gain,
                rewards["power"].weight,
                commands.turning,
                rewards["linear_velocity"].parameters["width"],
            )
        )
        schedule.advance(mean_episode=0.0, share=0.0)
    assert [s[0] for s in seen] == [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2)]
    assert [s[1] for s in seen] == [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]
    assert [s[2] for s in seen] == pytest.approx([-1e-4] * 4 + [-2.5e-4, -4e-4])
    assert [s[3] for s in seen] == pytest.approx([0, 0, 0, 0, 1 / 3, 2 / 3])
    assert {s[4] for s in seen} == {0.25}


def test_assist_is_off_at_its_deadline_however_badly_it_goes(tiny: Preset) -> None:
    from dataclasses import replace

    stage = replace(tiny.tasks["walk"][0], assist_gone_by=0.5, steps=320)
    schedule = Schedule(replace(tiny, tasks={"walk": (stage,)}), "walk")
    gains = []
    for _ in range(10):
        gains.append(schedule.gain)
        schedule.advance(0.0, 0.0)
    assert gains == [1.0] * 5 + [0.0] * 5
    assert schedule.gone == [5]


def test_assist_decays_where_it_goes_well_and_never_grows(
    tiny: Preset,
) -> None:
    from dataclasses import replace

    stage = replace(tiny.tasks["walk"][0], assist_gone_by=1.0, steps=32 * 1000)
    schedule = Schedule(replace(tiny, tasks={"walk": (stage,)}), "walk")
    for _ in range(DECAY_EVERY):
        schedule.advance(LONG_ENOUGH + 1, FAST_ENOUGH - 0.01)
    assert schedule.gain == 1.0
    for _ in range(DECAY_EVERY):
        schedule.advance(LONG_ENOUGH - 1, 0.9)
    assert schedule.gain == 1.0
    for _ in range(DECAY_EVERY):
        schedule.advance(LONG_ENOUGH + 1, 0.9)
    assert schedule.gain == DECAY
    last = schedule.gain
    while schedule.gain:
        schedule.advance(LONG_ENOUGH + 1, 0.9)
        assert schedule.gain <= last
        last = schedule.gain or last
    assert last * DECAY < OFF_BELOW <= last


def test_a_state_put_back_sets_the_same(tiny: Preset, environment: Environment) -> None:
    first = Schedule(tiny, "walk")
    for _ in range(5):
        first.advance(0.0, 0.0)
    again = Schedule(tiny, "walk")
    again.put(first.state())
    first.apply(environment)
    expected = dict(environment.chunks[0].rewards), environment.chunks[0].commander.settings
    other = Environment(environment.design, environment.task, simulations=2, threads=1)
    again.apply(other)
    assert other.chunks[0].rewards == expected[0]
    assert vars(other.chunks[0].commander.settings) == vars(expected[1])


def test_a_ramp_lowers_the_divergence_that_the_learning_rate_aims_at() -> None:
    data = tiny_mapping()
    ramp = {"set": "algorithm.kl_target", "from": 0.03, "to": 0.01, "steps": 64}
    data["tasks"]["walk"][1]["ramps"] = [ramp]
    preset, targets = preset_from_mapping(data, "p.yaml"), []
    schedule = Schedule(preset, "walk")
    for _ in range(7):
        targets.append(schedule.kl_target)
        schedule.advance(0.0, 0.0)
    usual = float(preset.algorithm.kl_target)
    assert targets == pytest.approx([usual] * 3 + [0.03, 0.02, 0.01, 0.01])


def test_exploration_is_bounded_by_a_ramp_that_leaves_the_environment_alone(
    environment: Environment,
) -> None:
    data = tiny_mapping()
    ramp = {"set": "policy.deviation", "from": 0.8, "to": 0.2, "steps": 64}
    data["tasks"]["walk"][1]["ramps"] = [ramp]
    schedule, bounds = Schedule(preset_from_mapping(data, "p.yaml"), "walk"), []
    before = dict(environment.chunks[0].rewards)
    for _ in range(7):
        schedule.apply(environment)
        bounds.append(schedule.most_deviation)
        schedule.advance(0.0, 0.0)
    assert bounds == pytest.approx([float("inf")] * 3 + [0.8, 0.5, 0.2, 0.2])
    assert environment.chunks[0].rewards == before
