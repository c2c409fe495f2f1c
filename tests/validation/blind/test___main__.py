from __future__ import annotations

from pathlib import Path

import pytest

from hyperleg_design.validation.blind import __main__ as module
from hyperleg_design.validation.blind.plan import PLANTS


def run(monkeypatch, *options: str) -> int:
    monkeypatch.setattr("sys.argv", ["blind", *options])
    return module.main()


def test_options_reach_the_trial_and_the_seal_is_printed(monkeypatch, capsys, tmp_path):
    given = {}

    def made(cases, seed, out, *, say, **options):
        given.update(options, cases=cases, seed=seed, out=out)
        say("abc")

    monkeypatch.setattr(module, "make_here", made)
    folder = tmp_path / "trial"
    options = ("--cases=3", "--seed=7", f"--out={folder}", "--duration", "2", "2.5")
    assert run(monkeypatch, *options) == 0
    assert given == {
        "cases": 3,
        "seed": 7,
        "out": Path(folder),
        "plants": list(PLANTS),
        "workers": 1,
        "progress": False,
        "duration": (2.0, 2.5),
    }
    assert capsys.readouterr().out == "sha256 of the key: abc\n"


def test_bad_input_is_one_line_and_code_2_and_nothing_is_written(monkeypatch, capsys, tmp_path):
    folder = tmp_path / "trial"
    assert run(monkeypatch, "--cases=1", "--seed=1", f"--out={folder}", "--plants", "moon") == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("hyperleg: ")
    assert err.count("\n") == 1
    assert not folder.exists()


def test_a_number_of_cases_is_required(monkeypatch, capsys, tmp_path):
    with pytest.raises(SystemExit) as stopped:
        run(monkeypatch, "--seed=1", f"--out={tmp_path / 'trial'}")
    assert stopped.value.code == 2
    assert "--cases" in capsys.readouterr().err
