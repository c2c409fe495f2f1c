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
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.validation.blind.trial import CASES, DIAGNOSES, FAILED, KEY, read_seal
from hyperleg_design.validation.blind.view import Miss, View
from hyperleg_design.writing import write_json

SCORED = "scored.json"
SIZABLE = 2.0
"""Multiple of the floor from which a single cause must be found."""
BINS = 5
"""Of equal width, of the stated probability."""
RESAMPLES = 4000
"""Of the bootstrap."""


@dataclass(frozen=True)
class Row:
    """One line of the target table."""

    measure: str
    value: float | None
    """None where no case speaks of it."""
    low: float | None
    high: float | None
    """95 % interval: Wilson's for shares, bootstrap else."""
    cases: int
    target: str
    reached: bool | None
    """None where no case speaks of it or no target is set."""


@dataclass(frozen=True)
class Score:
    """What a trial says."""

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
        """Row of a measure."""
        return next(row for row in self.rows if row.measure == measure)

    def markdown(self) -> str:
        """The table, the effects one by one, and the misses."""
        lines = [
            "| measure | value | 95 % interval | cases | target | |",
            "|---|---|---|---|---|---|",
        ]
        for row in self.rows:
            value, interval = (
                _shown(row.value),
                "-"
                if row.low is None or row.high is None
                else f"{_shown(row.low)} .. {_shown(row.high)}",
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
    """
    views = [View(t, d) for t, d in zip(truths, diagnoses, strict=True)]
    single = [v for v in views if v.kind == "single"]
    sizable = [v for v in single if v.multiple >= SIZABLE]
    found = [v for v in sizable if v.first(lenient=True)]
    shown, hidden = (
        [v for v in sizable if v.shown is not None and v.shown == large] for large in (True, False)
    )
    null, outside, both = (
        [v for v in views if v.kind == k] for k in ("null", "outside", "compound")
    )
    rows = [
        _share(
            "right effect, single cause at >= 2 x floor, first", [v.first() for v in sizable], 0.90
        ),
        _share("... or in one set with the first", [v.first(lenient=True) for v in sizable], None),
        _share("... among the first two", [v.top_two() for v in sizable], 0.97),
        _share(
            "... first, of those no smaller than what the diagnosis says its logs show",
            [v.first() for v in shown],
            None,
        ),
        _share("... among the first two, of the same", [v.top_two() for v in shown], None),
        _share("... first, of those smaller than that", [v.first() for v in hidden], None),
        _share("right location, where the effect is right", [v.located() for v in found], 0.95),
        _share("... of all single causes at >= 2 x floor", [v.located() for v in sizable], None),
        _share("false alarm when nothing is wrong", [v.alarm for v in null], 0.05, most=True),
        _share(
            "unknown on effects outside the catalogue, at >= 2 x floor",
            [v.verdict == "unknown" for v in outside if v.multiple >= SIZABLE],
            0.80,
        ),
        _share("... of any size", [v.verdict == "unknown" for v in outside], None),
        _share(
            "confident wrong cause on effects outside the catalogue",
            [v.verdict == "explained" for v in outside],
            None,
            most=True,
        ),
        _share(
            "both found when two act, each at >= 2 x floor",
            [v.all_found() for v in both if v.least >= SIZABLE],
            0.70,
        ),
        _share(
            "... at least one of them", [v.any_found() for v in both if v.least >= SIZABLE], None
        ),
        _share("... both, of any size", [v.all_found() for v in both], None),
        _calibration(views),
        _coverage(found),
        _median(
            "excess gap closed on held-out logs, named single cause, median",
            [v.closed for v in sizable if v.first()],
            0.80,
        ),
        _median("seconds a diagnosis, median", [s for s in seconds if s is not None], None),
        _share(
            "diagnoses that raised an error", [v.verdict == FAILED for v in views], None, most=True
        ),
        _share(
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


def wilson(hits: int, cases: int) -> tuple[float, float]:
    """95 % interval of a share (Wilson, 1927)."""
    z = 1.959964
    share = hits / cases
    middle = (share + z * z / (2 * cases)) / (1 + z * z / cases)
    half = (
        z / (1 + z * z / cases) * np.sqrt(share * (1 - share) / cases + z * z / (4 * cases * cases))
    )
    return float(max(middle - half, 0.0)), float(min(middle + half, 1.0))


def calibration_error(probability: np.ndarray, right: np.ndarray) -> float:
    """Expected nuisance parameter: mean distance of stated probability and share of right ones over
    `BINS` bins, weighted by cases.
    """
    place = np.minimum((probability * BINS).astype(int), BINS - 1)
    return float(
        sum(
            abs(probability[place == k].mean() - right[place == k].mean()) * (place == k).mean()
            for k in range(BINS)
            if (place == k).any()
        )
    )


def _share(measure: str, hits: Sequence[bool], target: float | None, *, most: bool = False) -> Row:
    aim = "-" if target is None else f"{'<=' if most else '>='} {target:.0%}"
    if not hits:
        return Row(measure, None, None, None, 0, aim, None)
    value = sum(hits) / len(hits)
    reached = None if target is None else (value <= target if most else value >= target)
    return Row(measure, value, *wilson(sum(hits), len(hits)), len(hits), aim, reached)


def _calibration(views: Sequence[View]) -> Row:
    stated = [(v.probability, v.right()) for v in views if v.probability is not None]
    measure, aim = "expected calibration error of the stated probability", "<= 0.05"
    if not stated:
        return Row(measure, None, None, None, 0, aim, None)
    probability, right = (
        np.array([p for p, _ in stated], float),
        np.array([r for _, r in stated], float),
    )
    value = calibration_error(probability, right)
    low, high = _bootstrap(
        len(stated), lambda rows: calibration_error(probability[rows], right[rows])
    )
    return Row(measure, value, low, high, len(stated), aim, value <= 0.05)


def _coverage(views: Sequence[View]) -> Row:
    groups = [held for v in views if (held := v.intervals())]
    measure, aim = "95 % parameter intervals that hold the truth", "90-98 %"
    if not groups:
        return Row(measure, None, None, None, 0, aim, None)
    value = float(np.mean(np.concatenate(groups)))
    low, high = _bootstrap(
        len(groups), lambda rows: float(np.mean(np.concatenate([groups[i] for i in rows])))
    )
    return Row(measure, value, low, high, len(groups), aim, 0.90 <= value <= 0.98)


def _median(measure: str, values: Sequence[float | None], target: float | None) -> Row:
    known = np.array([v for v in values if v is not None], float)
    aim = "-" if target is None else f">= {target:.0%}"
    if not known.size:
        return Row(measure, None, None, None, 0, aim, None)
    value = float(np.median(known))
    low, high = _bootstrap(known.size, lambda rows: float(np.median(known[rows])))
    return Row(
        measure, value, low, high, known.size, aim, None if target is None else value >= target
    )


def _bootstrap(count: int, statistic: Callable[[np.ndarray], float]) -> tuple[float, float]:
    rng = np.random.default_rng(0)
    values = [
        statistic(rng.integers(count, size=count))
        for _ in range(RESAMPLES if count < 200 else RESAMPLES // 4)
    ]
    return float(np.percentile(values, 2.5)), float(np.percentile(values, 97.5))


def _read(path: Path, otherwise: dict[str, Any]) -> dict[str, Any]:
    if not path.is_file():
        return otherwise
    content: dict[str, Any] = json.loads(path.read_text())
    return content


def _shown(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"


__all__ = [
    "CASES",
    "Miss",
    "Row",
    "Score",
    "calibration_error",
    "compared",
    "open_key",
    "score",
    "wilson",
]
