from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("torch")
pytest.importorskip("rsl_rl")

from hyperleg_design.learning.__main__ import main
from hyperleg_design.learning.launch import surroundings


def test_changes_of_the_robot_reach_the_training(tmp_path: Path, monkeypatch) -> None:
    given = {}

    def trained(*positional, **named):
        given.update(named, design=positional[1])
        return True

    monkeypatch.setattr("hyperleg_design.learning.train.train", trained)
    changes = ["--set=toe.mass=0.5", "--set=thigh.length=0.4", "--set-file=lighter.yaml"]
    assert main([*changes, f"--out={tmp_path}"]) == 0
    assert given["design"] == "toe"
    assert given["overrides"] == ["toe.mass=0.5", "thigh.length=0.4"]
    assert given["overlays"] == ["lighter.yaml"]


def test_bad_input_is_one_line_and_status_two(tmp_path: Path) -> None:
    call = [
        sys.executable,
        "-m",
        "hyperleg_design.learning",
        "--design=wheels",
        f"--out={tmp_path / 'a'}",
    ]
    done = subprocess.run(call, env=surroundings(), capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "wheels" in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "a").exists()
