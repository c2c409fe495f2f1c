"""The part of the study's page that shows sweeps whose designs walk, from committed trials."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hyperleg_design.errors import HyperlegError
from hyperleg_design.report.page import Heading, Missing, Section
from hyperleg_design.report.study.context import Made
from hyperleg_design.report.sweep.trials import evaluated_content
from hyperleg_design.sweep.run import run_sweep
from hyperleg_design.sweep.trials.stored import Stored, rerun, stored, stored_names
from hyperleg_design.sweep.trials.trial_plan import plan

if TYPE_CHECKING:
    from hyperleg_design.report.study.context import Context

TITLE = "Walking over designs"


def walked(context: Context) -> Made:
    """Show maps of walking over designs; the trials are committed, and a sample of them is run
    again.

    Args:
        context: what the study is about, and where its files go.

    Returns:
        The section, and its headline numbers.
    """
    content: list[Any] = [
        "Here every design of a sweep walks. The trials take minutes to hours, so that they are committed (sweeps/walked) and this page runs a sample of them again. hyperleg sweep run NAME --out FOLDER runs all."
    ]
    designs = 0
    for name in stored_names():
        title = name.removeprefix("walk_").replace("_", " ").capitalize()
        try:
            committed = stored(name)
        except HyperlegError as error:
            content.append(Missing(title, str(error)))
            continue
        result = run_sweep(committed.sweep, context.folder / "sweeps" / name, progress=False)
        inside, table = evaluated_content(result, committed.trials, f"walked-{name}")
        designs += len(table)
        content += [
            Heading(title),
            committed.sweep.description,
            _again(committed, context),
            *inside,
        ]
    facts = ((f"{designs}", "designs walked in sweeps"),) if designs else ()
    return Made(Section(TITLE, content), facts)


def _again(committed: Stored, context: Context) -> str:
    """Which trials were run again for this page, and how they compare."""
    text = (
        f"{len(committed.trials)} trials, run at commit {committed.commit}. "
        f"Nothing of them was run again for this page: "
    )
    try:
        folders = () if context.policies is None else (context.policies,)
        wanted = plan(committed.sweep, committed.sweep.evaluated, policies=folders)
    except HyperlegError as error:
        return text + str(error)
    if wanted.digest != committed.plan:
        return text + "protocols or policies are not those that ran then."
    done = rerun(committed, wanted)
    cost = (
        f"the cost of transport of a design differs by {100 * done.largest_difference:.2g} % at most"
        if done.largest_difference == done.largest_difference
        else "all of them fell"
    )
    return (
        f"{len(committed.trials)} trials, run at commit {committed.commit}. Run again for this "
        f"page: {done.trials} trials of {done.designs} designs with {done.policy}. "
        f"{done.same_outcomes} ended as then; {cost}."
    )
