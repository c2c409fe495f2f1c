"""The study: the paper's biped and its ablations from parameters to a page a designer reads."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from hyperleg_design import provenance
from hyperleg_design.evaluation.shipped import shipped_policies
from hyperleg_design.report import page as pages
from hyperleg_design.report.drawer import FIGURES
from hyperleg_design.report.page import Page, Section
from hyperleg_design.report.study import actuation, sections
from hyperleg_design.report.study import experiment as study_experiment
from hyperleg_design.report.study import motions as motion
from hyperleg_design.report.study.context import Context, Made
from hyperleg_design.report.study.walked import walked
from hyperleg_design.robot.ablation import variants
from hyperleg_design.robot.design import Design, load_design
from hyperleg_design.writing import output_folder, write_text

STEPS: Mapping[str, Callable[..., Made]] = {
    "robot": sections.robot,
    "table I": sections.table_i,
    "inconsistencies": sections.inconsistencies,
    "cooperative actuation": actuation.cooperative_actuation,
    "envelopes": actuation.envelopes,
    "capability": motion.capability,
    "demand": motion.demand,
    "lightness": actuation.lightness,
    "sweeps": sections.sweeps,
    "motors": sections.motors,
    "policies": study_experiment.experiment,
    "walked designs": walked,
    "parameters": sections.made_from,
}
"""Parts in the order of the page."""


def run_study(
    out: str | Path,
    *,
    design: Design | None = None,
    policies: str | Path | None = None,
    progress: bool = True,
) -> Path:
    """Run the study and write its page.

    Args:
        out: folder to write, replaced as a whole.
        design: robot with an active toe, the paper's by default.
        policies: folder of trainings to evaluate; the shipped policies by default.
        progress: show a bar.

    Returns:
        The page, `out/index.html`.

    Raises:
        OutputError: the folder is not ours, or cannot be written.
    """
    from tqdm import tqdm

    design = design or load_design("hyperleg")
    shipped_policies(policies)  # a folder that is not there is told before minutes of work
    with output_folder(out) as folder:
        context = Context(
            design, variants(design), folder, None if policies is None else Path(policies), progress
        )
        (folder / FIGURES).mkdir()
        finished: list[Section] = []
        facts: list[tuple[str, str]] = []
        with tqdm(total=len(STEPS), disable=not progress, desc="study", unit="part") as bar:
            for name, step in STEPS.items():
                bar.set_postfix_str(name)
                section = step(context)
                finished.append(section.section)
                facts += section.facts
                bar.update()
        page = Page(
            title=f"{design.name}: a biped with active toes, described and sized",
            lead=sections.LEAD,
            sections=finished,
            facts=facts,
            provenance=_provenance(),
        )
        write_text(folder / "index.html", pages.render(page))
    return Path(out) / "index.html"


def _provenance() -> dict[str, Any]:
    commit = provenance.git_commit()
    return {
        **provenance.versions(),
        **({"commit": commit} if commit else {}),
        "made by": "hyperleg study",
    }
