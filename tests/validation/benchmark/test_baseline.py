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
    page = (DOCS / "benchmark.md").read_text()
    assert table(rows) in page
    assert case_table(rows) in page
