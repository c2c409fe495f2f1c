"""The trainings of a campaign, and the file that lists them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.learning.preset_file import load_preset
from hyperleg_design.reading import given_path, read_yaml
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.parameters.entries import (
    check_keys,
    checked_mapping,
    checked_whole_number,
)
from hyperleg_design.simulation.tasks import load_task

SHIP = ("all", "last", "policy", "none")
"""What is shipped of a finished training: its last and late policies with the critic, the last one
with the critic, the last one alone, or nothing."""


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
    path = resources.find("sim", name, noun="campaign")
    data, where = read_yaml(path), given_path(path)
    check_keys(data, where, "", ("name", "preset", "groups"), ("processes",))
    processes = checked_whole_number(data.get("processes", 2), where, "processes", 1, 1000)
    groups = data["groups"]
    if not isinstance(groups, list) or not groups:
        raise InputError(where, "groups", groups, "expects a list of groups")
    runs: list[tuple[int, int, int, Run]] = []
    names, designs = set(), set()
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
        with resources.named_in(where, f"groups.{g}.task"):
            task = load_task(str(group["task"])).name
        preset = str(group.get("preset") or data["preset"])
        with resources.named_in(where, f"groups.{g}.preset" if "preset" in group else "preset"):
            load_preset(preset).stages(task)
        if not isinstance(group["designs"], list) or not group["designs"]:
            raise InputError(
                where, f"groups.{g}.designs", group["designs"], "expects a list of designs"
            )
        for d, design in enumerate(group["designs"]):
            if str(design) not in designs:
                with resources.named_in(where, f"groups.{g}.designs"):
                    load_robot(str(design))
                designs.add(str(design))
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


def compared_groups(name: str | Path) -> dict[str, str]:
    """List the groups of a campaign whose policies are compared.

    Args:
        name: a shipped name or a YAML file.

    Returns:
        Names of their tasks by group.

    Raises:
        InputError: a file that is no campaign.
    """
    return {run.group: run.task for run in load_campaign(name).runs if run.compared}


def shipped_campaigns() -> list[str]:
    """List the shipped campaigns.

    Returns:
        Their names, sorted.
    """
    return [name for name in resources.names("sim") if name.split("_")[0] == "campaign"]


def shipped_starts() -> frozenset[str]:
    """Collect the groups whose policies others only start from, in every shipped campaign.

    Returns:
        Names of the groups.
    """
    runs = [run for name in shipped_campaigns() for run in load_campaign(name).runs]
    return frozenset(r.group for r in runs) - {r.group for r in runs if r.compared}
