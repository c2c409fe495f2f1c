from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import yaml

from hyperleg_design.learning.campaigns.campaign import load_campaign
from hyperleg_design.learning.campaigns.campaign_status import campaign_status, status_table
from hyperleg_design.simulation.tasks import load_task

from .conftest import DATA


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
