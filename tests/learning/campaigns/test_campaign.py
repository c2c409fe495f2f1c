from __future__ import annotations

import pytest
import yaml

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.plans.analysis_plan import load_plan
from hyperleg_design.evaluation.policy_choice import ONLY_STARTS
from hyperleg_design.evaluation.protocol import load_protocol
from hyperleg_design.learning.campaigns.campaign import load_campaign, shipped_starts
from hyperleg_design.simulation.tasks import load_task

from .conftest import DATA


def test_the_shipped_campaign_has_the_seeds_that_its_plan_asks_for() -> None:
    campaign, plan = load_campaign(), load_plan()
    assert campaign.ship == {"walk_guided": "last", "walk_upright": "all"}
    for design in plan.designs:
        seeds = {r.seed for r in campaign.runs if (r.group, r.design) == ("walk_upright", design)}
        assert len(seeds) >= plan.seeds["walk"]
    assert [r.seed for r in campaign.runs] == sorted(r.seed for r in campaign.runs)
    assert len({r.name for r in campaign.runs}) == len(campaign.runs)


@pytest.mark.parametrize(
    ("name", "preset"), [("campaign", "study"), ("campaign_rewards", "rewards")]
)
def test_what_is_compared_starts_alike(name: str, preset: str) -> None:
    """Equal budgets and stages for all that are compared."""
    runs = load_campaign(name).runs
    assert {(r.preset, r.start) for r in runs if r.compared} == {(preset, "walk_guided")}
    assert {(r.preset, r.start, r.task) for r in runs if not r.compared} == {
        ("guided", "", "walk_guided")
    }


def test_the_rewards_are_switched_one_at_a_time() -> None:
    runs = load_campaign("campaign_rewards").runs
    for group in ("walk_free", "walk_clock", "walk_power", "walk_force"):
        arms = {(r.design, r.seed) for r in runs if r.group == group}
        assert arms == {(d, s) for d in ("toe", "toe_removed_matched") for s in range(3)}


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"preset": "desktop"}, "preset"),
        ({"groups": [{**DATA["groups"][0], "preset": "desktop"}]}, "groups.0.preset"),
        ({"runs": 3}, "runs"),
        ({"processes": 0}, "processes"),
        ({"groups": []}, "groups"),
        ({"groups": [{**DATA["groups"][0], "compared": "no"}]}, "groups.0.compared"),
        ({"groups": [{**DATA["groups"][0], "ship": "some"}]}, "groups.0.ship"),
        ({"groups": [{"name": "a", "task": "walk", "designs": ["toe"]}]}, "groups.0.seeds"),
        (
            {"groups": [{"name": "a", "task": "walk", "designs": ["toes"], "seeds": 1}]},
            "groups.0.designs",
        ),
        (
            {"groups": [{"name": "a", "task": "swim", "designs": ["toe"], "seeds": 1}]},
            "groups.0.task",
        ),
        (
            {"groups": [{"name": "a", "task": "goal_paper", "designs": ["toe"], "seeds": 1}]},
            "tasks",
        ),
        ({"groups": [DATA["groups"][0], DATA["groups"][0]]}, "groups.1.name"),
        ({"groups": [{**DATA["groups"][0], "name": "my-walk"}]}, "groups.0.name"),
    ],
)
def test_bad_campaigns(change: dict, field: str, write) -> None:
    with pytest.raises(InputError) as caught:
        load_campaign(write("c.yaml", yaml.safe_dump({**DATA, **change})))
    assert caught.value.field == field


def test_the_t_tests_of_the_fair_study_are_those_of_the_plan() -> None:
    runs, plan = load_campaign("campaign_t_test").runs, load_plan()
    assert {run.design for run in runs} == set(plan.designs)
    assert len(runs) == 5 * len(plan.designs) * plan.seeds["t_test"]
    assert {(r.task, r.preset, r.start) for r in runs if not r.compared} == {
        ("walk_guided", "guided", ""),
        ("walk_upright", "study", "walk_guided"),
        ("t_test_guided", "t_test_guided", "walk_upright"),
        ("t_test_free", "t_test", "t_test_guided"),
    }
    assert {(r.task, r.preset, r.start) for r in runs if r.compared} == {
        ("t_test_free", "t_test_course", "t_test_first")
    }
    assert load_protocol("t_test_fast").speed_cap == load_task("t_test_free").commands.speed_cap


def test_a_start_is_compared_in_no_shipped_campaign() -> None:
    starts = shipped_starts()
    assert starts == {"walk_guided", "t_test_guided", "t_test_first"}
    assert all(group.endswith(ONLY_STARTS) for group in starts)  # by which evaluation knows them
