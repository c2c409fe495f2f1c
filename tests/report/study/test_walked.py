from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.report.page import Explorer, Missing
from hyperleg_design.report.study import walked
from hyperleg_design.sweep.trials.stored import stored_names


@dataclass
class Context:
    """What the section needs of the study's context."""

    folder: Path
    policies: Path | None = None


@pytest.mark.slow
def test_committed_walks_are_shown_and_a_sample_is_run_again(tmp_path):
    section = walked.walked(Context(tmp_path))
    content = section.section.content
    explorers = [item for item in content if isinstance(item, Explorer)]
    assert len(explorers) == len(stored_names()) >= 1
    columns = {column["name"] for column in explorers[0].data["columns"]}
    assert {"reduction", "toe.mass", "walk.cost_of_transport", "walk.fell"} <= columns
    texts = " ".join(item for item in content if isinstance(item, str))
    again = re.search(
        r"(\d+) trials of 3 designs with walk_upright-toe-0. (\d+) ended as then", texts
    )
    assert again
    assert again[1] == "30"
    assert int(again[2]) >= 24  # another processor may tip a few over


def test_without_policies_the_committed_walks_are_shown_and_a_sentence_says_why(tmp_path):
    (tmp_path / "none").mkdir()
    content = walked.walked(Context(tmp_path, tmp_path / "none")).section.content
    assert any(isinstance(item, Explorer) for item in content)
    assert any("Nothing of them was run again" in str(item) for item in content)


def test_walks_of_another_definition_are_not_shown(tmp_path, monkeypatch):
    def refuse(name):
        raise InputError("walked", "", name, "is of another definition")

    monkeypatch.setattr(walked, "stored", refuse)
    section = walked.walked(Context(tmp_path))
    assert all(not isinstance(item, Explorer) for item in section.section.content)
    assert any(isinstance(item, Missing) for item in section.section.content)
    assert section.facts == ()
