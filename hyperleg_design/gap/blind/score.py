"""The one scoring pass: open the key, check its seal, compare every diagnosis with the truth, write the table with its misses.

A cause counts as named when it is the first of the causes (top-1), among the first two of causes and rivals (top-2). The
lenient count also takes a cause that stands in a set of `equivalent` ones with the one named first: the diagnosis then said
that these data cannot tell them apart.

Every diagnosis says how small a change of each parameter its logs would have shown (`sensitivity`). Rows of what is shown count the
single causes that are no smaller than that at their place; the rest nobody could have named from these logs by these rules.
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
from hyperleg_design.gap.blind.trial import CASES, DIAGNOSES, FAILED, KEY, read_seal
from hyperleg_design.gap.diagnosis import NAMING
from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.sensitivity import RARELY
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
class Miss:
    """A case that was not answered rightly."""

    case: str
    kind: str
    plant: str
    robot: str
    truth: str
    """Effects, places and multiples."""
    said: str
    """Verdict and first causes."""
    probability: float | None
    """Of the first cause named."""
    why: str


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
        lines = ["| measure | value | 95 % interval | cases | target | |", "|---|---|---|---|---|---|"]
        for row in self.rows:
            value, interval = _shown(row.value), "-" if row.low is None or row.high is None else f"{_shown(row.low)} .. {_shown(row.high)}"
            lines.append(f"| {row.measure} | {value} | {interval} | {row.cases} | {row.target} | {_MARK[row.reached]} |")
        lines += ["", "| effect, alone at >= 2 x floor | cases | named first | or in one set with it |", "|---|---|---|---|"]
        lines += [f"| `{effect}` | {n} | {strict} | {lenient} |" for effect, n, strict, lenient in self.by_effect]
        lines += [
            "",
            f"Misses ({len(self.misses)}):",
            "",
            "| case | kind | plant, robot | truth | said | probability | why |",
            "|---|---|---|---|---|---|---|",
        ]
        lines += [
            f"| {m.case} | {m.kind} | {m.plant}, {m.robot} | {m.truth} | {m.said} | {_shown(m.probability)} | {m.why} |" for m in self.misses
        ]  # fmt: skip
        lines += ["", f"{self.cases} cases, seed {self.seed}, SHA-256 of the key {self.sha256}{'; read again' if self.reread else ''}."]
        return "\n".join(lines) + "\n"


_MARK = {True: "reached", False: "missed", None: "-"}


def score(folder: str | os.PathLike[str], *, reread: bool = False, partial: bool = False) -> Score:
    """Open the key of a trial once and score every diagnosis.

    Args:
        folder: of the trial.
        reread: the trial was scored before and its table is wanted again.
        partial: score although cases lack a diagnosis; they count as misses.

    Raises:
        InputError: no finished trial, a key that is not the sealed one, a trial scored before, missing diagnoses.
    """
    folder = Path(folder)
    seal = read_seal(folder)
    done = (folder / SCORED).is_file()
    if done and not reread:
        raise InputError(str(folder), SCORED, None, "was scored already, and a key is opened once; read its table again with reread")
    names = [f"{i:03d}" for i in range(seal.cases)]
    missing = [n for n in names if not (folder / DIAGNOSES / n / "seconds.json").is_file()]
    if missing and not partial:
        raise InputError(str(folder), DIAGNOSES, len(missing), f"cases lack a diagnosis (first {missing[0]}); diagnose them before the key is opened")
    truths = open_key(folder)
    diagnoses = [_read(folder / DIAGNOSES / n / "diagnosis.json", {"verdict": FAILED, "message": "no diagnosis"}) for n in names]
    seconds = [_read(folder / DIAGNOSES / n / "seconds.json", {}).get("seconds") for n in names]
    result = compared(truths, diagnoses, seconds, sha256=seal.sha256, seed=seal.seed, diagnosed=len(names) - len(missing), reread=done)
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
        raise InputError(str(folder), KEY, None, "is not the key that was sealed: its SHA-256 differs from seal.json's")
    with zipfile.ZipFile(folder / KEY) as archive:
        cases: list[dict[str, Any]] = json.loads(archive.read("key.json"))["cases"]
    return cases


def compared(
    truths: Sequence[Mapping[str, Any]], diagnoses: Sequence[Mapping[str, Any]], seconds: Sequence[float | None], *, sha256: str = "", seed: int = 0,
    diagnosed: int | None = None, reread: bool = False,
) -> Score:  # fmt: skip
    """Score of diagnoses (as in `diagnosis.json`) against truths (as in the key), in the same order."""
    views = [_View(t, d) for t, d in zip(truths, diagnoses, strict=True)]
    single = [v for v in views if v.kind == "single"]
    sizable = [v for v in single if v.multiple >= SIZABLE]
    found = [v for v in sizable if v.first(lenient=True)]
    shown, hidden = ([v for v in sizable if v.shown is not None and v.shown == large] for large in (True, False))
    null, outside, both = ([v for v in views if v.kind == k] for k in ("null", "outside", "compound"))
    rows = [
        _share("right effect, single cause at >= 2 x floor, first", [v.first() for v in sizable], 0.90),
        _share("... or in one set with the first", [v.first(lenient=True) for v in sizable], None),
        _share("... among the first two", [v.top_two() for v in sizable], 0.97),
        _share("... first, of those no smaller than what the diagnosis says its logs show", [v.first() for v in shown], None),
        _share("... among the first two, of the same", [v.top_two() for v in shown], None),
        _share("... first, of those smaller than that", [v.first() for v in hidden], None),
        _share("right location, where the effect is right", [v.located() for v in found], 0.95),
        _share("... of all single causes at >= 2 x floor", [v.located() for v in sizable], None),
        _share("false alarm when nothing is wrong", [v.alarm for v in null], 0.05, most=True),
        _share("unknown on effects outside the catalogue, at >= 2 x floor", [v.verdict == "unknown" for v in outside if v.multiple >= SIZABLE], 0.80),
        _share("... of any size", [v.verdict == "unknown" for v in outside], None),
        _share("confident wrong cause on effects outside the catalogue", [v.verdict == "explained" for v in outside], None, most=True),
        _share("both found when two act, each at >= 2 x floor", [v.all_found() for v in both if v.least >= SIZABLE], 0.70),
        _share("... at least one of them", [v.any_found() for v in both if v.least >= SIZABLE], None),
        _share("... both, of any size", [v.all_found() for v in both], None),
        _calibration(views),
        _coverage(found),
        _median("excess gap closed on held-out logs, named single cause, median", [v.closed for v in sizable if v.first()], 0.80),
        _median("seconds a diagnosis, median", [s for s in seconds if s is not None], None),
        _share("diagnoses that raised an error", [v.verdict == FAILED for v in views], None, most=True),
        _share("right effect, single cause below 2 x floor, first", [v.first() for v in single if v.multiple < SIZABLE], None),
    ]
    effects = sorted({v.effects[0] for v in sizable})
    by_effect = []
    for effect in effects:
        own = [v for v in sizable if v.effects[0] == effect]
        by_effect.append((effect, len(own), sum(v.first() for v in own), sum(v.first(lenient=True) for v in own)))
    misses = [m for v in views if (m := v.miss()) is not None]
    return Score(
        sha256=sha256, cases=len(views), seed=seed, diagnosed=len(views) if diagnosed is None else diagnosed, rows=tuple(rows), misses=tuple(misses),
        by_effect=tuple(by_effect), reread=reread,
    )  # fmt: skip


class _View:
    """One case's truth beside what was said."""

    def __init__(self, truth: Mapping[str, Any], diagnosis: Mapping[str, Any]) -> None:
        self.truth, self.diagnosis = truth, diagnosis
        self.kind, self.wrongs = str(truth["kind"]), list(truth["wrongs"])
        self.verdict = str(diagnosis.get("verdict", FAILED))
        self.causes = list(diagnosis.get("causes") or [])
        self.ranked = self.causes + list(diagnosis.get("rivals") or [])
        self.sets = [[_named(member) for member in group] for group in diagnosis.get("equivalent") or []]
        self.effects = [w["effect"] for w in self.wrongs]

    @property
    def multiple(self) -> float:
        return float(self.wrongs[0]["multiple"])

    @property
    def least(self) -> float:
        """Of the multiples of several effects."""
        return min(float(w["multiple"]) for w in self.wrongs)

    @property
    def alarm(self) -> bool:
        """Whether a cause was named."""
        return self.verdict in NAMING

    @property
    def shown(self) -> bool | None:
        """Whether the logs show an effect of this size at its place, by what the diagnosis says of them; None where it does not say.

        Sizes of several parameters add up as squares.
        """
        wrong, told = self.wrongs[0], self.diagnosis.get("sensitivity") or []
        sizes = {p.name: p.null for p in EFFECTS[wrong["effect"]].parameters if p.name in wrong["parameters"] and not p.shape}
        if not told or not sizes or wrong["effect"] in RARELY:
            return None
        here = [one for one in told if one["effect"] == wrong["effect"] and one["location"] in wrong["also"] and one["parameter"] in sizes]
        # what no possible size would show is in no list
        return bool(np.hypot.reduce([(wrong["parameters"][one["parameter"]] - sizes[one["parameter"]]) / one["change"] for one in here]) >= 1.0)

    def first(self, *, lenient: bool = False) -> bool:
        return bool(self.alarm and self.ranked and self._is(self.ranked[0]["effect"], self.effects[0], lenient))

    def top_two(self) -> bool:
        return bool(self.alarm and any(c["effect"] == self.effects[0] for c in self.ranked[:2])) or self.first(lenient=True)

    def located(self) -> bool:
        """Whether the first cause sits at the right place, or a set with it holds the right effect at the right place."""
        if not (self.alarm and self.ranked):
            return False
        if self.first():
            return self.ranked[0]["location"] in self.wrongs[0]["also"]
        return any(e == self.effects[0] and (not p or p in self.wrongs[0]["also"]) for g in self._with_first() for e, p in g)

    def all_found(self) -> bool:
        return all(self._found(w) for w in self.wrongs)

    def any_found(self) -> bool:
        return any(self._found(w) for w in self.wrongs)

    @property
    def closed(self) -> float | None:
        value = self.causes[0].get("closed") if self.causes else None
        return None if value is None else float(value)

    @property
    def probability(self) -> float | None:
        value = self.ranked[0].get("probability") if self.alarm and self.ranked else None
        return None if value is None else float(value)

    def right(self) -> bool:
        """Whether the first cause is true: an effect that acts, at its place."""
        return bool(self.ranked) and any(
            self.ranked[0]["effect"] == w["effect"] and self.ranked[0]["location"] in w["also"] for w in self.wrongs if w["listed"]
        )

    def intervals(self) -> list[bool]:
        """Of each parameter stated and known: whether its interval holds the truth."""
        wrong = self.wrongs[0]
        cause = next((c for c in self.ranked if c["effect"] == wrong["effect"] and c["location"] in wrong["also"]), None)
        held = []
        for name, value in (wrong["parameters"] if cause else {}).items():
            stated = cause["parameters"].get(name) if cause else None
            if stated and stated.get("low") is not None and stated.get("high") is not None:
                held.append(bool(stated["low"] <= value <= stated["high"]))
        return held

    def miss(self) -> Miss | None:
        why = self._why()
        if not why:
            return None
        truth = ", ".join(f"{w['effect']} at {w['location']} ({w['multiple']:.1f} x)" for w in self.wrongs) or "nothing"
        causes = said_of(self.diagnosis)
        said = f"{self.verdict}{': ' if causes else ''}{causes}"
        return Miss(str(self.truth["case"]), self.kind, str(self.truth["plant"]), str(self.truth["robot"]), truth, said, self.probability, why)

    def _why(self) -> str:
        if self.verdict == FAILED:
            return "error"
        if self.kind == "null":
            return "false alarm" if self.alarm else ""
        if self.kind == "outside":
            return "" if self.verdict == "unknown" else "not called unknown"
        if self.kind == "compound":
            return "" if self.all_found() else ("one of two found" if self.any_found() else "neither found")
        if not self.first(lenient=True):
            return "wrong effect" if self.alarm else "no cause named"
        return "" if self.located() else "wrong place"

    def _found(self, wrong: Mapping[str, Any]) -> bool:
        return self.alarm and any(c["effect"] == wrong["effect"] and c["location"] in wrong["also"] for c in self.causes)

    def _with_first(self) -> list[list[tuple[str, str]]]:
        first = (self.ranked[0]["effect"], self.ranked[0]["location"]) if self.ranked else ("", "")
        return [g for g in self.sets if any(e == first[0] and p in ("", first[1]) for e, p in g)]

    def _is(self, said: str, truth: str, lenient: bool) -> bool:
        return said == truth or (lenient and any(e == truth for g in self._with_first() for e, _ in g))


