from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("torch")
pytest.importorskip("rsl_rl")

from hyperleg_design.learning.launch import surroundings


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
