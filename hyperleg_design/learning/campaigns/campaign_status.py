"""How far the trainings of a campaign are."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from hyperleg_design.learning.campaigns.campaign import Campaign, Run
from hyperleg_design.learning.preset_file import load_preset
from hyperleg_design.learning.records.status import CHECKPOINT, POLICY, RUN, read_status
from hyperleg_design.learning.resolved import preset_mapping, task_mapping
from hyperleg_design.resources import shipped_folder
from hyperleg_design.robot.load import load_robot
from hyperleg_design.simulation.tasks import load_task

STATES = ("done", "shipped", "unneeded", "running", "stopped", "missing")
FINISHED = ("done", "shipped", "unneeded")
"""States in which nothing is left to train; a shipped policy stands in `sim/policies/` with the
training's name, and an unneeded one is only the start of others, which are all finished."""


@dataclass(frozen=True)
class RunStatus:
    """How far one training of a campaign is."""

    run: Run
    state: str
    """One of `STATES`."""
    steps: float = 0.0
    """Policy steps done."""
    total: float = 0.0
    """Policy steps of the whole training."""
    measures: Mapping[str, Any] | None = None
    """`status.json` of the training."""


def campaign_status(campaign: Campaign, out: str | Path) -> list[RunStatus]:
    """Find out how far each training of a campaign is.

    Args:
        campaign: the list of trainings.
        out: folder of the campaign.

    Returns:
        Statuses, in the campaign's order.
    """
    statuses: dict[str, RunStatus] = {}
    following: dict[str, list[RunStatus]] = {}
    for run in reversed(campaign.runs):  # those that start from a training come after it
        status = _status(run, Path(out) / run.name)
        others = following.get(run.name, [])
        if (
            not run.compared
            and status.state in ("stopped", "missing")
            and others
            and all(other.state in FINISHED for other in others)
        ):
            status = replace(status, state="unneeded")
        if run.start:
            following.setdefault(run.start_name, []).append(status)
        statuses[run.name] = status
    return [statuses[run.name] for run in campaign.runs]


def status_table(statuses: list[RunStatus]) -> str:
    """Write statuses as text.

    Args:
        statuses: of the trainings.

    Returns:
        One line for each training, and a sum.
    """
    lines = [
        f"{'training':<34} {'state':<8} {'M steps':>12} {'speed':>6} {'falls/min':>9} {'CoT':>5} "
        f"{'assist':>6} {'left':>8}"
    ]
    for status in statuses:
        measures = status.measures or {}
        share = f"{status.steps / 1e6:.2f}/{status.total / 1e6:.1f}"
        left = f"{measures['left'] / 60:.0f} min" if measures.get("left") else ""
        numbers = [
            _shown(measures.get(key), width)
            for key, width in (("speed", 6), ("falls", 9), ("cost_of_transport", 5), ("assist", 6))
        ]
        lines.append(
            f"{status.run.name:<34} {status.state:<8} {share:>12} {' '.join(numbers)} {left:>8}"
        )
    done = sum(s.state in FINISHED for s in statuses)
    steps = sum(s.total if s.state in FINISHED else s.steps for s in statuses)
    total = sum(s.total for s in statuses)
    lines.append(
        f"{done} of {len(statuses)} done; {steps / 1e6:.1f} of {total / 1e6:.1f} M policy steps"
    )
    return "\n".join(lines)


def _is_shipped(run: Run) -> bool:
    """Whether this very training is shipped: same task, design, seed and preset as they stand
    today.
    """
    place = shipped_folder() / run.name
    try:
        content = json.loads((place / RUN).read_text())
    except (OSError, ValueError):
        return False
    task, design = load_task(run.task), load_robot(run.design)
    today = {
        "task": task_mapping(task),
        "design": design.to_mapping(),
        "seed": run.seed,
        "preset": preset_mapping(load_preset(run.preset), task.name),
    }
    return (place / POLICY).exists() and all(
        content.get(key) == json.loads(json.dumps(value)) for key, value in today.items()
    )


def _status(run: Run, folder: Path) -> RunStatus:
    preset, task = load_preset(run.preset), load_task(run.task)
    total = float(preset.total_iterations(task.name) * preset.steps_per_iteration)
    status = read_status(folder)
    if status is None and _is_shipped(run):
        return RunStatus(run, "shipped", total, total)
    if status is None:
        return RunStatus(
            run, "stopped" if (folder / CHECKPOINT).exists() else "missing", 0.0, total
        )
    if status.get("done") and (folder / POLICY).exists():
        return RunStatus(run, "done", total, total, status)
    return RunStatus(
        run,
        "running" if _alive(status.get("pid")) else "stopped",
        float(status.get("steps") or 0.0),
        total,
        status,
    )


def _alive(pid: int | None) -> bool:
    if not pid:
        return False
    try:
        os.kill(pid, 0)
    except (ProcessLookupError, PermissionError):
        return False
    return True


def _shown(value: Any, width: int) -> str:
    return f"{value:>{width}.2f}" if isinstance(value, int | float) else " " * width
