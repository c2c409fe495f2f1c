"""The verb search: it goes on where it stopped, and its answer is that of all its designs."""

from __future__ import annotations

import json
from pathlib import Path

import optuna
import pytest
import yaml

from hyperleg_design import cli

SPACE = {
    "design": "hyperleg",
    "sampling": "sobol",
    "count": 1,
    "seed": 3,
    "measures": ["total_mass", "push_off_use"],
    "objectives": ["total_mass"],
    "axes": {
        "toe.mass": {"low": 0.05, "high": 1.0, "log": True},
        "knee": {"paths": ["transmission.scale.knee"], "scale": {"low": 0.5, "high": 2.0}},
    },
}


@pytest.fixture
def search(tmp_path: Path, capsys):
    """Runs the verb on a small space; returns its exit code and what it printed."""
    (tmp_path / "space.yaml").write_text(yaml.safe_dump(SPACE))

    def run(*arguments: str, out: str = "out") -> tuple[int, str, str]:
        command = ["search", str(tmp_path / "space.yaml"), "--out", str(tmp_path / out)]
        return cli.main([*command, *arguments]), *capsys.readouterr()

    return run


def test_a_second_run_adds_what_is_left_and_answers_for_all(search, tmp_path):
    bound = ("--constraint", "push_off_use<=1.5", "--batch", "4", "--json")
    code, out, _ = search("--trials", "4", *bound)
    assert code == 0
    assert json.loads(out)["trials"] == 4
    code, out, _ = search("--trials", "8", *bound)
    assert code == 0
    answer = json.loads(out)
    assert answer["trials"] == 8
    (database,) = (tmp_path / "out").glob("*.db")
    (study,) = optuna.get_all_study_summaries(f"sqlite:///{database}")
    assert study.n_trials == 8
    lightest = min(answer["front"], key=lambda row: row["total_mass"])
    assert lightest["push_off_use"] <= 1.5
    final = answer["final"]
    assert len(final["finalists"]) <= 3
    winner = next(f for f in final["finalists"] if f["number"] == final["winners"][0])
    assert winner["searched"]["total_mass"] == pytest.approx(lightest["total_mass"])


def test_the_text_names_the_winner_unless_there_are_no_finalists(search):
    bound = ("--trials", "3", "--constraint", "total_mass<=99")
    assert "winner: design" in search(*bound)[1]
    code, out, _ = search(*bound, "--finalists", "0", out="none")
    assert code == 0
    assert "candidates" in out
    assert "winner" not in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--objective", "cost_of_transport"), "--evaluate"),
        (("--objective", "beauty"), "beauty"),
        (("--constraint", "total_mass<"), "total_mass<"),
        (("--finetune", "1000"), "needs a protocol"),
        (("--trials", "0"), "at least 1"),
        (("--scheduler", "nowhere"), "nowhere"),
    ],
)
def test_bad_input_is_told_before_anything_is_written(search, tmp_path, arguments, words):
    code, _, err = search(*arguments)
    assert code == 2
    assert words in err
    assert not (tmp_path / "out").exists()
