"""Campaigns: all trainings that a comparison needs, listed in one file, run side by side, killed
and resumed at will.
"""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.learning import launch
from hyperleg_design.learning.preset_file import load_preset
from hyperleg_design.learning.records.status import CHECKPOINT, POLICY, RUN, read_status
from hyperleg_design.learning.resolved import preset_mapping, task_mapping
from hyperleg_design.processes import run_side_by_side
from hyperleg_design.reading import read_yaml, short_name
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.parameters.entries import (
    check_keys,
    checked_mapping,
    checked_whole_number,
)
from hyperleg_design.simulation.tasks import load_task
from hyperleg_design.writing import MARKER, check_output_folder, write_text

LOG = "training.log"
"""What a training's process printed, in its folder."""
STATES = ("done", "shipped", "unneeded", "running", "stopped", "missing")
FINISHED = ("done", "shipped", "unneeded")
"""States in which nothing is left to train; a shipped policy stands in `sim/policies/` with the
training's name, and an unneeded one is only the start of others, which are all finished."""
SHIP = ("all", "last", "none")
"""What is shipped of a finished training: its last and late policies, its last one, or nothing."""
POLICIES = "policies"
"""Folder of the shipped policies in `sim/`."""


@dataclass(frozen=True)
class Run:
    """One training of a campaign."""

    group: str
    task: str
    design: str
    seed: int
    preset: str
    start: str = ""
    """Group whose policy of the same design and seed it starts from; empty: from scratch."""
    compared: bool = True
    """Whether its policies are evaluated; those that others only start from are not."""
    ship: str = "all"
    """One of `SHIP`."""

    @property
    def name(self) -> str:
        """Name of the folder of this training."""
        return f"{self.group}-{self.design}-{self.seed}"

    @property
    def start_name(self) -> str:
        """Name of the training that it starts from, if any."""
        return f"{self.start}-{self.design}-{self.seed}"


@dataclass(frozen=True)
class Campaign:
    """Trainings in the order in which they are run."""

    name: str
    processes: int
    """Trainings at the same time, one thread each."""
    runs: tuple[Run, ...]

    @property
    def ship(self) -> dict[str, str]:
        """What is shipped of each group, one of `SHIP`."""
        return {run.group: run.ship for run in self.runs}


def shipped_starts() -> frozenset[str]:
    """Collect the groups whose policies others only start from, in every shipped campaign.

    Returns:
        Names of the groups.
    """
    runs = [
        run
        for name in resources.names("sim")
        if name.split("_")[0] == "campaign"
        for run in load_campaign(name).runs
    ]
    return frozenset(r.group for r in runs) - {r.group for r in runs if r.compared}


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


def load_campaign(name: str | Path = "campaign") -> Campaign:
    """Read a campaign from a shipped file or a file of the user.

    Args:
        name: a shipped name or a YAML file.

    Returns:
        The campaign with all of its trainings.

    Raises:
        InputError: names file, field, value and remedy; also for a task, design or preset that does
        not exist.
    """
    path = resources.find("sim", name)
    data, where = read_yaml(path), short_name(path)
    check_keys(data, where, "", ("name", "preset", "groups"), ("processes",))
    processes = checked_whole_number(data.get("processes", 2), where, "processes", 1, 1000)
    groups = data["groups"]
    if not isinstance(groups, list) or not groups:
        raise InputError(where, "groups", groups, "expects a list of groups")
    runs: list[tuple[int, int, int, Run]] = []
    names = set()
    for g, group in enumerate(groups):
        check_keys(
            checked_mapping(group, where, f"groups.{g}"),
            where,
            f"groups.{g}",
            ("name", "task", "designs", "seeds"),
            ("start", "preset", "compared", "ship"),
        )
        compared = group.get("compared", True)
        if not isinstance(compared, bool):
            raise InputError(where, f"groups.{g}.compared", compared, "expects true or false")
        ship = group.get("ship", "all" if compared else "last")
        if ship not in SHIP:
            raise InputError(where, f"groups.{g}.ship", ship, f"expects one of {', '.join(SHIP)}")
        if "-" in str(group["name"]):
            remedy = "expects a name without hyphens: trainings are named group-design-seed"
            raise InputError(where, f"groups.{g}.name", group["name"], remedy)
        if group["name"] in names:
            raise InputError(where, f"groups.{g}.name", group["name"], "stands twice")
        start = str(group.get("start") or "")
        before = {(run.design, run.seed) for *_, run in runs if run.group == start}
        names.add(group["name"])
        task = load_task(str(group["task"])).name
        preset = str(group.get("preset") or data["preset"])
        load_preset(preset).stages(task)
        if not isinstance(group["designs"], list) or not group["designs"]:
            raise InputError(
                where, f"groups.{g}.designs", group["designs"], "expects a list of designs"
            )
        for d, design in enumerate(group["designs"]):
            load_robot(str(design))
            for seed in range(
                checked_whole_number(group["seeds"], where, f"groups.{g}.seeds", 1, 1000)
            ):
                if start and (str(design), seed) not in before:
                    raise InputError(
                        where,
                        f"groups.{g}.start",
                        start,
                        f"expects a group before it that has {design}, seed {seed}",
                    )
                run = Run(
                    str(group["name"]),
                    str(group["task"]),
                    str(design),
                    seed,
                    preset,
                    start,
                    compared,
                    ship,
                )
                runs.append((seed, g, d, run))
    # by seed first, so that whatever is done when time is out can be compared
    ordered = tuple(run for *_, run in sorted(runs, key=lambda entry: entry[:3]))
    return Campaign(str(data["name"]), processes, ordered)


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


def shipped_folder() -> Path:
    """Find the folder in which finished trainings are shipped.

    Returns:
        Its path, which need not exist.
    """
    return resources.content_folder("sim") / POLICIES


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
