"""Run the trainings of a campaign side by side."""

from __future__ import annotations

import contextlib
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

from hyperleg_design.learning import launch
from hyperleg_design.learning.campaigns.campaign import Campaign, Run
from hyperleg_design.learning.campaigns.campaign_status import (
    FINISHED,
    campaign_status,
    status_table,
)
from hyperleg_design.learning.records.status import POLICY
from hyperleg_design.processes import run_side_by_side
from hyperleg_design.resources import shipped_folder
from hyperleg_design.writing import MARKER, check_output_folder, write_text

LOG = "training.log"
"""What a training's process printed, in its folder."""


def run_campaign(
    campaign: Campaign,
    out: str | Path,
    *,
    processes: int | None = None,
    show: Callable[[str], None] | None = None,
    show_every: float = 60.0,
) -> bool:
    """Train whatever is missing, side by side; call it again after it was killed.

    Args:
        campaign: what to train.
        out: folder of the trainings.
        processes: at the same time; the campaign's number by default.
        show: takes the status table now and then.
        show_every: seconds between.

    Returns:
        Whether all is done. False after an interrupt, which stops the trainings with checkpoints,
        or when a training failed; the others go on then, and its log says why.

    Raises:
        InputError: bad input.
        OutputError: `out` holds somebody else's files.
    """
    folder = check_output_folder(out)
    write_text(folder / MARKER, "made by hyperleg\n")
    waiting = [
        s.run for s in campaign_status(campaign, folder) if s.state in ("missing", "stopped")
    ]
    failed: list[str] = []
    shown = 0.0

    def started(run: Run) -> subprocess.Popen[bytes]:
        place = folder / run.name
        place.mkdir(parents=True, exist_ok=True)
        write_text(place / MARKER, "made by hyperleg\n")
        arguments: dict[str, object] = {
            "task": run.task,
            "design": run.design,
            "seed": run.seed,
            "preset": run.preset,
            "out": place,
        }
        if run.start:
            arguments["start"] = _start_file(run, folder)
        return launch.start(arguments, place / LOG)

    def ended(run: Run, code: int) -> None:
        if code:
            failed.append(run.name)

    def watch() -> None:
        nonlocal shown
        if show is not None and time.monotonic() - shown > show_every:
            shown = time.monotonic()
            show(status_table(campaign_status(campaign, folder)))

    with contextlib.suppress(KeyboardInterrupt):
        run_side_by_side(
            waiting,
            started,
            workers=processes or campaign.processes,
            ready=lambda run: _can_start(run, folder),
            ended=ended,
            watch=watch,
        )
    statuses = campaign_status(campaign, folder)
    if show is not None:
        show(status_table(statuses))
        for name in failed:
            show(f"{name} failed; see {folder / name / LOG}")
    return all(status.state in FINISHED for status in statuses)


def _start_file(run: Run, folder: Path) -> Path:
    """Policy that a training starts from: of the same campaign, else the shipped one."""
    own = folder / run.start_name / POLICY
    return own if own.exists() else shipped_folder() / run.start_name / POLICY


def _can_start(run: Run, folder: Path) -> bool:
    """Whether the policy that it starts from, if any, is there."""
    return not run.start or _start_file(run, folder).exists()
