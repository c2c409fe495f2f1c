"""The documentation: its tutorials run as they stand, and its pages are all in the navigation."""

from __future__ import annotations

import re
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml

import hyperleg_design
from hyperleg_design import cli
from hyperleg_design.gap import effects
from hyperleg_design.gap.effects.complete import check_complete
from hyperleg_design.gap.playback.show import show

ROOT = Path(hyperleg_design.__file__).resolve().parent.parent
TUTORIALS = [
    *sorted((ROOT / "docs" / "tutorials").glob("*.md")),
    ROOT / "docs" / "how-to" / "add_a_motor.md",
    ROOT / "docs" / "how-to" / "add_a_robot.md",
    ROOT / "docs" / "how-to" / "define_a_sweep.md",
    ROOT / "docs" / "how-to" / "look_at_a_robot.md",
]
LONG = ("train_and_evaluate", "look_at_a_robot")
"""Pages that take longest, which run among slow tests."""
NUMBER = re.compile(r"\d+(?:\.\d+)?")
AS_EXACT = 0.05
"""Share by which fitted numbers may differ between machines."""
BLOCK = re.compile(r"^```(\w+)(?: title=\"([^\"]+)\")?\n(.*?)^```", re.MULTILINE | re.DOTALL)


def appears(line: str, output: list[str]) -> bool:
    """Whether a line begins a line of the output: its text exactly, its numbers nearly."""
    words, numbers = NUMBER.split(line), [float(v) for v in NUMBER.findall(line)]
    for printed in output:
        there = NUMBER.split(printed)[: len(words)]
        if there[:-1] != words[:-1] or not there[-1].startswith(words[-1]):
            continue
        values = [float(v) for v in NUMBER.findall(printed)[: len(numbers)]]
        if values == pytest.approx(numbers, rel=AS_EXACT):
            return True
    return False


def test_printed_lines_are_compared_with_little_tolerance():
    output = ["  cause friction at elbow: torque 0.248 Nm (0.23 .. 0.26)", "verdict: none"]
    assert appears("  cause friction at elbow: torque 0.245 Nm (0.23 .. 0.26)", output)
    assert appears("verdict: none", output)
    assert not appears("  cause friction at elbow: torque 0.3 Nm (0.23 .. 0.26)", output)
    assert not appears("  cause friction at shoulder: torque 0.248 Nm (0.23 .. 0.26)", output)


@pytest.mark.parametrize(
    "page",
    [pytest.param(page, marks=pytest.mark.slow if page.stem in LONG else ()) for page in TUTORIALS],
    ids=lambda page: page.stem,
)
def test_a_tutorial_runs_as_it_stands(page, tmp_path, monkeypatch, capsys):
    """Files are written, commands and Python run in order, and every line of output appears."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    names: dict[str, object] = {}
    output, shown = "", 0
    for language, title, body in BLOCK.findall(page.read_text(encoding="utf-8")):
        if title:
            Path(title).write_text(body)
        elif language == "bash":
            for line in body.replace("\\\n", " ").splitlines():
                run(line, monkeypatch)
        elif language == "python":
            exec(body, names)
        elif language == "text":
            output += capsys.readouterr().out
            for line in body.splitlines():
                assert appears(line, output.splitlines()), f"{line!r} is not in {output}"
                shown += 1
    assert shown >= 3


def run(line: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A command of a tutorial: `hyperleg VERB ...` or `python FILE ...`.

    It runs in this process, except for `hyperleg train`, which replaces the process that calls it.
    """
    program, *arguments = line.split()
    if arguments[0] == "train":
        pytest.importorskip("rsl_rl")
        call = [sys.executable, "-m", "hyperleg_design.cli", *arguments]
        done = subprocess.run(call, capture_output=True, text=True, check=False)
        assert done.returncode == (3 if "--iterations" in arguments else 0), done.stderr
        print(done.stdout)
    elif program == "python":
        monkeypatch.setattr(sys, "argv", arguments)
        runpy.run_path(arguments[0], run_name="__main__")
    else:
        assert program == "hyperleg", line
        assert cli.main(arguments) == 0, line


def in_navigation(entries: object) -> set[str]:
    if isinstance(entries, str):
        return {entries}
    inside = entries.values() if isinstance(entries, dict) else entries
    assert not isinstance(inside, str)
    return set().union(*(in_navigation(entry) for entry in inside))  # type: ignore[union-attr]


def test_pages_of_the_navigation_exist_and_have_content():
    text = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    linked = in_navigation(yaml.safe_load(text)["nav"])
    docs = ROOT / "docs"
    there = {str(page.relative_to(docs)) for page in docs.rglob("*.md")}
    notebooks = {str(page.relative_to(docs)) for page in docs.rglob("*.ipynb")}
    assert linked == there | notebooks
    for page in there:
        assert len((ROOT / "docs" / page).read_text(encoding="utf-8").split()) >= 25, page


def test_the_effect_that_a_page_adds_is_one(monkeypatch):
    page = (ROOT / "docs" / "how-to" / "add_an_effect.md").read_text()
    (code,) = [text for language, _, text in BLOCK.findall(page) if language == "python"]
    names: dict[str, object] = {"__name__": "air_drag"}
    exec(code, names)
    check_complete(names["AirDrag"])
    for catalogue in (effects.EFFECTS, effects.WEIGHED):
        monkeypatch.setitem(catalogue, "air_drag", names["AirDrag"]())
    shown = show("air_drag")
    assert shown.residual_name == "motion"
    # the residual of a simulation with its hooks is its trace, but for the noise of sensors
    known = np.isfinite(shown.trace) & np.isfinite(shown.residual) & (shown.time > 0.5)
    left = shown.residual[known] - shown.trace[known]
    assert np.sqrt(np.mean(left**2)) < 0.2 * np.sqrt(np.mean(shown.residual[known] ** 2))
