"""The one scoring pass: open the key, check its seal, compare every diagnosis with the truth, write
the table with its misses.

A cause counts as named when it is the first of the causes (top-1), among the first two of causes
and rivals (top-2). The lenient count also takes a cause that stands in a set of `equivalent` ones
with the one named first: the diagnosis then said that these data cannot tell them apart.

Every diagnosis says how small a change of each parameter its logs would have shown (`sensitivity`).
Rows of what is shown count the single causes that are no smaller than that at their place; the rest
nobody could have named from these logs by these rules.
"""

from __future__ import annotations

import hashlib
import json
import os
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from hyperleg_design.errors import InputError
from hyperleg_design.validation.blind.score_rows import (
    Row,
    calibration_row,
    coverage_row,
    median_row,
    share_row,
)
from hyperleg_design.validation.blind.trial import DIAGNOSES, FAILED, KEY, read_seal
from hyperleg_design.validation.blind.view import Miss, View
from hyperleg_design.writing import write_json

SCORED = "scored.json"
SIZABLE = 2.0
"""Multiple of the floor from which a single cause must be found."""


@dataclass(frozen=True)
class Score:
    """Counts and rates of a blind trial's answers against its truth."""

    sha256: str
    cases: int
    seed: int
    diagnosed: int
    rows: tuple[Row, ...]
    misses: tuple[Miss, ...]
    by_effect: tuple[tuple[str, int, int, int], ...]
    """Effect, sizable single cases, named first, named first leniently."""
    reread: bool

    def row(self, measure: str) -> Row:
        """Row of a measure.

        Args:
            measure: its name.

        Returns:
            The row.
        """
        return next(row for row in self.rows if row.measure == measure)

    def markdown(self) -> str:
        """The table, the effects one by one, and the misses."""
        lines = [
            "| measure | value | 95 % interval | cases | target | |",
            "|---|---|---|---|---|---|",
        ]
        for row in self.rows:
            value = _shown(row.value)
            interval = (
                "-"
                if row.low is None or row.high is None
                else f"{_shown(row.low)} .. {_shown(row.high)}"
            )
            lines.append(
                f"| {row.measure} | {value} | {interval} | {row.cases} | {row.target} | "
                f"{_MARK[row.reached]} |"
            )
        lines += [
            "",
            "| effect, alone at >= 2 x floor | cases | named first | or in one set with it |",
            "|---|---|---|---|",
        ]
        lines += [
            f"| `{effect}` | {n} | {strict} | {lenient} |"
            for effect, n, strict, lenient in self.by_effect
        ]
        lines += [
            "",
            f"Misses ({len(self.misses)}):",
            "",
            "| case | kind | plant, robot | truth | said | probability | why |",
            "|---|---|---|---|---|---|---|",
        ]
        lines += [
            f"| {m.case} | {m.kind} | {m.plant}, {m.robot} | {m.truth} | {m.said} | "
            f"{_shown(m.probability)} | {m.why} |"
            for m in self.misses
        ]
        lines += [
            "",
            f"{self.cases} cases, seed {self.seed}, SHA-256 of the key "
            f"{self.sha256}{'; read again' if self.reread else ''}.",
        ]
        return "\n".join(lines) + "\n"


_MARK = {True: "reached", False: "missed", None: "-"}


def score(folder: str | os.PathLike[str], *, reread: bool = False, partial: bool = False) -> Score:
    """Open the key of a trial once and score every diagnosis.

    Args:
        folder: of the trial.
        reread: the trial was scored before and its table is wanted again.
        partial: score although cases lack a diagnosis; they count as misses.

    Raises:
        InputError: no finished trial, a key that is not the sealed one, a trial scored before,
        missing diagnoses.
    """
    folder = Path(folder)
    seal = read_seal(folder)
    done = (folder / SCORED).is_file()
    if done and not reread:
        raise InputError(
            str(folder),
            SCORED,
            None,
            "was scored already, and a key is opened once; read its table again with reread",
        )
    names = [f"{i:03d}" for i in range(seal.cases)]
    missing = [n for n in names if not (folder / DIAGNOSES / n / "seconds.json").is_file()]
    if missing and not partial:
        raise InputError(
            str(folder),
            DIAGNOSES,
            len(missing),
            f"cases lack a diagnosis (first {missing[0]}); diagnose them before the key is opened",
        )
    truths = open_key(folder)
    diagnoses = [
        _read(
            folder / DIAGNOSES / n / "diagnosis.json",
            {"verdict": FAILED, "message": "no diagnosis"},
        )
        for n in names
    ]
    seconds = [_read(folder / DIAGNOSES / n / "seconds.json", {}).get("seconds") for n in names]
    result = compared(
        truths,
        diagnoses,
        seconds,
        sha256=seal.sha256,
        seed=seal.seed,
        diagnosed=len(names) - len(missing),
        reread=done,
    )
    if not done:
        write_json(folder / SCORED, asdict(result))
    return result


