from __future__ import annotations

from hyperleg_design.report.page import Table
from hyperleg_design.report.walks.paper_tables import paper_tables


def test_the_table_that_is_asked_for_is_drawn_with_a_figure_of_its_name(found):
    drawn = []
    content = paper_tables(found, lambda name, *rest: drawn.append(name) or name, "Table III")
    assert isinstance(content[0], Table)
    assert drawn == ["table_iii"]
    assert content[-1] == "table_iii"


def test_a_table_without_both_robots_is_said_to_be_missing(found):
    assert paper_tables(found, None, "Table IV") == [
        "Table IV cannot be reproduced yet: no group has both of the paper's robots."
    ]
