"""What a search found, for a terminal."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from hyperleg_design.report.text import table
from hyperleg_design.sweep.search import REASON, Search, found_designs
from hyperleg_design.sweep.trial_table import build_command

if TYPE_CHECKING:
    import optuna


def search_text(search: Search, study: optuna.Study) -> str:
    """The front as a table, with what failed and how to build the first design."""
    states = Counter(trial.state.name.lower() for trial in study.trials)
    lines = [", ".join(f"{count} {state}" for state, count in states.items())]
    reasons = Counter(t.user_attrs[REASON] for t in study.trials if REASON in t.user_attrs)
    lines += [f"  failed {count}: {reason}" for reason, count in reasons.most_common(5)]
    rows = found_designs(search, study)
    if not rows:
        return "\n".join([*lines, "no design holds all constraints"])
    axes = [axis.name for axis in search.sweep.axes]
    kinds = [f"{protocol}.policy" for protocol in search.protocols]
    cells = [
        [
            row["sample"],
            row["variant"],
            *(row[name] for name in (*axes, *search.objectives)),
            ", ".join(dict.fromkeys(str(row[k]) for k in kinds if row.get(k))),
        ]
        for row in rows
    ]
    heads = ["design", "variant", *axes, *search.objectives, "policy is"]
    note = (
        "candidates: a zero-shot policy was trained on another design; train one for each before "
        "you name a winner"
    )
    return "\n".join(
        [*lines, table(heads, cells), note, f"build: {build_command(search.sweep, rows[0])}"]
    )
