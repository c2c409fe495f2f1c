"""Which trained policies stand for a protocol on a robot.

Trainings lie in folders named `group-design-seed`. HyperLeg's robots walk by the policies of their
toe layout; a robot that writes its tree out by those that were trained under its own name, or else
under the name of the nearest of the designs that its file is based on.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.shipped import (
    GOES_ON,
    Shipped,
    shipped_policies,
    unfinished_trainings,
)
from hyperleg_design.robot.load import design_argument
from hyperleg_design.robot.motors import folder_option
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.simulation.model import simulation_spec

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign

PREFERRED = {"walk": ("walk_upright", "walk"), "t_test": ("t_test_free", "t_test")}
"""Groups whose policies stand for a kind of protocol, the best first; other groups of that name's
beginning come after them."""
ONLY_STARTS = ("_guided", "_first")
"""Endings of groups whose policies others only start from; they stand for no protocol."""
_TASKS = {
    ("hyperleg", "walk"): ("walk", "walk"),
    ("hyperleg", "t_test"): ("t_test", "goal"),
    ("tree", "walk"): ("walk_any", "walk_any --preset walker"),
    ("tree", "t_test"): (
        "t_test_any",
        "t_test_any --preset walker --start FOLDER/walk_any-NAME-0",
    ),
}
"""Group and options of `hyperleg train` that give a policy, by family and kind of protocol; NAME is
the robot's."""


def policies_for(
    kind: str, design: RobotDesign, seeds: int, folders: Sequence[str | Path] = ()
) -> list[Shipped]:
    """List the last policies of the first trainings for a kind of protocol and a robot.

    Args:
        kind: of protocol, `walk` or `t_test`; a group's own name chooses that group.
        design: the robot, or a batch of its kind.
        seeds: most trainings of each folder.
        folders: of trainings; the shipped ones by default.

    Returns:
        Of each folder one policy for each seed, all of one group and trained on one design.

    Raises:
        InputError: there is none, which says how to train one, or why the robot cannot be
            simulated; or two folders have a training of the same name.
    """
    chosen: list[Shipped] = []
    known: list[Shipped] = []
    for folder in folders or (None,):
        there = [p for p in shipped_policies(folder, late=False) if p.family == design.family]
        known += there
        chosen += _of_folder(kind, design, seeds, there)
    names = [policy.training for policy in chosen]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        remedy = "is in two of these folders; rename one, since results name trainings"
        raise InputError("policies", "", twice[0], remedy)
    if chosen:
        return chosen
    simulation_spec(design.take(0) if design.batch_shape else design)
    have = ", ".join(sorted({f"{policy.group}-{policy.design}" for policy in known})) or (
        "none in folders named group-design-seed"
    )
    what = "robot" if isinstance(design, TreeDesign) else "toe layout"
    raise InputError(
        "policies",
        "",
        f"{kind}-{trained_names(design)[0]}",
        f"no policy was trained for this task and {what}; "
        + (_unfinished(kind, design, folders) or f"there are {have}; {_remedy(kind, design)}"),
    )


def _of_folder(
    kind: str, design: RobotDesign, seeds: int, known: Sequence[Shipped]
) -> list[Shipped]:
    """Policies of one folder, as of `policies_for`; none where it has none."""
    for name in trained_names(design):
        own = [p for p in known if p.design == name and _stands_for(p.group, kind)]
        if own:
            groups = [policy.group for policy in own]
            best = PREFERRED.get(kind, (kind,))
            group = next((name for name in best if name in groups), groups[0])
            return [policy for policy in own if policy.group == group][:seeds]
    return []


def trained_names(design: RobotDesign) -> tuple[str, ...]:
    """Name what a policy for a robot may have been trained on.

    Args:
        design: the robot.

    Returns:
        The toe layout of a HyperLeg; of a robot that writes its tree out its name, and then those
        of the designs that its file is based on, the nearest first.
    """
    if isinstance(design, TreeDesign):
        return (design.name, *design.bases)
    return (design.variant,)


def _stands_for(group: str, kind: str) -> bool:
    return group == kind or (group.startswith(kind) and not group.endswith(ONLY_STARTS))


def _unfinished(kind: str, design: RobotDesign, folders: Sequence[str | Path]) -> str:
    """That the training of such a policy is not finished; empty where there is none."""
    begun = [training for folder in folders for training in unfinished_trainings(folder)]
    names = trained_names(design)
    own = [t.training for t in begun if t.design in names and _stands_for(t.group, kind)]
    return f"{own[0]} is not finished; {GOES_ON}" if own else ""


def _remedy(kind: str, design: RobotDesign) -> str:
    """How to get a policy for a robot."""
    name = trained_names(design)[0]
    if (design.family, kind) not in _TASKS:
        return "no shipped task trains one: train a task of your own and give --policies FOLDER"
    group, options = _TASKS[design.family, kind]
    options = options.replace("NAME", name)
    robot = design_argument(design) if isinstance(design, TreeDesign) else name
    return (
        f"hyperleg train --task {options} --design {robot}{folder_option()} "
        f"--out FOLDER/{group}-{name}-0 trains one, and --policies FOLDER takes it"
    )
