from __future__ import annotations

import json
import re

import pandas as pd
import pytest

from hyperleg_design import cli
from hyperleg_design.report.sweep.trials import differing_first

SWEEP = """
design: hyperleg
sampling: grid
measures: [total_mass]
evaluate: [walk]
axes:
  toe.mass: {values: [0.2, 0.5]}
  leg length: {paths: [thigh.length, shank.length], scale: [0.3, 1.0]}
objectives: [total_mass, cost_of_transport]
"""
PROTOCOL = """
kind: walk
name: short
trials: 2
distance: 0.6
time_limit: 2.0
steady: {begin: 0.3}
"""


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """Folder of an evaluated sweep, from the command line."""
    folder = tmp_path_factory.mktemp("ran")
    (folder / "mine.yaml").write_text(SWEEP)
    (folder / "short.yaml").write_text(PROTOCOL)
    arguments = ["sweep", "run", str(folder / "mine.yaml"), "--seeds", "2", "--json"]
    out = ["--out", str(folder / "out")]
    assert cli.main([*arguments, "--evaluate", str(folder / "short.yaml"), *out]) == 0
    return folder / "out"


def test_the_page_shows_policies_limits_sensitivities_front_and_best(ran):
    page = (ran / "index.html").read_text()
    for words in (
        "zero-shot",
        "lower than a fall",
        "walk_upright-toe-0",
        "best on designs",
        "Limits that act",
        "Which parameter each measure follows",
        "Pareto front",
        "hyperleg build --design hyperleg",
        'id="evaluated"',
    ):
        assert words in page


def test_tables_hold_every_design(ran):
    designs = pd.read_parquet(ran / "evaluated.parquet").set_index("sample")
    assert len(designs) == 4
    assert (designs["walk.trials"] == [0, 1, 0, 1]).all()  # one of two trials chose the policy
    assert set(designs["walk.policy"].dropna()) <= {"walk_upright-toe-0", "walk_upright-toe-1"}
    assert designs.loc[3, "total_mass"] > designs.loc[1, "total_mass"]
    found = json.loads((ran / "evaluated.json").read_text())
    assert found["objectives"] == ["total_mass", "walk.cost_of_transport"]
    assert found["policies"][0]["designs"] == 2
    best = found["best"][0]
    assert best["walk.policy"] == designs.loc[best["sample"], "walk.policy"]


def test_a_page_opens_on_a_measure_in_which_designs_differ():
    walked = pd.DataFrame({"arrived": [1.0, 1.0, None], "fell": 0.0, "cost": [0.5, 0.4, None]})
    assert differing_first(walked, ["arrived", "fell", "cost"]) == ["cost", "arrived", "fell"]
    walked.loc[1, "arrived"] = 0.8
    assert differing_first(walked, ["arrived", "fell", "cost"]) == ["arrived", "cost", "fell"]


def test_the_views_of_the_page_begin_with_what_differs(ran):
    page, designs = (ran / "index.html").read_text(), pd.read_parquet(ran / "evaluated.parquet")
    first = re.search(r'"views": \[\{[^}]*"y": "([^"]+)"', page)
    assert first is not None
    assert designs["walk.arrived"].nunique() == 1
    assert designs[first[1]].nunique() > 1


def test_an_objective_that_no_protocol_gives_is_one_clear_error(ran, tmp_path, capsys):
    (tmp_path / "bad.yaml").write_text(SWEEP.replace("evaluate: [walk]\n", ""))
    assert cli.main(["sweep", "run", str(tmp_path / "bad.yaml"), "--out", str(tmp_path / "o")]) == 2
    assert "--evaluate" in capsys.readouterr().err
    assert not (tmp_path / "o").exists()
