"""Other tools on the cases of a blind trial: the gap each closes on a held-out log, the cause each
would name, and its time.

Every method fits `drive_set`'s parameters to all logs of a case but the last, which is replayed
afterwards. The gap is the RMS of the whole-log position error there, in one simulator
(`population`); the floor is that of reference logs where a case has some, else 0. A fixed set names
the parameter that it changed most, over its spread as a nuisance parameter, and nothing below
`NAMED`. Cases with a floating base or without targets and gains are outside what these methods do,
and are listed as such.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import HyperlegError, InputError
from hyperleg_design.gap.logs.log import read_log
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.validation.baselines.drive_set import DriveSet, Fitted, check_logs, drive_set
from hyperleg_design.validation.baselines.own import fit_own
from hyperleg_design.validation.baselines.pace import fit_pace
from hyperleg_design.validation.baselines.population import position_gap
from hyperleg_design.validation.baselines.sysid import fit_sysid
from hyperleg_design.validation.blind.score import SCORED, open_key
from hyperleg_design.validation.blind.trial import CASES, DIAGNOSES, read_seal
from hyperleg_design.writing import write_json, write_text

METHODS = ("diagnosis", "own", "sysid", "pace")
"""`diagnosis` is what the trial's folder already holds; `own` fits the same parameters as the other
two."""
FIXED = ("own", "sysid", "pace")
NAMED = 3.0
"""Usual nuisance parameters from which a fixed set names a cause."""
BUDGET = 300.0
"""Of one fit [s]."""


@dataclass(frozen=True)
class Entry:
    """One method on one case."""

    case: str
    method: str
    effect: str
    location: str
    """Cause named; empty where none is."""
    before: float | None
    after: float | None
    floor: float | None
    """Position error on the held-out log [rad]; of `diagnosis`, in the unit of its own gap."""
    closed: float | None
    """Share of the excess [-]."""
    seconds: float | None
    stopped: str
    """Why a fit ended, or why there is none."""
    right: bool | None = None
    """Whether the cause named is one that acts (none, where none acts); None while the trial's key
    is sealed."""


@dataclass(frozen=True)
class Table:
    """All methods on all cases."""

    entries: tuple[Entry, ...]
    budget: float
    truth: tuple[tuple[str, str], ...]
    """Kind and effects of each case; empty while the key is sealed."""

    def rows(self) -> list[dict[str, Any]]:
        """One summary a method: cases, median and quartiles of the gap closed, share of right
        causes, median time.
        """
        rows = []
        for method in METHODS:
            mine = [e for e in self.entries if e.method == method]
            done = [e for e in mine if e.seconds is not None]
            if not mine:
                continue
            closed = np.array([e.closed for e in done if e.closed is not None])
            judged = [e.right for e in done if e.right is not None]
            rows.append(
                {
                    "method": method,
                    "cases": len(mine),
                    "done": len(done),
                    "closed": [float(v) for v in np.percentile(closed, [25, 50, 75])]
                    if len(closed)
                    else None,
                    "right": float(np.mean(judged)) if judged else None,
                    "judged": len(judged),
                    "seconds": float(np.median([e.seconds for e in done])) if done else None,
                    "out_of_time": sum(e.stopped.endswith(" s") for e in done),
                }
            )
        return rows

    def markdown(self) -> str:
        """Summary and every case."""
        lines = [
            "| method | cases | gap closed on held-out logs, median (quartiles) | right cause | "
            "time, median | out of time |",
            "|---|---|---|---|---|---|",
        ]
        for row in self.rows():
            closed = (
                "-"
                if row["closed"] is None
                else f"{100 * row['closed'][1]:.0f} % ({100 * row['closed'][0]:.0f} .. "
                f"{100 * row['closed'][2]:.0f})"
            )
            right = (
                "sealed"
                if row["right"] is None
                else f"{100 * row['right']:.0f} % of {row['judged']}"
            )
            taken = "-" if row["seconds"] is None else f"{row['seconds']:.1f} s"
            lines.append(
                f"| {row['method']} | {row['done']} of {row['cases']} | {closed} | {right} | "
                f"{taken} | {row['out_of_time']} |"
            )
        truth = dict(self.truth)
        lines += [
            "",
            f"Budget {self.budget:g} s a fit.",
            "",
            "| case | truth | method | named | closed | before, after | time | |",
            "|---|---|---|---|---|---|---|---|",
        ]
        for e in self.entries:
            named = f"{e.effect} at {e.location}" if e.effect else "none"
            closed = "-" if e.closed is None else f"{100 * e.closed:.0f} %"
            gap = "-" if e.before is None or e.after is None else f"{e.before:.3g}, {e.after:.3g}"
            mark = "" if e.right is None else "right" if e.right else "wrong"
            lines.append(
                f"| {e.case} | {truth.get(e.case, 'sealed')} | {e.method} | "
                f"{named if e.seconds is not None else '-'} | {closed} | {gap} "
                f"| {'-' if e.seconds is None else f'{e.seconds:.1f} s'} | {mark} {e.stopped} |"
            )
        return "\n".join(lines) + "\n"


def baselines_table(
    folder: str | os.PathLike[str],
    *,
    methods: Sequence[str] = METHODS,
    cases: Sequence[str] = (),
    budget: float = BUDGET,
    seed: int = 0,
    progress: bool = False,
) -> Table:
    """Run the methods on the cases of a trial, and write `baselines.json` and `baselines.md`.

    Right causes are told once the trial has been scored: before, its key stays sealed.

    Args:
        folder: of a finished blind trial.
        methods: of `METHODS`.
        cases: their names, such as 003; all by default.
        budget: of each fit [s].
        seed: of CMA-ES.
        progress: show a bar.

    Raises:
        InputError: no finished trial, an unknown method or case.
    """
    from tqdm import tqdm

    folder = Path(folder)
    seal = read_seal(folder)
    known = [f"{i:03d}" for i in range(seal.cases)]
    unknown = [m for m in methods if m not in METHODS] or [c for c in cases if c not in known]
    if unknown or not methods:
        raise InputError(
            "baselines",
            "methods or cases",
            unknown,
            f"expects methods of {', '.join(METHODS)} and cases of {known[0]} .. {known[-1]}",
        )
    truths = {t["case"]: t for t in open_key(folder)} if (folder / SCORED).is_file() else {}
    entries: list[Entry] = []
    for name in tqdm(list(cases) or known, desc="baselines", disable=not progress):
        entries += case_entries(
            folder, name, methods, budget=budget, seed=seed, truth=truths.get(name)
        )
    truths_in_words = tuple(
        (name, _in_words(truths[name])) for name in (list(cases) or known) if name in truths
    )
    table = Table(tuple(entries), budget, truths_in_words)
    write_json(
        folder / "baselines.json",
        {"budget": budget, "summary": table.rows(), "entries": [asdict(e) for e in entries]},
    )
    write_text(folder / "baselines.md", table.markdown())
    return table


def case_entries(
    folder: Path,
    name: str,
    methods: Sequence[str],
    *,
    budget: float,
    seed: int = 0,
    truth: dict[str, Any] | None = None,
) -> list[Entry]:
    """All methods on one case.

    Args:
        folder: of the trial.
        name: of the case.
        methods: their names.
        budget: time that each method has [s].
        seed: of their randomness.
        truth: what is wrong, if the key is open.

    Returns:
        One entry a method.
    """
    entries = [_of_diagnosis(folder, name, truth)] if "diagnosis" in methods else []
    fixed = [m for m in FIXED if m in methods]
    if not fixed:
        return entries
    try:
        train, held, healthy, drives = open_case(folder / CASES / name)
        nothing = np.zeros(drives.count)
        before = float(position_gap(held, drives, nothing)[0])
        floor = float(position_gap(healthy, drives, nothing)[0]) if healthy else 0.0
    except HyperlegError as error:
        return entries + [
            Entry(name, m, "", "", None, None, None, None, None, str(error)) for m in fixed
        ]
    for method in fixed:
        try:
            fitted = _fit(method)(train, drives, budget, seed)
        except HyperlegError as error:
            entries.append(Entry(name, method, "", "", before, None, floor, None, None, str(error)))
            continue
        after = float(position_gap(held, drives, fitted.values)[0])
        effect, location, size = drives.cause(fitted.values)
        if size < NAMED:
            effect = location = ""
        excess = before - floor
        closed = (before - after) / excess if excess > 0 and np.isfinite(after) else None
        entries.append(
            Entry(
                name,
                method,
                effect,
                location,
                before,
                after if np.isfinite(after) else None,
                floor,
                closed,
                fitted.seconds,
                fitted.stopped,
                _right(effect, location, truth),
            )
        )
    return entries


def _fit(method: str) -> Callable[[Sequence[Signals], DriveSet, float, int], Fitted]:
    return {
        "own": lambda train, drives, budget, seed: fit_own(train, drives),
        "sysid": lambda train, drives, budget, seed: fit_sysid(train, drives, seconds=budget),
        "pace": lambda train, drives, budget, seed: fit_pace(
            train, drives, seed=seed, seconds=budget
        ),
    }[method]


def open_case(case: Path) -> tuple[list[Signals], list[Signals], list[Signals], DriveSet]:
    """Logs to fit, the held-out one, references, and the parameters of the robot of one case of a
    trial.

    Args:
        case: folder of the case.

    Returns:
        The four of them.

    Raises:
        InputError: a robot or logs that these methods cannot take.
    """
    entry = json.loads((case / "case.json").read_text())
    logs = [read_log(case / path) for path in entry["logs"]]
    references = [read_log(case / path) for path in entry["references"]]
    own = case / entry["robot"]
    subject = load_subject(str(own) if own.is_file() else entry["robot"], [*logs, *references])
    signals = [condition(log, subject) for log in logs]
    drives = drive_set(signals[0].subject, signals[0].step)
    check_logs(signals)
    if len(signals) < 2:
        raise InputError(
            case.name, "logs", len(signals), "expects at least two logs: one is held out"
        )
    return signals[:-1], signals[-1:], [condition(log, subject) for log in references], drives


def _of_diagnosis(folder: Path, name: str, truth: dict[str, Any] | None) -> Entry:
    place = folder / DIAGNOSES / name
    try:
        diagnosis = json.loads((place / "diagnosis.json").read_text())
        seconds = float(json.loads((place / "seconds.json").read_text())["seconds"])
        gap = diagnosis["gap"]
    except (OSError, ValueError, KeyError, TypeError):
        return Entry(
            name,
            "diagnosis",
            "",
            "",
            None,
            None,
            None,
            None,
            None,
            "no diagnosis in the trial's folder",
        )
    causes = diagnosis.get("causes") or []
    effect, location = (
        (str(causes[0]["effect"]), str(causes[0]["location"])) if causes else ("", "")
    )
    before, after, floor, closed = (
        None if gap.get(k) is None else float(gap[k])
        for k in ("before", "after", "floor", "closed")
    )
    right = _right(effect, location, truth)
    return Entry(
        name,
        "diagnosis",
        effect,
        location,
        before,
        after,
        floor,
        closed,
        seconds,
        str(diagnosis["verdict"]),
        right,
    )


def _right(effect: str, location: str, truth: dict[str, Any] | None) -> bool | None:
    """Whether a cause acts; with none listed in the truth, whether none was named."""
    if truth is None:
        return None
    listed = [w for w in truth["wrongs"] if w["listed"]]
    if not listed:
        return not effect
    return any(effect == w["effect"] and location in (w["location"], *w["also"]) for w in listed)


def _in_words(truth: dict[str, Any]) -> str:
    wrongs = ", ".join(
        f"{w['effect']} at {w['location']} {w['multiple']:.1f}x" for w in truth["wrongs"]
    )
    return f"{truth['kind']}: {wrongs}" if wrongs else str(truth["kind"])
