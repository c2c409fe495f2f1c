"""The paper's experiment by one command: shipped policies evaluated, Tables III and IV and Figs. 4
to 7 beside the paper, on a page.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from hyperleg_design import provenance
from hyperleg_design.evaluation.result_tables import write_results
from hyperleg_design.report import page as pages
from hyperleg_design.report.drawer import FIGURES, Drawer
from hyperleg_design.report.page import Page, Section
from hyperleg_design.report.text import table
from hyperleg_design.report.walks.beside_paper import row_facts, rows_beside_paper
from hyperleg_design.report.walks.compared import check_policies
from hyperleg_design.report.walks.evaluated import Evaluated, evaluate_shipped
from hyperleg_design.report.walks.planned_part import planned_rows, row_numbers
from hyperleg_design.report.walks.policy_parts import parts
from hyperleg_design.report.walks.rewards_part import reward_rows
from hyperleg_design.writing import check_output_folder, output_folder, write_json, write_text

TABLES, PLANNED, BY_REWARD, RESULTS = "tables.json", "planned.json", "rewards.json", "evaluation"
"""Rows beside the paper, outcomes of the analysis plan, both arms under several rewards, and the
trials' tables, beside the page."""
LEAD = (
    "Walking and the T-test with and without the active toe: trained policies, evaluated without "
    "assist, beside the paper's Tables III "
    "and IV and Figures 4 to 7. Every number carries what it rests on; where that does not "
    "suffice, the page says so."
)


def run_paper(
    policies: str | Path | None = None,
    out: str | Path = "results/paper",
    *,
    workers: int | None = None,
    progress: bool = True,
    **options: Any,
) -> Path:
    """Evaluate all policies of a folder and write the page.

    Args:
        policies: folder of trainings; the shipped policies by default.
        out: folder to write, replaced as a whole: `index.html`, figures, `tables.json`,
            `planned.json`, and the trials as Parquet.
        workers: processes; as many as the machine has processors by default.
        progress: show a bar.
        options: further ones of `evaluate_shipped`.

    Returns:
        The page.

    Raises:
        InputError: no such folder, one without a policy to compare, or a policy that cannot be
            used.
        OutputError: the folder is not ours, or cannot be written.
    """
    check_output_folder(out)
    check_policies(policies)
    evaluated = evaluate_with_bar(policies, workers=workers, progress=progress, **options)
    with output_folder(out) as folder:
        sections = [Section(part.title, part.content) for part in policy_parts(evaluated, folder)]
        commit = provenance.git_commit()
        page = Page(
            title="Active toes: the paper's experiment, run again",
            lead=LEAD,
            sections=sections,
            provenance={
                **provenance.versions(),
                **({"commit": commit} if commit else {}),
                "made by": "hyperleg paper",
            },
        )
        write_text(folder / "index.html", pages.render(page))
    return Path(out) / "index.html"


def policy_parts(evaluated: Evaluated, folder: Path, prefix: str = "") -> list[Any]:
    """Draw and write everything into a page's folder.

    Args:
        evaluated: evaluated policies, at least one, also of the rewards alone.
        folder: of the page.
        prefix: in front of each figure's name.

    Returns:
        Parts of a page.
    """
    (folder / FIGURES).mkdir(exist_ok=True)
    write_json(
        folder / TABLES,
        {
            name: [row_facts(row) for row in rows]
            for name, rows in rows_beside_paper(evaluated).items()
        },
    )
    write_json(
        folder / PLANNED,
        {
            name: [row_numbers(row) for row in rows]
            for name, rows in planned_rows(evaluated).items()
        },
    )
    if evaluated.evaluations:
        write_results(folder / RESULTS, evaluated.evaluations)
    if evaluated.rewards is not None:
        rows = reward_rows(evaluated.rewards)
        write_json(folder / BY_REWARD, {g: [row_numbers(r) for r in rs] for g, rs in rows.items()})
    return parts(evaluated, Drawer(folder, prefix))


def evaluate_with_bar(
    policies: str | Path | None = None,
    *,
    workers: int | None = None,
    progress: bool = True,
    **options: Any,
) -> Evaluated:
    """Evaluate the shipped policies with a progress bar.

    Args:
        policies: folder of trainings; the shipped ones by default.
        workers: processes.
        progress: whether the bar is shown.
        options: of `evaluate_shipped`.

    Returns:
        The policies with their trials.
    """
    from tqdm import tqdm

    with tqdm(disable=not progress, desc="policies", unit="evaluation") as bar:

        def note(done: int, count: int, name: str) -> None:
            bar.total = count
            bar.set_postfix_str(name)
            bar.update(done - bar.n)

        return evaluate_shipped(policies, workers=workers, progress=note, **options)


def read_tables(out: str | Path) -> dict[str, list[dict[str, Any]]]:
    """Read the `tables.json` of a folder that `run_paper` wrote.

    Args:
        out: the folder.

    Returns:
        Rows by table; empty where there was no policy.
    """
    path = Path(out) / TABLES
    tables: dict[str, list[dict[str, Any]]] = json.loads(path.read_text()) if path.is_file() else {}
    return tables


def tables_text(tables: dict[str, list[dict[str, Any]]]) -> str:
    """Write the content of `tables.json` as text for a terminal.

    Args:
        tables: rows by table.

    Returns:
        The text.
    """
    if not tables:
        return "no policies of both of the paper's robots: no table to put beside the paper's"
    texts = []
    for name, rows in tables.items():
        cells = []
        for row in rows:
            line: list[object] = [row["quantity"], row["unit"]]
            for side in ("toe", "ablation"):
                ours = row[side]["mean"]
                line += [
                    row[side]["paper"],
                    "" if ours is None else float(f"{ours:.4g}"),
                    row[side]["verdict"],
                ]
            change = row["change"]
            ours = "" if change["mean"] is None else f"{100 * change['mean']:+.1f} %"
            cells.append([*line, f"{100 * change['paper']:+.1f} %", ours, change["verdict"]])
        head = [
            "",
            "unit",
            "toe: paper",
            "ours",
            "verdict",
            "ablation: paper",
            "ours",
            "verdict",
            "change: paper",
            "ours",
            "verdict",
        ]
        texts.append(f"{name}\n{table(head, cells)}")
    return "\n\n".join(texts)