def said_of(diagnosis: Mapping[str, Any]) -> str:
    """The causes that were named, and what else it may be where that was said."""
    verdict = diagnosis.get("verdict")
    if verdict not in NAMING:
        return str(diagnosis.get("message", ""))
    causes, rivals = ([f"{c['effect']} at {c['location']}" for c in diagnosis.get(k) or []] for k in ("causes", "rivals"))
    return ", ".join(causes) + (f", or {rivals[0]}" if verdict == "ambiguous" and rivals else "")


def _named(member: Any) -> tuple[str, str]:
    """Effect and location of a member of an equivalence set: an object, a pair, or a text `effect@location` or `effect at location`."""
    if isinstance(member, Mapping):
        return str(member["effect"]), str(member.get("location", ""))
    if isinstance(member, str):
        effect, _, location = member.replace(" at ", "@").replace("/", "@").partition("@")
        return effect, location
    return str(member[0]), str(member[1]) if len(member) > 1 else ""


def wilson(hits: int, cases: int) -> tuple[float, float]:
    """95 % interval of a share (Wilson, 1927)."""
    z = 1.959964
    share = hits / cases
    middle = (share + z * z / (2 * cases)) / (1 + z * z / cases)
    half = z / (1 + z * z / cases) * np.sqrt(share * (1 - share) / cases + z * z / (4 * cases * cases))
    return float(max(middle - half, 0.0)), float(min(middle + half, 1.0))


