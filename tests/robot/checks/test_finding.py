from __future__ import annotations

from hyperleg_design.robot.checks.finding import MOST_PLACES, Finding, finding_lines


def test_a_finding_reads_as_one_line():
    assert (
        str(Finding("error", "link foot (line 3)", "mass is -1 kg", "a mass is positive"))
        == "error: link foot (line 3): mass is -1 kg; a mass is positive"
    )


def test_what_is_equally_wrong_at_several_places_stands_once():
    wide = [Finding("error", f"joint {i}", "is too wide", "narrow it") for i in range(12)]
    lines = finding_lines([wide[0], Finding("warning", "link a", "is odd"), *wide[1:]])
    assert lines[1] == "warning: link a: is odd"
    assert lines[0].startswith("error: joint 0, joint 1, ")
    assert lines[0].endswith(f"and {12 - MOST_PLACES} more: is too wide; narrow it")