def open_key(folder: Path) -> list[dict[str, Any]]:
    """The truth of every case, after the seal has been checked.

    Args:
        folder: of the trial.

    Returns:
        The truths.

    Raises:
        InputError: the key is missing or not the one that was sealed.
    """
    seal = read_seal(folder)
    try:
        content = (folder / KEY).read_bytes()
    except OSError as error:
        raise InputError(str(folder), KEY, None, f"cannot be read ({error.strerror})") from None
    if hashlib.sha256(content).hexdigest() != seal.sha256:
        raise InputError(
            str(folder),
            KEY,
            None,
            "is not the key that was sealed: its SHA-256 differs from seal.json's",
        )
    with zipfile.ZipFile(folder / KEY) as archive:
        cases: list[dict[str, Any]] = json.loads(archive.read("key.json"))["cases"]
    return cases


def compared(
    truths: Sequence[Mapping[str, Any]],
    diagnoses: Sequence[Mapping[str, Any]],
    seconds: Sequence[float | None],
    *,
    sha256: str = "",
    seed: int = 0,
    diagnosed: int | None = None,
    reread: bool = False,
) -> Score:
    """Score of diagnoses (as in `diagnosis.json`) against truths (as in the key), in the same
    order.

    Args:
        truths: as in the key.
        diagnoses: as in `diagnosis.json`, in the same order.
        seconds: that each took, if known [s].
        sha256: of the key.
        seed: of the trial.
        diagnosed: how many cases were diagnosed; all by default.
        reread: whether the key had been opened before.

    Returns:
        The score.
    """
    views = [View(t, d) for t, d in zip(truths, diagnoses, strict=True)]
    single = [v for v in views if v.kind == "single"]
    sizable = [v for v in single if v.multiple >= SIZABLE]
    right = [v for v in sizable if v.first(lenient=True)]
    shown, hidden = (
        [v for v in sizable if v.shown is not None and v.shown == large] for large in (True, False)
    )
    null, outside, both = (
        [v for v in views if v.kind == k] for k in ("null", "outside", "compound")
    )
    rows = [
        share_row(
            "right effect, single cause at >= 2 x floor, first", [v.first() for v in sizable], 0.90
        ),
        share_row(
            "... or in one set with the first", [v.first(lenient=True) for v in sizable], None
        ),
        share_row("... among the first two", [v.top_two() for v in sizable], 0.97),
        share_row(
            "... first, of those no smaller than what the diagnosis says its logs show",
            [v.first() for v in shown],
            None,
        ),
        share_row("... among the first two, of the same", [v.top_two() for v in shown], None),
        share_row("... first, of those smaller than that", [v.first() for v in hidden], None),
        share_row("right location, where the effect is right", [v.located() for v in right], 0.95),
        share_row("... of all single causes at >= 2 x floor", [v.located() for v in sizable], None),
        share_row("false alarm when nothing is wrong", [v.alarm for v in null], 0.05, most=True),
        share_row(
            "unknown on effects outside the catalogue, at >= 2 x floor",
            [v.verdict == "unknown" for v in outside if v.multiple >= SIZABLE],
            0.80,
        ),
        share_row("... of any size", [v.verdict == "unknown" for v in outside], None),
        share_row(
            "confident wrong cause on effects outside the catalogue",
            [v.verdict == "explained" for v in outside],
            None,
            most=True,
        ),
        share_row(
            "both found when two act, each at >= 2 x floor",
            [v.all_found() for v in both if v.least >= SIZABLE],
            0.70,
        ),
        share_row(
            "... at least one of them", [v.any_found() for v in both if v.least >= SIZABLE], None
        ),
        share_row("... both, of any size", [v.all_found() for v in both], None),
        calibration_row(views),
        coverage_row(right),
        median_row(
            "excess gap closed on held-out logs, named single cause, median",
            [v.closed for v in sizable if v.first()],
            0.80,
        ),
        median_row("seconds a diagnosis, median", [s for s in seconds if s is not None], None),
        share_row(
            "diagnoses that raised an error", [v.verdict == FAILED for v in views], None, most=True
        ),
        share_row(
            "right effect, single cause below 2 x floor, first",
            [v.first() for v in single if v.multiple < SIZABLE],
            None,
        ),
    ]
    effects = sorted({v.effects[0] for v in sizable})
    by_effect = []
    for effect in effects:
        own = [v for v in sizable if v.effects[0] == effect]
        by_effect.append(
            (effect, len(own), sum(v.first() for v in own), sum(v.first(lenient=True) for v in own))
        )
    misses = [m for v in views if (m := v.miss()) is not None]
    return Score(
        sha256=sha256,
        cases=len(views),
        seed=seed,
        diagnosed=len(views) if diagnosed is None else diagnosed,
        rows=tuple(rows),
        misses=tuple(misses),
        by_effect=tuple(by_effect),
        reread=reread,
    )


def _read(path: Path, otherwise: dict[str, Any]) -> dict[str, Any]:
    if not path.is_file():
        return otherwise
    content: dict[str, Any] = json.loads(path.read_text())
    return content


def _shown(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"
