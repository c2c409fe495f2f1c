"""The verb variants: what it prints and writes agrees, and bad input leaves no folder behind."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import pytest
import yaml

from hyperleg_design import cli
from hyperleg_design.robot.load import load_robot
from hyperleg_design.simulation.design_spread import DesignSpread

POLICY, OTHER = "walk_upright-toe-0", "walk_upright-toe-1"
SPREAD = {"ranges": {"toe.mass": {"low": 0.1, "high": 0.4}}, "pool": 4, "held_out": 2}
SHORT = {
    "kind": "walk",
    "trials": 2,
    "distance": 0.5,
    "time_limit": 1.0,
    "steady": {"begin": 0.1, "end": 0.5},
}


@pytest.fixture
def arguments(tmp_path: Path) -> list[str]:
    """Two held-out designs, walks of half a metre, and a folder to write to."""
    (tmp_path / "toes.yaml").write_text(yaml.safe_dump(SPREAD))
    (tmp_path / "short.yaml").write_text(yaml.safe_dump(SHORT))
    files = ["--designs", str(tmp_path / "toes.yaml"), "--protocol", str(tmp_path / "short.yaml")]
    return [*files, "--out", str(tmp_path / "out")]


def test_tables_json_and_files_say_the_same(arguments, tmp_path, capsys, monkeypatch):
    draws = []
    draw = DesignSpread.held_out_designs
    monkeypatch.setattr(
        DesignSpread, "held_out_designs", lambda *args: draws.append(args) or draw(*args)
    )
    assert cli.main(["variants", POLICY, POLICY, *arguments, "--json"]) == 0
    assert len(draws) == 1
    printed = json.loads(capsys.readouterr().out)
    rows = pd.read_csv(tmp_path / "out" / "held_out.csv")
    assert rows["design"].tolist() == [0, 1, 0, 1]
    assert [row["arrived"] for row in printed["rows"]] == rows["arrived"].tolist()
    for number in (0, 1):
        written = load_robot(tmp_path / "out" / str(number) / "design.yaml")
        assert rows["toe.mass"][number] == pytest.approx(float(written["toe.mass"]), rel=1e-12)
    (comparison,) = printed["comparisons"]
    assert comparison["more_falls"] == 0.0
    assert (comparison["cost_ratio"] is None) == (comparison["designs"] < 2)


def test_the_printed_comparison_says_which_policy_is_compared_with_which(arguments, capsys):
    assert cli.main(["variants", POLICY, OTHER, *arguments]) == 0
    *_, said, below, heads, row, _ = capsys.readouterr().out.splitlines()
    assert said.startswith("Each policy is compared with the one under `against`")
    assert below.endswith("more_falls below 0 that it falls in fewer trials.")
    assert heads.split()[:2] == ["policy", "against"]
    assert row.split()[:2] == [POLICY, OTHER]


@pytest.mark.parametrize(
    ("policies", "words"),
    [
        (["walk_upright-toe-99"], "walk_upright-toe-99"),
        (["runs/{}/policy.onnx"], "one policy for all designs"),
    ],
)
def test_nothing_is_written_where_no_policy_is_judged(policies, words, arguments, tmp_path, capsys):
    assert cli.main(["variants", *policies, *arguments]) == 2
    assert words in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_folder_of_somebody_elses_files_is_left_alone(arguments, tmp_path, capsys):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "thesis.txt").write_text("years of work")
    assert cli.main(["variants", POLICY, *arguments]) == 2
    assert "out" in capsys.readouterr().err
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["thesis.txt"]
