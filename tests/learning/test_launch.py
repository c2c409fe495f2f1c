from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from hyperleg_design.learning import launch


def test_surroundings_keep_what_is_there_and_set_threads_and_malloc(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("HYPERLEG_TEST", "kept")
    found = launch.surroundings(3)
    assert found["HYPERLEG_TEST"] == "kept"
    assert {found[name] for name in launch.THREADS} == {"3"}
    assert found["MALLOC_ARENA_MAX"] == "2"
    assert "MALLOC_ARENA_MAX" not in os.environ or os.environ["MALLOC_ARENA_MAX"] == "2"


@pytest.mark.slow
def test_errors_come_out_as_one_line_with_their_own_status(tmp_path: Path) -> None:
    pytest.importorskip("torch")
    pytest.importorskip("rsl_rl")
    command = launch.command(
        {"task": "swim", "design": "toe", "seed": 0, "preset": "laptop", "out": tmp_path / "run"}
    )
    assert command[0] == sys.executable
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "swim" in done.stderr
    assert not (tmp_path / "run").exists()
