"""Measures over scored cases, each a share with its Wilson interval, and their table."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

from hyperleg_design.validation.benchmark.scoring import CONFIDENT
from hyperleg_design.validation.wilson import wilson

Row = Mapping[str, Any]
"""One scored case: `name`, `suite`, `split`, `kind`, `truth`, `score`, `seconds`."""
FAULTS = ("single", "everywhere", "several")


@dataclass(frozen=True)
class Measure:
    """How many cases of a kind have an outcome."""

    name: str
    hits: int
    of: int
    target: str = ""

    @property
    def interval(self) -> tuple[float, float]:
        """Wilson's 95 % interval of the share; 0 to 1 of no cases."""
        return wilson(self.hits, self.of)


def measures(rows: Sequence[Row]) -> list[Measure]:
    """All measures of the benchmark over scored cases, in the order of the table.

    Args:
        rows: of any split; measures without a case are left out.
    """
    return [measure for measure in _all(rows) if measure.of]


def _share(name: str, rows: Iterable[Row], hit: Callable[[Row], bool], target: str = "") -> Measure:
    chosen = list(rows)
    return Measure(name, sum(1 for row in chosen if hit(row)), len(chosen), target)


def _outcome(*names: str) -> Callable[[Row], bool]:
    return lambda row: row["score"]["outcome"] in names


def _flag(name: str) -> Callable[[Row], bool]:
    return lambda row: row["score"][name] is True


def _known(name: str, rows: Iterable[Row]) -> list[Row]:
    return [row for row in rows if row["score"][name] is not None]


GOOD = _outcome("right", "equivalent")


def _sure(row: Row) -> bool:
    """Whether an untrue cause stands first with confidence, `ambiguous` answers included."""
    wrong = row["score"]["outcome"] in ("behind", "wrong", "false cause")
    return wrong and (row["score"]["probability"] or 0.0) >= CONFIDENT


def _real(rows: Sequence[Row]) -> list[Measure]:
    real = [row for row in rows if row["suite"] == "real"]
    faults = [row for row in real if row["kind"] in FAULTS]
    healthy = [row for row in real if row["kind"] == "nothing"]
    referenced = [row for row in healthy if row["truth"]["references"]]
    identified = [
        row for row in healthy if not row["truth"]["references"] and row["truth"]["identified"]
    ]
    joints = [row for row in faults if row["kind"] == "everywhere"]
    return [
        _share("real, faults: right or honest equivalent, first", faults, GOOD, ">= 80 %"),
        _share("... right effect and place, first", faults, _outcome("right")),
        _share("... honest equivalent, first", faults, _outcome("equivalent")),
        _share("... right, but behind an untrue cause", faults, _outcome("behind")),
        _share("... any other cause first", faults, _outcome("wrong")),
        _share("... `unknown`, truth among the first two rivals", faults, _outcome("unknown, led")),
        _share("... `unknown` otherwise", faults, _outcome("unknown")),
        _share("... `none`", faults, _outcome("none")),
        _share(
            "real, right or equivalent: no untrue cause beside",
            _known("untrue_beside", faults),
            lambda row: row["score"]["untrue_beside"] is False,
            ">= 80 %",
        ),
        _share("real, one effect at several joints: all named", joints, _flag("all_named")),
        _share("real, nothing wrong, references: `none`", referenced, _outcome("right"), ">= 90 %"),
        _share(
            "real, nothing wrong, identified model, no references: `none` or a bare remainder",
            identified,
            _outcome("right", "remainder"),
            ">= 70 %",
        ),
        _share("real, nothing wrong: `none`", healthy, _outcome("right")),
        _share("... a false cause", healthy, _outcome("false cause")),
        _share("... `unknown`", healthy, _outcome("unknown")),
        _share("real, faults: confident wrong cause", faults, _flag("confident_wrong"), "<= 5 %"),
        _share("... as probable, `ambiguous` answers included", faults, _sure),
        _share(
            "real, nothing wrong: confident wrong cause",
            healthy,
            _flag("confident_wrong"),
            "<= 5 %",
        ),
        _share("... as probable, `ambiguous` answers included there, too", healthy, _sure),
        _share(
            "real, right: the value inside its 95 % interval",
            _known("inside", faults),
            _flag("inside"),
            ">= 85 %",
        ),
        _share(
            "real, right or equivalent: a remainder is stated",
            [row for row in faults if GOOD(row)],
            lambda row: row["score"]["remainder"] is not None,
        ),
        _share("real: errors", real, _outcome("error")),
    ]


