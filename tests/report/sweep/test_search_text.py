"""What a search says in a terminal: what failed, and who wins by which values."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from hyperleg_design.report.sweep import search_text
from hyperleg_design.sweep.finalists import Final, Finalist
from hyperleg_design.sweep.search import REASON
from hyperleg_design.sweep.searching.constraint import Constraint


@pytest.fixture
def search(monkeypatch):
    """A search of walks for a low cost; a design may fall in a tenth of its trials."""
    monkeypatch.setattr(search_text, "build_command", lambda sweep, row: f"build {row['sample']}")
    bound = Constraint("walk.fell", 0.1, True)
    return SimpleNamespace(
        sweep=SimpleNamespace(axes=(SimpleNamespace(name="toe.mass"),)),
        objectives=("walk.cost",),
        constraints=(bound,),
        protocols=["walk"],
        plan=SimpleNamespace(protocols=("walk",)),
    )


def row(cost, low=None, high=None, fell=0.0, sample=1):
    values = {"sample": sample, "variant": "toe", "toe.mass": 0.2, "walk.cost": cost}
    return values | {
        "walk.cost.low": low,
        "walk.cost.high": high,
        "walk.fell": fell,
        "walk.policy": "walks-toe-0",
        "walk.trained": "zero-shot",
    }


def trial(state, reason=""):
    attributes = {REASON: reason} if reason else {}
    return SimpleNamespace(state=SimpleNamespace(name=state), user_attrs=attributes)


def test_failures_are_counted_by_reason(search, monkeypatch):
    monkeypatch.setattr(search_text, "found_designs", lambda search, study: [])
    trials = [trial("COMPLETE"), *[trial("FAIL", "falls")] * 2, trial("FAIL", "no robot")]
    lines = search_text.search_text(search, SimpleNamespace(trials=trials)).splitlines()
    assert lines == [
        "1 complete, 3 fail",
        "  failed 2: falls",
        "  failed 1: no robot",
        "no design holds all constraints",
    ]


def test_found_designs_are_rows_in_the_order_that_the_search_gives(search, monkeypatch):
    rows = [row(0.4, sample=7), row(0.5, sample=3)]
    monkeypatch.setattr(search_text, "found_designs", lambda search, study: rows)
    text = search_text.search_text(search, SimpleNamespace(trials=[trial("COMPLETE")]))
    table = text.splitlines()[3:5]
    assert [line.split() for line in table] == [
        ["7", "toe", "0.2", "0.4", "walks-toe-0", "zero-shot"],
        ["3", "toe", "0.2", "0.5", "walks-toe-0", "zero-shot"],
    ]


def test_new_trials_decide_and_overlapping_intervals_are_told(search):
    first = Finalist(1, row(0.30), row(0.42, 0.40, 0.44), None)
    second = Finalist(2, row(0.31), row(0.43, 0.41, 0.45, sample=2), None)
    far = Finalist(3, row(0.32), row(0.60, 0.59, 0.61, sample=3), None)
    text = search_text.final_text(search, Final((first, second, far), (1,), 0))
    assert "winner: design 1, by the values of new trials" in text
    assert "overlaps that of design 2" in text
    assert "design 3: they" not in text
    assert "0.42 (0.4 to 0.44)" in text
    assert "--finetune" in text
    assert text.endswith("build: build 1")


def test_fine_tuned_values_replace_those_of_new_trials(search):
    tuned = Finalist(1, row(0.30), row(0.50), row(0.40, 0.39, 0.41))
    other = Finalist(2, row(0.30), row(0.40), row(0.41, 0.405, 0.42))
    text = search_text.final_text(search, Final((tuned, other), (1, 2), 400_000))
    assert "by the values after fine-tuning" in text
    assert "not beaten in all objectives: 2" in text
    assert "overlaps that of design 2" in text
    assert "--finetune" not in text


def test_measures_without_trials_stand_once(search):
    search.plan.protocols = ()
    first = Finalist(1, row(0.30), row(0.30), None)
    text = search_text.final_text(search, Final((first,), (1,), 0))
    assert "new trials" not in text
    assert text.count("0.3") == 1
    assert "winner: design 1\n" in text


def test_no_finalist_and_no_winner_are_told_apart(search):
    assert "no finalist" in search_text.final_text(search, Final((), (), 0))
    fallen = Finalist(1, row(0.3), row(0.3, fell=0.5), None)
    text = search_text.final_text(search, Final((fallen,), (), 0))
    assert "no winner" in text
    holds = [line.split()[-3] for line in text.splitlines()[2:4]]
    assert holds == ["yes", "no"]
