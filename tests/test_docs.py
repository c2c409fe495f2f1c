"""The documentation: its tutorials run as they stand, and its pages are all in the navigation."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml

import hyperleg_design
from hyperleg_design import cli

ROOT = Path(hyperleg_design.__file__).resolve().parent.parent
TUTORIALS = sorted((ROOT / "docs" / "tutorials").glob("*.md"))
BLOCK = re.compile(r"^```(\w+)(?: title=\"([^\"]+)\")?\n(.*?)^```", re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", TUTORIALS, ids=lambda page: page.stem)
def test_a_tutorial_runs_as_it_stands(page, tmp_path, monkeypatch, capsys):
    """Files are written, commands and Python run in order, and every line of output appears."""
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    output, shown = "", 0
    for language, title, body in BLOCK.findall(page.read_text(encoding="utf-8")):
        if title:
            Path(title).write_text(body)
        elif language == "bash":
            for line in body.splitlines():
                assert line.startswith("hyperleg "), line
                assert cli.main(line.split()[1:]) == 0, capsys.readouterr().err
        elif language == "python":
            exec(body, names)
        elif language == "text":
            output += capsys.readouterr().out
            for line in body.splitlines():
                assert line in output, f"{line!r} is not in the output"
                shown += 1
    assert shown >= 3


def in_navigation(entries: object) -> set[str]:
    if isinstance(entries, str):
        return {entries}
    inside = entries.values() if isinstance(entries, dict) else entries
    assert not isinstance(inside, str)
    return set().union(*(in_navigation(entry) for entry in inside))  # type: ignore[union-attr]


def test_pages_of_the_navigation_exist_and_have_content():
    text = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    linked = in_navigation(yaml.safe_load(text)["nav"])
    there = {str(page.relative_to(ROOT / "docs")) for page in (ROOT / "docs").rglob("*.md")}
    assert linked <= there
    for page in there:
        assert len((ROOT / "docs" / page).read_text(encoding="utf-8").split()) >= 25, page