def calibration_error(probability: np.ndarray, right: np.ndarray) -> float:
    """Expected calibration error: mean distance of stated probability and share of right ones over `BINS` bins, weighted by cases."""
    place = np.minimum((probability * BINS).astype(int), BINS - 1)
    return float(sum(abs(probability[place == k].mean() - right[place == k].mean()) * (place == k).mean() for k in range(BINS) if (place == k).any()))


def _share(measure: str, hits: Sequence[bool], target: float | None, *, most: bool = False) -> Row:
    aim = "-" if target is None else f"{'<=' if most else '>='} {target:.0%}"
    if not hits:
        return Row(measure, None, None, None, 0, aim, None)
    value = sum(hits) / len(hits)
    reached = None if target is None else (value <= target if most else value >= target)
    return Row(measure, value, *wilson(sum(hits), len(hits)), len(hits), aim, reached)


def _calibration(views: Sequence[_View]) -> Row:
    stated = [(v.probability, v.right()) for v in views if v.probability is not None]
    measure, aim = "expected calibration error of the stated probability", "<= 0.05"
    if not stated:
        return Row(measure, None, None, None, 0, aim, None)
    probability, right = np.array([p for p, _ in stated], float), np.array([r for _, r in stated], float)
    value = calibration_error(probability, right)
    low, high = _bootstrap(len(stated), lambda rows: calibration_error(probability[rows], right[rows]))
    return Row(measure, value, low, high, len(stated), aim, value <= 0.05)