def _added(suite: str, rows: Sequence[Row]) -> list[Measure]:
    """Of a suite whose faults are put into plants or logs."""
    own = [row for row in rows if row["suite"] == suite]
    single = [row for row in own if row["kind"] == "single"]
    joints = [row for row in own if row["kind"] == "everywhere"]
    several = [row for row in own if row["kind"] == "several"]
    healthy = [row for row in own if row["kind"] == "nothing"]
    outside = [row for row in own if row["kind"] == "outside"]
    faults = [*single, *joints, *several]
    return [
        _share(f"{suite}, one effect: right or honest equivalent, first", single, GOOD),
        _share(
            f"{suite}, one effect at several joints: all named",
            joints,
            _flag("all_named"),
            ">= 80 %",
        ),
        _share(f"{suite}, two effects: both named", several, _flag("all_named")),
        _share(
            f"{suite}, right or equivalent: no untrue cause beside",
            _known("untrue_beside", faults),
            lambda row: row["score"]["untrue_beside"] is False,
        ),
        _share(f"{suite}, nothing wrong: `none`", healthy, _outcome("right")),
        _share(f"{suite}, outside the catalogue: said so", outside, _outcome("right")),
        _share(f"{suite}, faults: confident wrong cause", faults, _flag("confident_wrong")),
        _share(
            f"{suite}, right: the value inside its 95 % interval",
            _known("inside", faults),
            _flag("inside"),
        ),
        _share(f"{suite}: errors", own, _outcome("error")),
    ]


def _blind(rows: Sequence[Row]) -> list[Measure]:
    own = [row for row in rows if row["suite"] == "blind"]
    single = [row for row in own if row["kind"] == "single" and row["truth"]["visible"]]
    several = [row for row in own if row["kind"] == "several"]
    return [
        _share(
            "blind, one effect at 2 x floor or more: right, first",
            single,
            _outcome("right"),
            ">= 90 %",
        ),
        _share("... or honest equivalent", single, GOOD),
        _share("blind, two effects: both named", several, _flag("all_named")),
        _share(
            "blind, nothing wrong: a false cause",
            [row for row in own if row["kind"] == "nothing"],
            _outcome("false cause"),
            "<= 5 %",
        ),
        _share(
            "blind, outside the catalogue: said so",
            [row for row in own if row["kind"] == "outside"],
            _outcome("right"),
            ">= 80 %",
        ),
        _share(
            "blind, right: the value inside its 95 % interval",
            _known("inside", own),
            _flag("inside"),
            "90-98 %",
        ),
        _share("blind: errors", own, _outcome("error")),
    ]


def table(rows: Sequence[Row]) -> str:
    """The measures of development cases, held-out cases and all, in Markdown.

    Args:
        rows: one a case.

    Returns:
        The Markdown.
    """
    columns = {
        "development": [row for row in rows if row["split"] == "development"],
        "held out": [row for row in rows if row["split"] == "held out"],
        "all": list(rows),
    }
    counted = {name: {m.name: m for m in _all(chosen)} for name, chosen in columns.items()}
    lines = [
        f"| measure | {' | '.join(columns)} | 95 % interval of all | target |",
        "|---" * (len(columns) + 3) + "|",
    ]
    for name, measure in counted["all"].items():
        if not measure.of:
            continue
        cells = [_cell(counted[column][name]) for column in columns]
        low, high = measure.interval
        lines.append(
            f"| {name} | {' | '.join(cells)} | {low:.0%} .. {high:.0%} | {measure.target or '-'} |"
        )
    for suite in dict.fromkeys(row["suite"] for row in rows):
        seconds = [row["seconds"] for row in rows if row["suite"] == suite]
        lines.append(
            f"| {suite}, seconds a diagnosis: median, largest, all | - | - | "
            f"{median(seconds):.1f}, {max(seconds):.1f}, {sum(seconds):.0f} | - | - |"
        )
    return "\n".join(lines) + "\n"


def _all(rows: Sequence[Row]) -> list[Measure]:
    return [*_real(rows), *_added("drawn", rows), *_added("newcomers", rows), *_blind(rows)]


def _cell(measure: Measure) -> str:
    return f"{measure.hits} of {measure.of}" if measure.of else "-"


def case_table(rows: Sequence[Row]) -> str:
    """One line a case, in Markdown.

    Args:
        rows: one a case.

    Returns:
        The Markdown.
    """
    lines = [
        "| case | split | truth | said | p | outcome | beside | inside | s |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    marks = {True: "yes", False: "no", None: "-"}
    for row in rows:
        score = row["score"]
        probability = "-" if score["probability"] is None else f"{score['probability']:.2f}"
        outcome = score["outcome"] + (", confident" if score["confident_wrong"] else "")
        lines.append(
            f"| {row['name']} | {row['split']} | {row['truth']['text']} | {score['said']} | "
            f"{probability} | {outcome} | {marks[score['untrue_beside']]} | "
            f"{marks[score['inside']]} | {row['seconds']:.1f} |"
        )
    return "\n".join(lines) + "\n"
