"""Folders that the verbs of `hyperleg gap` write: a diagnosis with its page, planned experiments
with their figures.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from hyperleg_design.gap.checks.intake import take_in
from hyperleg_design.gap.experiments.excite import excite
from hyperleg_design.gap.pipeline.diagnose import diagnose_intake
from hyperleg_design.report.gap.excite import plan_text, write_report
from hyperleg_design.report.gap.page import write_gap_page
from hyperleg_design.report.gap.run import Run
from hyperleg_design.writing import check_output_folder, output_folder, write_json

MOST_SHOWN = 3
"""Logs drawn on the page."""


def diagnose_to_folder(
    robot: str,
    sources: Sequence[str | os.PathLike[str]],
    references: Sequence[str | os.PathLike[str]],
    out: str | os.PathLike[str],
    *,
    reference_robot: str = "",
    seed: int = 0,
    threads: int = 2,
    show: Callable[[str], None] | None = None,
) -> tuple[dict[str, Any], Path]:
    """Diagnose logs and write `diagnosis.json`, `index.html` and the page's figures.

    Args:
        robot: a design, MJCF or URDF file; empty: what the logs name.
        sources: files or folders of any known format; logs whose metadata say so count as
            references.
        references: of the healthy robot.
        out: folder, written whole or not at all.
        reference_robot: of the references, where the robot was built differently then; empty: the
            same.
        seed: of everything random.
        threads: the answer does not depend on them.
        show: takes lines of progress.

    Returns:
        The diagnosis as the file holds it, and the page.

    Raises:
        InputError: logs or robot that cannot be used.
        OutputError: the folder cannot be written.
    """
    check_output_folder(out)
    intake = take_in(robot, sources, references, reference_robot=reference_robot)
    diagnosis = diagnose_intake(intake, seed=seed, threads=threads, show=show).mapping()
    run = Run(
        robot or intake.subject.path, tuple(os.fspath(source) for source in sources), os.fspath(out)
    )
    with output_folder(out) as folder:
        write_json(folder / "diagnosis.json", diagnosis)
        write_gap_page(folder, diagnosis, intake.tests[:MOST_SHOWN], run)
    return diagnosis, Path(out) / "index.html"


def excite_to_folder(robot: str, out: str | os.PathLike[str], **options: Any) -> str:
    """Design experiments for a rig, and write targets, plan and figures.

    Args:
        robot: a design, or an MJCF or URDF file.
        out: folder to write.
        options: of `gap.experiments.excite.excite`.

    Returns:
        The plan as text.

    Raises:
        InputError: bad input.
        InfeasibleError: no motion fits into the robot's limits.
        OutputError: the folder cannot be written.
    """
    check_output_folder(out)
    with output_folder(out) as folder:
        experiment = excite(robot, folder, **options)
        write_report(experiment, folder)
    return plan_text(experiment)
