from __future__ import annotations

from hyperleg_design.report.text import table


def test_columns_line_up_and_numbers_stand_to_the_right():
    lines = table(["name", "mass"], [["a", 1.5], ["long name", 12.25]]).splitlines()
    assert lines[2].endswith(" 1.5")
    assert len(lines[2]) == len(lines[3])
    assert lines[3].startswith("long name")


def test_an_empty_table_still_has_its_head():
    assert table(["a", "b"], []).splitlines()[0].split() == ["a", "b"]
