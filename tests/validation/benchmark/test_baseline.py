"""The published results: scored by the rules as they stand, and the page shows these numbers."""

from __future__ import annotations

import json

import pytest

from hyperleg_design import resources
from hyperleg_design.validation.benchmark.measures import case_table, table
from hyperleg_design.validation.benchmark.runner import all_cases, scored
from hyperleg_design.validation.benchmark.scoring import VERSION

DOCS = resources.home() / "docs"
PUBLISHED = sorted((DOCS / "benchmark").glob("*.json"))


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


def cells(text: str) -> list[list[str]]:
    """Rows of the tables of a page."""
    lines = [line for line in text.splitlines() if line.startswith("| ")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
