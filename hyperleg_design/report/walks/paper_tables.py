"""A table of the paper beside ours: the numbers, what they say of the toe, and a figure."""

from __future__ import annotations

from typing import Any

from hyperleg_design.report.drawer import Drawer
from hyperleg_design.report.style import later
from hyperleg_design.report.walks.beside_paper import beside, rows_beside_paper, toe_sentence
from hyperleg_design.report.walks.evaluated import Evaluated
from hyperleg_design.report.walks.versus_figures import change_figure


def paper_tables(evaluated: Evaluated, draw: Drawer, table: str) -> list[Any]:
    """Compare policies with one table of the paper.

    Args:
        evaluated: the policies with their trials.
        draw: draws figures into the page's folder.
        table: `Table III` or `Table IV`.

    Returns:
        Content of a page; a sentence where no group has both of the paper's robots.
    """
    tables = {
        name: rows
        for name, rows in rows_beside_paper(evaluated).items()
        if name.split(",")[0] == table
    }
    if not tables:
        return [f"{table} cannot be reproduced yet: no group has both of the paper's robots."]
    content: list[Any] = []
    for name, rows in tables.items():
        content += [*beside(rows, name), toe_sentence(rows)]
    figure = draw(
        table.lower().replace(" ", "_"),
        "Change that the toe makes: ours beside the paper's.",
        later(change_figure, tables),
    )
    return [*content, figure]
