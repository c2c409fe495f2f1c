"""The page of one sweep, and the same content for the study."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from hyperleg_design.report.page import Details, Page, Picture, Section, Table, render
from hyperleg_design.sweep import measures
from hyperleg_design.writing import write_text

if TYPE_CHECKING:
    from hyperleg_design.sweep.run import SweepResult


def sweep_content(result: SweepResult, page_folder: Path, figures: str) -> list[Any]:
    """What a page says of a sweep; draws its figures.

    Args:
        result: the finished sweep.
        page_folder: folder of the page.
        figures: folder for the figures, relative to the page.
    """
    from hyperleg_design.report.sweep.figures import draw_sweep

    summary = result.summary
    folder = page_folder / figures
    folder.mkdir(parents=True, exist_ok=True)
    content: list[Any] = [summary["description"], _axes_text(result)]
    if summary["rejected"]:
        reasons = "; ".join(
            f"{count} because {reason}" for reason, count in summary["rejected_because"].items()
        )
        content.append(
            f"{summary['rejected']} of {summary['designs']} combinations make no robot: {reasons}."
        )
    content += [
        Picture(f"{figures}/{name}", caption)
        for name, caption in draw_sweep(result, folder).items()
    ]
    rows = []
    for variant, ranges in summary["range"].items():
        base = summary["base"].get(variant, {})
        rows += [
            [variant, measures.label(column), base.get(column), *values]
            for column, values in ranges.items()
        ]
    content.append(
        Details(
            "Ranges of all measures",
            [
                Table(
                    ["variant", "measure", "unchanged design", "smallest", "median", "largest"],
                    rows,
                )
            ],
        )
    )
    return content


def _axes_text(result: SweepResult) -> str:
    sweep = result.sweep
    axes = ", ".join(axis.name for axis in sweep.axes)
    front = result.summary.get("front", {})
    fronts = "; ".join(
        f"{entry['designs']} on the front of {variant}" for variant, entry in front.items()
    )
    text = (
        f"{result.summary['designs']} designs ({sweep.sampling}, seed "
        f"{result.summary['seed']}) "
        f"over {axes}"
    )
    return f"{text}; {fronts}." if fronts else f"{text}."


def sweep_report(result: SweepResult) -> dict[str, Any]:
    """Write `index.html` into the sweep's folder.

    Returns:
        `designs`, `rejected` and `files`.
    """
    page = Page(
        title=f"Sweep {result.sweep.name}",
        lead=result.summary["description"],
        sections=[Section("Results", sweep_content(result, result.folder, "figures")[1:])],
        provenance={**result.summary["versions"], "commit": result.summary["commit"]},
    )
    target = write_text(result.folder / "index.html", render(page))
    files = [str(result.table_path), str(target)]
    return {
        "designs": result.summary["designs"],
        "rejected": result.summary["rejected"],
        "files": files,
    }
