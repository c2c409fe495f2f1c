"""The frozen benchmark from the command line."""

from __future__ import annotations

from pathlib import Path

import pytest

from hyperleg_design import cli


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = cli.main(list(arguments))
    out, err = capsys.readouterr()
    return code, out, err


def test_validate_lists_its_cases_and_skips_those_whose_logs_are_absent(capsys, tmp_path: Path):
    code, out, _ = run(capsys, "validate", "--list-cases", "--suites", "blind", "newcomers")
    assert code == 0
    assert "blind-000" in out
    assert "new-two_link" in out
    code, out, _ = run(
        capsys, "validate", "--only", "go2", "--data", str(tmp_path), "--out", str(tmp_path / "o")
    )
    assert code == 0
    assert "Skipped: 4 cases of go2_air" in out
    code, _, error = run(capsys, "validate", "--only", "nothing_like_it")
    assert code == 2
    assert "fits no case" in error
