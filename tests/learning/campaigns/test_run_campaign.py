from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from hyperleg_design import processes
from hyperleg_design.errors import OutputError
from hyperleg_design.learning.campaigns import run_campaign as module
from hyperleg_design.learning.campaigns.campaign import load_campaign
from hyperleg_design.learning.campaigns.run_campaign import run_campaign

from ..conftest import tiny_mapping
from .conftest import DATA


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
