"""The published results: scored by the rules as they stand, and the page shows these numbers."""

from __future__ import annotations

import json

import pytest

from hyperleg_design import resources
from hyperleg_design.validation.benchmark.measures import FAULTS, case_table, table
from hyperleg_design.validation.benchmark.runner import all_cases, scored
from hyperleg_design.validation.benchmark.scoring import VERSION

DOCS = resources.home() / "docs"
PUBLISHED = sorted((DOCS / "benchmark").glob("*.json"))
ROBOTS = {
    "double pendulum": "a0",
    "double pendulum, drawn faults": "drawn",
    "arm of a TIAGo, drawn faults": "tiago",
    "servo XL330 with a pendulum": "xl330",
    "servo arm SO-101": "so101",
    "quadruped Go2 in the air": "go2",
    "two-link arm": "new-two_link",
    "four-joint arm": "new-arm",
    "geared leg": "new-leg",
    "leg with coupled motors": "new-coupled",
    "crane": "new-crane",
    "servo arm, simulated": "new-servos",
}
"""How the page calls a robot, and how the names of its cases begin."""


@pytest.mark.parametrize("path", PUBLISHED, ids=lambda path: path.stem)
def test_published_results_are_scored_by_the_rules_of_this_version_which_only_adds_cases(path):
    content = json.loads(path.read_text())
    assert 1 <= content["version"] <= VERSION
    for row in content["cases"]:
        assert scored(row) == row


@pytest.mark.parametrize("path", PUBLISHED, ids=lambda path: path.stem)
def test_published_cases_are_cases_of_the_benchmark(path):
    cases = {case.name: case for case in all_cases()}
    for row in json.loads(path.read_text())["cases"]:
        case = cases[row["name"]]
        assert (row["suite"], row["split"], row["kind"]) == (case.suite, case.split, case.kind)


def test_the_page_shows_the_table_of_the_baseline_and_nothing_else():
    rows = json.loads((DOCS / "benchmark" / "ae9a218.json").read_text())["cases"]
    page = (DOCS / "benchmark" / "rules.md").read_text()
    assert table(rows) in page
    assert case_table(rows) in page


@pytest.mark.parametrize(
    ("file", "column", "labels"),
    [
        (
            "posterior_development",
            1,
            {"first": "real, faults: right", "probability 0.9": "real, faults: confident"},
        ),
        ("posterior_held_out", 2, {"first": "real, faults: right", "false cause": "... a false"}),
    ],
)
def test_the_first_table_of_the_page_shows_the_published_answers(file, column, labels):
    rows = json.loads((DOCS / "benchmark" / f"{file}.json").read_text())["cases"]
    scored_rows = cells(table(rows))
    shown = cells((DOCS / "benchmark.md").read_text())
    for word, measure in labels.items():
        mine = next(row for row in shown if word in row[0])
        theirs = next(row for row in scored_rows if row[0].startswith(measure))
        assert mine[column] == theirs[column]


def test_the_table_by_robots_shows_the_published_answers():
    rows = [
        row
        for file in ("posterior_development", "posterior_held_out")
        for row in json.loads((DOCS / "benchmark" / f"{file}.json").read_text())["cases"]
    ]
    shown = [row for row in cells((DOCS / "benchmark.md").read_text()) if row[0] in ROBOTS]
    cases = 0
    for robot, split, *shares in shown:
        of_robot = [
            row
            for row in rows
            if row["name"].startswith(f"{ROBOTS[robot]}-") and row["split"] == split
        ]
        faults = [row for row in of_robot if row["kind"] in FAULTS]
        healthy = [row for row in of_robot if row["kind"] == "nothing"]
        outside = [row for row in of_robot if row["kind"] == "outside"]
        assert shares == [
            share(faults, "right", "equivalent"),
            share(healthy, "right"),
            share(healthy, "false cause"),
            share(outside, "right"),
        ]
        cases += len(of_robot)
    assert cases == len(rows)


def share(rows: list[dict], *outcomes: str) -> str:
    """How many of some cases have one of the outcomes, as the page prints it."""
    hits = sum(row["score"]["outcome"] in outcomes for row in rows)
    return f"{hits} of {len(rows)}" if rows else "-"


def cells(text: str) -> list[list[str]]:
    """Rows of the tables of a page."""
    lines = [line for line in text.splitlines() if line.startswith("| ")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
