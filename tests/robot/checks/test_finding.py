from __future__ import annotations

from hyperleg_design.robot.checks.finding import Finding


def test_a_finding_reads_as_one_line():
    assert (
        str(Finding("error", "link foot (line 3)", "mass is -1 kg", "a mass is positive"))
        == "error: link foot (line 3): mass is -1 kg; a mass is positive"
    )
