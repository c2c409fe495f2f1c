from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from hyperleg_design import processes
from hyperleg_design.errors import InputError, OutputError
from hyperleg_design.evaluation.plans.analysis_plan import load_plan
from hyperleg_design.evaluation.policy_choice import GUIDED
from hyperleg_design.evaluation.protocol import load_protocol
from hyperleg_design.learning import campaign as module
from hyperleg_design.learning.campaign import (
    campaign_status,
    load_campaign,
    run_campaign,
    status_table,
)
from hyperleg_design.simulation.tasks import load_task

from .conftest import tiny_mapping

DATA = {
    "name": "mine",
    "preset": "laptop",
    "groups": [{"name": "walk", "task": "walk", "designs": ["toe", "toe_removed"], "seeds": 2}],
}


@pytest.fixture(autouse=True)
def nothing_shipped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "shipped_folder", lambda: tmp_path / "policies")


def test_the_shipped_campaign_has_the_seeds_that_its_plan_asks_for() -> None:
    campaign, plan = load_campaign(), load_plan()
    assert campaign.ship == {"walk_guided": "last", "walk_upright": "all"}
    for design in plan.designs:
        seeds = {r.seed for r in campaign.runs if (r.group, r.design) == ("walk_upright", design)}
        assert len(seeds) >= plan.seeds["walk"]
    assert [r.seed for r in campaign.runs] == sorted(r.seed for r in campaign.runs)
    assert len({r.name for r in campaign.runs}) == len(campaign.runs)


@pytest.mark.parametrize("name", ["campaign", "campaign_rewards"])
def test_what_is_compared_starts_alike(name: str) -> None:
    """Equal budgets and stages for all that are compared."""
    runs = load_campaign(name).runs
    assert {(r.preset, r.start) for r in runs if r.compared} == {("study", "walk_guided")}
    assert {(r.preset, r.start, r.task) for r in runs if not r.compared} == {
        ("guided", "", "walk_guided")
    }


def test_the_rewards_are_switched_one_at_a_time() -> None:
    runs = load_campaign("campaign_rewards").runs
    for group in ("walk_clock", "walk_power", "walk_force"):
        arms = {(r.design, r.seed) for r in runs if r.group == group}
        assert arms == {(d, s) for d in ("toe", "toe_removed_matched") for s in range(3)}


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"preset": "desktop"}, ""),
        ({"groups": [{**DATA["groups"][0], "preset": "desktop"}]}, ""),
        ({"runs": 3}, "runs"),
        ({"processes": 0}, "processes"),
        ({"groups": []}, "groups"),
        ({"groups": [{**DATA["groups"][0], "compared": "no"}]}, "groups.0.compared"),
        ({"groups": [{**DATA["groups"][0], "ship": "some"}]}, "groups.0.ship"),
        ({"groups": [{"name": "a", "task": "walk", "designs": ["toe"]}]}, "groups.0.seeds"),
        ({"groups": [{"name": "a", "task": "walk", "designs": ["toes"], "seeds": 1}]}, ""),
        ({"groups": [{"name": "a", "task": "swim", "designs": ["toe"], "seeds": 1}]}, ""),
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


def test_status_of_each_training(write, tmp_path: Path) -> None:
    campaign = load_campaign(write("c.yaml", yaml.safe_dump(DATA)))
    out = tmp_path / "out"
    assert {s.state for s in campaign_status(campaign, out)} == {"missing"}
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    for run, status in zip(
        campaign.runs,
        ({"pid": 1, "done": False}, {"pid": gone.pid, "done": False}, {"pid": None, "done": True}),
        strict=False,
    ):
        (out / run.name).mkdir(parents=True)
        (out / run.name / "status.json").write_text(
            json.dumps({"steps": 2e6, "speed": 1.3, "left": 60.0, **status})
        )
    (out / campaign.runs[2].name / "policy.onnx").write_bytes(b"x")
    statuses = campaign_status(campaign, out)
    assert [s.state for s in statuses][1:] == ["stopped", "done", "missing"]
    table = status_table(statuses).splitlines()
    assert len(table) == 1 + 4 + 1
    assert table[-1].startswith("1 of 4 done; ")
    assert "1.30" in table[1]


def test_the_t_tests_of_the_fair_study_are_those_of_the_plan() -> None:
    runs, plan = load_campaign("campaign_t_test").runs, load_plan()
    assert {run.design for run in runs} == set(plan.designs)
    assert len(runs) == 4 * len(plan.designs) * plan.seeds["t_test"]
    assert {(r.task, r.preset, r.start) for r in runs if not r.compared} == {
        ("walk_guided", "guided", ""),
        ("walk_upright", "study", "walk_guided"),
        ("t_test_guided", "t_test_guided", "walk_upright"),
    }
    assert {(r.task, r.preset, r.start) for r in runs if r.compared} == {
        ("t_test_free", "t_test", "t_test_guided")
    }
    assert load_protocol("t_test_fast").speed_cap == load_task("t_test_free").commands.speed_cap


def test_a_start_is_compared_in_no_shipped_campaign() -> None:
    starts = module.shipped_starts()
    assert starts == {"walk_guided", "t_test_guided"}
    assert all(group.endswith(GUIDED) for group in starts)  # by which evaluation knows them


