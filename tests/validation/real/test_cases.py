"""The list of cases on real logs: unique names, the stated split, and where logs are looked for."""

from __future__ import annotations

from pathlib import Path

from hyperleg_design import resources
from hyperleg_design.validation.real.cases import DATA, data_folder, real_cases


def test_names_are_unique_and_every_case_says_which_logs_it_needs():
    cases = real_cases()
    assert len({case.name for case in cases}) == len(cases)
    assert {case.suite for case in cases} == {"real"}
    assert all(case.needs and case.about for case in cases)


def test_two_robots_are_held_out_as_wholes_and_two_in_part():
    splits = {}
    for case in real_cases():
        splits.setdefault(case.needs.split("/")[0], set()).add(case.split)
    both = {robot for robot, split in splits.items() if split == {"development", "held out"}}
    assert len(splits) == 4
    assert len(both) == 2
    assert all(split == {"held out"} for robot, split in splits.items() if robot not in both)


def test_logs_lie_where_the_environment_says_else_beside_the_checkout(monkeypatch, tmp_path):
    monkeypatch.setenv(DATA, str(tmp_path))
    assert data_folder() == tmp_path
    monkeypatch.setenv(DATA, "")
    assert data_folder() == Path(resources.home()).parent / "shared" / "data"
