"""The page of one sweep, and the same content for the study."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.report.page import Details, Explorer, Page, Section, Table, render
from hyperleg_design.report.sweep.explorer import explorer
from hyperleg_design.report.sweep.rows import fronts_of, without_variants
from hyperleg_design.sweep.measuring import measures
from hyperleg_design.writing import write_text

if TYPE_CHECKING:
    from hyperleg_design.sweep.run import SweepResult


def sweep_content(result: SweepResult, name: str = "designs") -> list[Any]:
    """Write what a page shows of a sweep.

    Args:
        result: the finished sweep.
        name: of the sweep's explorer, unique in the page.

    Returns:
        Texts, tables and figures.
    """
    summary = result.summary
    content: list[Any] = [summary["description"], _axes_text(result)]
    if summary["rejected"]:
        reasons = "; ".join(
            f"{count} because {reason}" for reason, count in summary["rejected_because"].items()
        )
        content.append(
            f"{summary['rejected']} of {summary['designs']} combinations make no robot: {reasons}."
        )
    content.append(_explorer(result, name))
    rows = []
    for variant, ranges in summary["range"].items():
        base = summary["base"].get(variant, {})
        rows += [
            [variant, measures.label(column), base.get(column), *values]
            for column, values in ranges.items()
        ]
    heads = ["variant", "measure", "unchanged design", "smallest", "median", "largest"]
    table = Table(*without_variants(heads, rows))
    content.append(Details("Ranges of all measures", [table]))
    return content


def _explorer(result: SweepResult, name: str) -> Explorer:
    """All designs but rejected ones, with the measures that the sweep draws or aims at."""
    sweep = result.sweep
    wanted = dict.fromkeys((*sweep.objectives, *(chosen.measure for chosen in sweep.maps)))
    measured = (column for ranges in result.summary["range"].values() for column in ranges)
    columns = list(wanted or dict.fromkeys(measured))
    names = ["variant", "rejected", *(axis.name for axis in sweep.axes), *columns]
    table = result.columns(names)
    front = np.zeros(len(table["variant"]), bool)
    if len(sweep.objectives) > 1:
        for rows in fronts_of(result)[1].values():
            front[rows] = True
    robots = table["rejected"] == ""
    table, front = {name: values[robots] for name, values in table.items()}, front[robots]
    labels = {column: measures.label(column) for column in columns}
    return explorer(sweep, table, labels, sweep.maps, front, name)


def _axes_text(result: SweepResult) -> str:
    sweep = result.sweep
    axes = ", ".join(axis.name for axis in sweep.axes)
    front = result.summary.get("front", {})
    fronts = "; ".join(
        f"{entry['designs']} on the front" + (f" of {variant}" if sweep.has_variants else "")
        for variant, entry in front.items()
    )
    text = (
        f"{result.summary['designs']} designs ({sweep.sampling}, seed "
        f"{result.summary['seed']}) "
        f"over {axes}"
    )
    return f"{text}; {fronts}." if fronts else f"{text}."


def sweep_report(result: SweepResult) -> dict[str, Any]:
    """Write `index.html` into the sweep's folder.

    Args:
        result: the finished sweep.

    Returns:
        `designs`, `rejected`, `rejected_because` (number of designs by reason) and `files`.
    """
    page = Page(
        title=f"Sweep {result.sweep.name}",
        lead=result.summary["description"],
        sections=[Section("Results", sweep_content(result)[1:])],
        provenance={**result.summary["versions"], "commit": result.summary["commit"]},
    )
    target = write_text(result.folder / "index.html", render(page))
    files = [str(result.table_path), str(target)]
    return {
        "designs": result.summary["designs"],
        "rejected": result.summary["rejected"],
        "rejected_because": result.summary["rejected_because"],
        "files": files,
    }