def test_a_start_is_unneeded_once_all_that_start_from_it_are_finished(
    write, tmp_path: Path
) -> None:
    groups = [
        {"name": "first", "task": "walk", "designs": ["toe"], "seeds": 2, "compared": False},
        {"name": "second", "task": "walk", "designs": ["toe"], "seeds": 2, "start": "first"},
        {"name": "third", "task": "walk", "designs": ["toe"], "seeds": 1, "start": "first"},
        {"name": "alone", "task": "walk", "designs": ["toe"], "seeds": 1, "compared": False},
    ]
    campaign = load_campaign(write("c.yaml", yaml.safe_dump({**DATA, "groups": groups})))

    def finish(name: str) -> dict[str, str]:
        (tmp_path / name).mkdir()
        (tmp_path / name / "status.json").write_text(json.dumps({"done": True, "steps": 1.0}))
        (tmp_path / name / "policy.onnx").write_bytes(b"x")
        return {s.run.name: s.state for s in campaign_status(campaign, tmp_path)}

    assert finish("second-toe-0")["first-toe-0"] == "missing"
    states = finish("third-toe-0")
    assert states["first-toe-0"] == "unneeded"
    assert states["first-toe-1"] == "missing"
    assert states["alone-toe-0"] == "missing"  # nothing starts from it
    assert finish("first-toe-0")["first-toe-0"] == "done"


def test_foreign_folders_stay(write, tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "thesis.tex").write_text("years of work")
    with pytest.raises(OutputError):
        run_campaign(load_campaign(write("c.yaml", yaml.safe_dump(DATA))), tmp_path / "out")


def test_trains_what_is_missing_with_processes_of_its_own(
    write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("torch")
    pytest.importorskip("rsl_rl")
    pytest.importorskip("tensorboard")
    monkeypatch.setattr(processes, "POLL", 0.1)
    tiny = tiny_mapping()
    tiny["tasks"]["walk"] = [{"name": "all", "steps": 64}]
    preset = write("tiny.yaml", yaml.safe_dump(tiny))
    data = {
        **DATA,
        "preset": str(preset),
        "groups": [{**DATA["groups"][0], "designs": ["toe"], "seeds": 1}],
    }
    campaign = load_campaign(write("c.yaml", yaml.safe_dump(data)))
    shown: list[str] = []
    assert run_campaign(campaign, tmp_path / "out", processes=2, show=shown.append)
    assert shown[-1].splitlines()[-1].startswith("1 of 1 done")
    before = {p: p.stat().st_mtime_ns for p in (tmp_path / "out").glob("*/policy.onnx")}
    assert len(before) == 1
    assert run_campaign(campaign, tmp_path / "out")
    assert {p: p.stat().st_mtime_ns for p in before} == before


def test_a_failed_training_is_reported(
    write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(processes, "POLL", 0.05)
    monkeypatch.setattr(
        module.launch,
        "command",
        lambda arguments: [sys.executable, "-c", "raise SystemExit('no such luck')"],
    )
    campaign = load_campaign(write("c.yaml", yaml.safe_dump(DATA)))
    shown: list[str] = []
    assert not run_campaign(campaign, tmp_path / "out", show=shown.append)
    assert sum("failed" in text for text in shown) == 4
    assert "no such luck" in (tmp_path / "out" / campaign.runs[0].name / module.LOG).read_text()


def test_an_interrupt_stops_the_trainings(
    write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    started: list[subprocess.Popen] = []

    def start(arguments: dict, log: Path) -> subprocess.Popen:
        started.append(subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"]))
        return started[-1]

    monkeypatch.setattr(module.launch, "start", start)
    monkeypatch.setattr(
        processes.time, "sleep", lambda seconds: (_ for _ in ()).throw(KeyboardInterrupt)
    )
    assert not run_campaign(load_campaign(write("c.yaml", yaml.safe_dump(DATA))), tmp_path / "out")
    assert [p.poll() for p in started] == [-signal.SIGTERM] * 2


def test_a_shipped_policy_counts_as_long_as_nothing_it_rests_on_has_changed(
    tmp_path: Path, write
) -> None:
    from hyperleg_design.learning.preset_file import load_preset
    from hyperleg_design.learning.resolved import preset_mapping, task_mapping
    from hyperleg_design.robot.design import load_design

    campaign = load_campaign(write("mine.yaml", yaml.safe_dump(DATA)))
    assert {s.state for s in campaign_status(campaign, tmp_path / "out")} == {"missing"}
    place = tmp_path / "policies" / "walk-toe-1"
    place.mkdir(parents=True)
    (place / "policy.onnx").touch()
    told = {
        "task": task_mapping(load_task("walk")),
        "design": load_design("toe").to_mapping(),
        "seed": 1,
    }
    told["preset"] = preset_mapping(load_preset("laptop"), "walk")
    (place / "run.json").write_text(json.dumps(told))
    states = {s.run.name: s.state for s in campaign_status(campaign, tmp_path / "out")}
    assert states.pop("walk-toe-1") == "shipped"
    assert set(states.values()) == {"missing"}
    told["task"]["rewards"]["flight"]["weight"] = -1.0
    (place / "run.json").write_text(json.dumps(told))
    assert {s.state for s in campaign_status(campaign, tmp_path / "out")} == {"missing"}