def _coverage(views: Sequence[_View]) -> Row:
    groups = [held for v in views if (held := v.intervals())]
    measure, aim = "95 % parameter intervals that hold the truth", "90-98 %"
    if not groups:
        return Row(measure, None, None, None, 0, aim, None)
    value = float(np.mean(np.concatenate(groups)))
    low, high = _bootstrap(len(groups), lambda rows: float(np.mean(np.concatenate([groups[i] for i in rows]))))
    return Row(measure, value, low, high, len(groups), aim, 0.90 <= value <= 0.98)


def _median(measure: str, values: Sequence[float | None], target: float | None) -> Row:
    known = np.array([v for v in values if v is not None], float)
    aim = "-" if target is None else f">= {target:.0%}"
    if not known.size:
        return Row(measure, None, None, None, 0, aim, None)
    value = float(np.median(known))
    low, high = _bootstrap(known.size, lambda rows: float(np.median(known[rows])))
    return Row(measure, value, low, high, known.size, aim, None if target is None else value >= target)


def _bootstrap(count: int, statistic: Callable[[np.ndarray], float]) -> tuple[float, float]:
    rng = np.random.default_rng(0)
    values = [statistic(rng.integers(count, size=count)) for _ in range(RESAMPLES if count < 200 else RESAMPLES // 4)]
    return float(np.percentile(values, 2.5)), float(np.percentile(values, 97.5))


def _read(path: Path, otherwise: dict[str, Any]) -> dict[str, Any]:
    if not path.is_file():
        return otherwise
    content: dict[str, Any] = json.loads(path.read_text())
    return content


def _shown(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"


__all__ = ["CASES", "Miss", "Row", "Score", "calibration_error", "compared", "open_key", "score", "wilson"]
