"""Modules that docstrings and pages name are there."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import hyperleg_design

PACKAGE = Path(hyperleg_design.__file__).parent
ROOT = PACKAGE.parent
ROOMS = "|".join(sorted(path.name for path in PACKAGE.iterdir() if (path / "__init__.py").exists()))
DOTTED = re.compile(rf"`(?:hyperleg_design\.)?((?:{ROOMS})(?:\.\w+)+)`")
"""A module of a room, or a name in it, such as `robot.design.load_design`."""
FILE = re.compile(r"`([\w/]+/\w+\.py)`")
FILES = (".json", ".xacro", ".xml", ".yaml")
"""Endings of names of files, which may begin as a room's does."""
PAST = ("history.md", "rules.md", "earlier_trials.md", "posterior_trials.md")
"""Pages on earlier versions."""
PAGES = [
    *(page for page in sorted((ROOT / "docs").rglob("*.md")) if page.name not in PAST),
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "TRAINING.md")),
]


SOURCES = [
    f"/{path.relative_to(ROOT).as_posix()}"
    for folder in ("benchmarks", "examples", PACKAGE.name, "tests")
    for path in (ROOT / folder).rglob("*.py")
]


def is_there(dotted: str) -> bool:
    """Whether the longest part of a name that is a package or module has the rest as a word."""
    parts = dotted.split(".")
    for count in range(len(parts), 0, -1):
        path = PACKAGE.joinpath(*parts[:count])
        if path.is_dir() and count == len(parts):
            return True
        for module in (path.with_suffix(".py"), path / "__init__.py"):
            if module.exists():
                rest = parts[count : count + 1]
                return not rest or bool(re.search(rf"\b{rest[0]}\b", module.read_text()))
    return False


def wrong_names(path: Path) -> Iterator[str]:
    text = path.read_text(encoding="utf-8")
    names = (name for name in DOTTED.findall(text) if not name.endswith(FILES))
    yield from (name for name in names if not is_there(name))


def test_modules_that_the_package_names_are_there():
    wrong = {path.name: names for path in PACKAGE.rglob("*.py") if (names := [*wrong_names(path)])}
    assert not wrong


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_modules_and_files_that_a_page_names_are_there(page):
    named = FILE.findall(page.read_text(encoding="utf-8"))
    assert [*wrong_names(page)] == []
    assert [name for name in named if not any(file.endswith(f"/{name}") for file in SOURCES)] == []


def test_wrong_names_are_seen():
    assert is_there("robot.design.load_design")
    assert is_there("gap.effects")
    assert not is_there("robot.tree_design.TreeDesign")
