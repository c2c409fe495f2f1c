"""Run the benchmark case by case; a run that was stopped goes on where it was.

| in the folder | |
|---|---|
| `cases/NAME.json` | version, truth, answer and seconds of one case |
| `results.json` | all cases that are done, scored, without the long parts of the answers |
| `table.md` | the measures, and one line a case |
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from hyperleg_design.errors import HyperlegError, InputError
from hyperleg_design.reading import read_json
from hyperleg_design.validation.benchmark.adapter import FAILED, checked_checkout, diagnose_folder
from hyperleg_design.validation.benchmark.blind_cases import blind_cases
from hyperleg_design.validation.benchmark.case import SPLITS, SUITES, Case, Fault, Truth, write_case
from hyperleg_design.validation.benchmark.measures import case_table, table
from hyperleg_design.validation.benchmark.scoring import VERSION, score
from hyperleg_design.validation.newcomers.cases import newcomer_cases
from hyperleg_design.validation.newcomers.crane_cases import crane_cases
from hyperleg_design.validation.newcomers.quadruped_cases import quadruped_cases
from hyperleg_design.validation.newcomers.servo_cases import servo_cases
from hyperleg_design.validation.real.cases import real_cases
from hyperleg_design.validation.real.drawn import drawn_cases
from hyperleg_design.validation.real.tiago import tiago_cases
from hyperleg_design.validation.spread import spread
from hyperleg_design.writing import MARKER, check_output_folder, write_json, write_text

KEPT = ("schema", "verdict", "gap", "causes", "rivals", "equivalent", "remainder", "message")
"""Parts of an answer that the results hold."""


@dataclass(frozen=True)
class Outcome:
    """Scored and skipped cases of a run."""

    rows: tuple[dict[str, Any], ...]
    """A scored case each, in the order of the benchmark."""
    skipped: tuple[str, ...]
    """What could not be run, with the reason."""
    remarks: tuple[str, ...]
    """Result files that were unreadable or of another version, and were made anew."""

    def markdown(self) -> str:
        """The table of measures, and what was skipped."""
        lines = [table(self.rows)] if self.rows else ["No case was run.\n"]
        lines += [f"Skipped: {reason}\n" for reason in self.skipped]
        return "\n".join(lines)


def all_cases() -> list[Case]:
    """Every case of this version."""
    newcomers = newcomer_cases, crane_cases, servo_cases, quadruped_cases
    suites = real_cases, drawn_cases, tiago_cases, *newcomers, blind_cases
    cases = [case for suite in suites for case in suite()]
    names = [case.name for case in cases]
    assert len(set(names)) == len(names), "names of cases are unique"
    return cases


def chosen_cases(
    suites: Sequence[str] = SUITES, splits: Sequence[str] = SPLITS, only: Sequence[str] = ()
) -> list[Case]:
    """Cases of some suites and splits, whose names hold one of some texts.

    Args:
        suites: names of the suites.
        splits: names of the splits.
        only: texts, one of which a name must hold; all cases without.

    Returns:
        The cases.

    Raises:
        InputError: an unknown suite or split, or no case is left.
    """
    for key, asked, allowed in (("suites", suites, SUITES), ("splits", splits, SPLITS)):
        unknown = [name for name in asked if name not in allowed]
        if unknown or not asked:
            raise InputError("validate", key, list(asked), f"choose of {', '.join(allowed)}")
    cases = [
        case
        for case in all_cases()
        if case.suite in suites
        and case.split in splits
        and (not only or any(text in case.name for text in only))
    ]
    if not cases:
        raise InputError("validate", "only", list(only), "fits no case: see --list-cases")
    return cases


def run_benchmark(
    out: str | os.PathLike[str],
    cases: Sequence[Case],
    data: Path,
    *,
    checkout: Path | None = None,
    workers: int = 1,
    progress: bool = False,
) -> Outcome:
    """Run those cases that have no result yet, and score all.

    Args:
        out: folder of the results: new, empty, or of an earlier run of the same checkout.
        cases: to be run.
        data: folder of the real logs.
        checkout: folder that holds the `hyperleg_design` to be scored; by default this one.
        workers: processes side by side, each on one thread.
        progress: show a bar.

    Raises:
        InputError: no worker, or a checkout without a package.
        OutputError: `out` holds something else.
    """
    if workers < 1:
        raise InputError("validate", "workers", workers, "expects at least one")
    place = str(checked_checkout(checkout))
    folder = check_output_folder(out)
    (folder / "cases").mkdir(parents=True, exist_ok=True)
    (folder / MARKER).touch()
    skipped = _skipped(cases, data)
    runnable = [case for case in cases if not (case.needs and not (data / case.needs).is_dir())]
    remarks = [r for case in runnable if (r := _unusable(_file(folder, case))) is not None]
    waiting = [case for case in runnable if not _done(_file(folder, case))]
    arguments = [(case.name, str(folder), str(data), place) for case in waiting]
    _run(arguments, workers, len(runnable), progress)
    entries = [read_json(_file(folder, case)) for case in runnable]
    rows = [scored(entry) for entry in entries]
    made_by = next((e["diagnosis"].get("provenance") for e in entries), None)
    results = {"version": VERSION, "provenance": made_by, "skipped": skipped, "cases": rows}
    write_json(folder / "results.json", results)
    outcome = Outcome(tuple(rows), tuple(skipped), tuple(remarks))
    text = outcome.markdown() + ("\n" + case_table(rows) if rows else "")
    write_text(folder / "table.md", text)
    return outcome


def _run(arguments: Sequence[tuple[Any, ...]], workers: int, total: int, progress: bool) -> None:
    from tqdm import tqdm

    with tqdm(
        total=total, initial=total - len(arguments), desc="cases", disable=not progress, unit="case"
    ) as bar:
        for _ in spread(run_case, arguments, workers):
            bar.update()


def run_case(name: str, folder: str, data: str, checkout: str) -> None:
    """Make, diagnose and store one case of this version, by its name; nothing but the result is
    left behind.

    Args:
        name: of the case.
        folder: of the results.
        data: folder of real logs.
        checkout: folder of the version that diagnoses.
    """
    case = next(case for case in all_cases() if case.name == name)
    store(case, Path(folder), Path(data), Path(checkout))


def store(case: Case, folder: Path, data: Path, checkout: Path | None = None) -> None:
    """Make, diagnose and store one case.

    Args:
        case: the case.
        folder: of the results.
        data: folder of real logs.
        checkout: folder of the version that diagnoses; None for this one.
    """
    with tempfile.TemporaryDirectory() as work:
        try:
            material, truth = case.build(data)
            place = write_case(material, Path(work) / "case")
            diagnosis, seconds = diagnose_folder(place, checkout)
        except HyperlegError as error:
            truth, seconds = Truth(), 0.0
            diagnosis = {"verdict": FAILED, "message": f"the case cannot be made: {error}"}
    entry = {
        "version": VERSION,
        "name": case.name,
        "suite": case.suite,
        "split": case.split,
        "kind": case.kind,
        "truth": {**asdict(truth), "text": str(truth)},
        "diagnosis": diagnosis,
        "seconds": round(seconds, 2),
    }
    write_json(_file(folder, case), entry)


def _file(folder: Path, case: Case) -> Path:
    return folder / "cases" / f"{case.name}.json"


def _unusable(path: Path) -> str | None:
    """Why a result file that is there cannot be used; None where it can, or is not there."""
    if not path.is_file():
        return None
    try:
        entry = read_json(path)
        if not isinstance(entry, dict) or entry.get("version") != VERSION:
            version = entry.get("version") if isinstance(entry, dict) else None
            return f"{path.name} is of version {version}, not {VERSION}: made anew"
        scored(entry)
    except (HyperlegError, KeyError, TypeError, ValueError, AttributeError) as error:
        return f"{path.name} is unreadable and was made anew ({type(error).__name__}: {error})"
    return None


def _done(path: Path) -> bool:
    return path.is_file() and _unusable(path) is None


def scored(entry: dict[str, Any]) -> dict[str, Any]:
    """A scored case, from what its file holds; rules are applied anew at every reading.

    Args:
        entry: what its file holds.

    Returns:
        The scored case.
    """
    known = entry["truth"]
    truth = Truth(
        faults=tuple(
            Fault(
                fault["effect"],
                tuple(fault["places"]),
                dict(fault["parameters"]),
                tuple((effect, tuple(places)) for effect, places in fault["equivalents"]),
                fault["listed"],
            )
            for fault in known["faults"]
        ),
        references=known["references"],
        identified=known["identified"],
        everywhere=known["everywhere"],
        visible=known["visible"],
    )
    answer = {key: entry["diagnosis"][key] for key in KEPT if key in entry["diagnosis"]}
    keys = ("name", "suite", "split", "kind", "truth", "seconds")
    return {
        **{key: entry[key] for key in keys},
        "score": score(truth, answer).mapping(),
        "diagnosis": answer,
    }


def _skipped(cases: Sequence[Case], data: Path) -> list[str]:
    reasons: dict[str, int] = {}
    for case in cases:
        if case.needs and not (data / case.needs).is_dir():
            reasons[case.needs] = reasons.get(case.needs, 0) + 1
    return [
        f"{count} cases of {needs}: {data / needs} is absent; name the folder of the logs by "
        f"--data or HYPERLEG_DATA"
        for needs, count in reasons.items()
    ]
