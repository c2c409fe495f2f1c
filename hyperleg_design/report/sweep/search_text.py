"""What a search found, for a terminal."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from hyperleg_design.report.sweep.rows import without_variants
from hyperleg_design.report.sweep.trials_text import policy_kind, policy_names
from hyperleg_design.report.sweep.violations import violations
from hyperleg_design.report.text import table
from hyperleg_design.sweep.finalists import Final, Row, holds_constraints, value_of
from hyperleg_design.sweep.search import REASON, Search, found_designs
from hyperleg_design.sweep.trial_table import build_command

if TYPE_CHECKING:
    import optuna


def search_text(search: Search, study: optuna.Study) -> str:
    """The front as a table, with what failed.

    Args:
        search: what was searched.
        study: its trials.

    Returns:
        The text.
    """
    states = Counter(trial.state.name.lower() for trial in study.trials)
    lines = [", ".join(f"{count} {state}" for state, count in states.items())]
    reasons = Counter(t.user_attrs[REASON] for t in study.trials if REASON in t.user_attrs)
    lines += [f"  failed {count}: {reason}" for reason, count in reasons.most_common(5)]
    rows = found_designs(search, study)
    if not rows:
        return "\n".join([*lines, "no design holds all constraints", *violations(search, study)])
    axes = [axis.name for axis in search.sweep.axes]
    cells = [
        [
            row["sample"],
            row["variant"],
            *(row[name] for name in (*axes, *search.objectives)),
            policy_names(row),
            policy_kind(row),
        ]
        for row in rows
    ]
    heads = ["design", "variant", *axes, *search.objectives, "policy", "policy is"]
    note = "candidates, in the order of the first objective"
    note += "; their values are the best of many" if search.plan.protocols else ""
    return "\n".join([*lines, table(*without_variants(heads, cells)), note])


def final_text(search: Search, final: Final) -> str:
    """The finalists with the values that decide, the winner, and how to build it.

    Args:
        search: what was searched.
        final: the finalists.

    Returns:
        The text.
    """
    if not final.finalists:
        return "no finalist: no design holds all constraints"
    cells = []
    for finalist in final.finalists:
        stages = [("search", finalist.searched)]
        stages += [("new trials", finalist.before)] if search.plan.protocols else []
        stages += [] if finalist.after is None else [("fine-tuned", finalist.after)]
        for name, row in stages:
            values = [_with_interval(row, objective) for objective in search.objectives]
            holds = "yes" if holds_constraints(search, row) else "no"
            policy = [policy_names(row), policy_kind(row)]
            cells.append([finalist.number, name, *values, holds, *policy])
    heads = ["design", "values of", *search.objectives, "holds constraints"]
    lines = [table([*heads, "policy", "policy is"], cells)]
    winner = final.winner()
    if winner is None:
        return "\n".join([*lines, "no winner: no finalist holds all constraints in its new trials"])
    measured = "after fine-tuning" if final.steps else "of new trials"
    said = f", by the values {measured}" if search.plan.protocols else ""
    lines.append(f"winner: design {winner.number}{said}")
    if len(final.winners) > 1:
        others = ", ".join(str(number) for number in final.winners[1:])
        lines.append(
            f"it is best in {search.objectives[0]}; not beaten in all objectives: {others}"
        )
    lines += [
        f"its interval of {name} overlaps that of design {other.number}: they may be equal in it"
        for name in search.objectives
        for other in final.finalists
        if other is not winner and _overlap(winner.decisive, other.decisive, name)
    ]
    if search.plan.protocols and not final.steps:
        lines.append("its policies were trained on other designs; --finetune trains them on it")
    return "\n".join([*lines, f"build: {build_command(search.sweep, winner.decisive)}"])


def _overlap(first: Row, second: Row, name: str) -> bool:
    """Whether the intervals of a measure overlap; False where it has none."""
    ends = [
        (value_of(row, f"{name}.low"), value_of(row, f"{name}.high")) for row in (first, second)
    ]
    return ends[0][0] <= ends[1][1] and ends[1][0] <= ends[0][1]


def _with_interval(row: Row, name: str) -> str:
    """A measure, with its interval where it has one."""
    value, low, high = (value_of(row, f"{name}{end}") for end in ("", ".low", ".high"))
    return f"{value:.4g}" + (f" ({low:.4g} to {high:.4g})" if low == low and high == high else "")
