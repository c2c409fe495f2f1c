"""The rules by which one answer is scored, frozen under `VERSION`.

Faults (in-catalogue) have exactly one outcome, the first of these that holds:

| outcome | the answer |
|---|---|
| `right` | `explained` or `ambiguous`, and the first cause is a true fault in its place |
| `equivalent` | the same, and the first cause is a stated equivalent of a true fault, or stands with one in a set of the answer's `equivalent` |
| `behind` | the same, and a true fault or equivalent is among the causes, behind an untrue one |
| `wrong` | any other `explained` or `ambiguous` answer |
| `unknown, led` | `unknown`, and a true fault or equivalent is among the first two rivals |
| `unknown` | any other `unknown` |
| `none` | `none` |
| `error` | the diagnosis raised an error, or took too long |

Where nothing is wrong: `right` is `none`; `false cause` is any cause in an `explained` or
`ambiguous` answer; `remainder` is any answer that has a `remainder` and no cause; else `unknown`.
Outside the catalogue: `right` is `unknown`, or `explained` or `ambiguous` with a `remainder` of at
least `MAIN_PART` of the gap; else `wrong` or `none`.

`confident_wrong` is counted beside the outcomes: an `explained` answer whose first cause is untrue
with a probability of at least `CONFIDENT`. Of an answer about references (`changed` or any other
field) nothing but verdict, causes, rivals, sets and remainder counts.

A cause at a place of `ALL_JOINTS`, or with a list `locations`, stands at all those joints at once.
"""  # noqa: E501

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hyperleg_design.validation.benchmark.adapter import FAILED
from hyperleg_design.validation.benchmark.case import Fault, Truth

VERSION = 6
"""Of the cases and of these rules together; 2 to 6 add cases and change none."""
NAMING = ("explained", "ambiguous")
"""Verdicts by which causes are named."""
CONFIDENT = 0.9
"""Probability from which a wrong cause counts as a confident one."""
MAIN_PART = 0.5
"""Share of the gap that a remainder must hold for an answer to say that something unlisted acts."""
LARGEST_SET = 6
"""Members of a set of causes that cannot be told apart, above which it says too little to count."""
ALL_JOINTS = ("joints", "all joints", "all", "everywhere", "motors", "all motors")
"""Places that mean every joint of the robot."""
OUTCOMES = (
    "right",
    "equivalent",
    "behind",
    "wrong",
    "false cause",
    "unknown, led",
    "unknown",
    "remainder",
    "none",
    "error",
)


@dataclass(frozen=True)
class Score:
    """What one answer is worth."""

    outcome: str
    """One of `OUTCOMES`."""
    confident_wrong: bool
    untrue_beside: bool | None
    """Of `right` and `equivalent` outcomes: whether a cause is named that is not true."""
    all_named: bool | None
    """Of faults: whether each is named, itself or an equivalent, among the causes."""
    inside: bool | None
    """Whether the stated 95 % intervals of the true parameters hold them; of `right` outcomes whose
    cause states an interval for a parameter that is known."""
    probability: float | None
    """Of the first cause."""
    remainder: float | None
    """Share of the gap that the answer leaves to no effect; None where it has no `remainder`."""
    closed: float | None
    """Share of the gap that the named causes close."""
    said: str
    """Verdict and causes, or the rivals of an `unknown`, in short."""

    def mapping(self) -> dict[str, Any]:
        """Give the score as `results.json` holds it."""
        return dict(vars(self))


def score(truth: Truth, diagnosis: Mapping[str, Any]) -> Score:
    """Score an answer in the form of `diagnosis.json` by the rules of this module.

    Args:
        truth: what is wrong.
        diagnosis: the answer.

    Returns:
        The score.
    """
    verdict = str(diagnosis.get("verdict", FAILED))
    naming = verdict in NAMING
    causes = list(diagnosis.get("causes") or []) if naming else []
    first = causes[0] if causes else None
    probability = None if first is None else float(first.get("probability") or 0.0)
    untrue_first = first is not None and not _honest(truth, first, diagnosis)
    outcome = _outcome(truth, diagnosis, verdict, causes)
    good = outcome in ("right", "equivalent")
    listed = truth.kind not in ("nothing", "outside")
    return Score(
        outcome=outcome,
        confident_wrong=(
            verdict == "explained" and untrue_first and (probability or 0.0) >= CONFIDENT
        ),
        untrue_beside=(
            any(not _honest(truth, cause, diagnosis) for cause in causes)
            if good and listed
            else None
        ),
        all_named=(
            all(any(_stands_for(fault, c, diagnosis) for c in causes) for fault in truth.faults)
            if listed
            else None
        ),
        inside=_inside(truth, causes) if outcome == "right" and listed else None,
        probability=probability,
        remainder=remainder_of(diagnosis),
        closed=_number(dict(diagnosis.get("gap") or {}).get("closed")) if naming else None,
        said=said(diagnosis),
    )


def _outcome(
    truth: Truth, diagnosis: Mapping[str, Any], verdict: str, causes: Sequence[Mapping[str, Any]]
) -> str:
    left = remainder_of(diagnosis)
    if verdict == FAILED:
        return "error"
    if truth.kind == "nothing":
        if causes:
            return "false cause"
        if verdict == "none":
            return "right"
        return "remainder" if left is not None and verdict != "unknown" else "unknown"
    if truth.kind == "outside":
        if verdict == "unknown" or (causes and (left or 0.0) >= MAIN_PART):
            return "right"
        return "wrong" if causes else "none"
    if verdict in NAMING and causes:
        if any(_is(fault, causes[0]) for fault in truth.faults):
            return "right"
        if _honest(truth, causes[0], diagnosis):
            return "equivalent"
        return "behind" if any(_honest(truth, c, diagnosis) for c in causes) else "wrong"
    if verdict == "none":
        return "none"
    rivals = list(diagnosis.get("rivals") or [])[:2]
    led = any(_same(fault, rival) for fault in truth.faults for rival in rivals)
    return "unknown, led" if led else "unknown"


def places_of(cause: Mapping[str, Any]) -> tuple[str, ...]:
    """Names of the places at which a cause stands.

    Args:
        cause: as an answer holds it.

    Returns:
        The names.
    """
    listed = cause.get("locations")
    places = [str(place) for place in listed] if isinstance(listed, list | tuple) else []
    location = str(cause.get("location", ""))
    return tuple(dict.fromkeys([*places, *location.replace(" and ", ", ").split(", ")]))


def _is(fault: Fault, cause: Mapping[str, Any]) -> bool:
    """Whether a cause is a fault, effect and place."""
    return _at(cause, fault.effect, fault.places)


def _same(fault: Fault, cause: Mapping[str, Any]) -> bool:
    """Whether a cause is a fault or one of its stated equivalents."""
    return _is(fault, cause) or any(_at(cause, e, places) for e, places in fault.equivalents)


def _at(cause: Mapping[str, Any], effect: str, places: Sequence[str]) -> bool:
    if cause.get("effect") != effect:
        return False
    stated = places_of(cause)
    return any(place in places or place in ALL_JOINTS for place in stated)


def _stands_for(fault: Fault, cause: Mapping[str, Any], diagnosis: Mapping[str, Any]) -> bool:
    """Whether a cause is a fault, a stated equivalent, or in one set of the answer with either."""
    if _same(fault, cause):
        return True
    return any(
        _among(cause, group) and any(_same(fault, member) for member in group)
        for group in _sets(diagnosis)
    )


def _honest(truth: Truth, cause: Mapping[str, Any], diagnosis: Mapping[str, Any]) -> bool:
    return any(_stands_for(fault, cause, diagnosis) for fault in truth.faults)


def _among(cause: Mapping[str, Any], group: Sequence[Mapping[str, Any]]) -> bool:
    return any(
        member.get("effect") == cause.get("effect")
        and str(member.get("location", "")) == str(cause.get("location", ""))
        for member in group
    )


def _sets(diagnosis: Mapping[str, Any]) -> Iterator[list[Mapping[str, Any]]]:
    for group in diagnosis.get("equivalent") or []:
        members = [member for member in group if isinstance(member, Mapping)]
        if len(members) <= LARGEST_SET:
            yield members


def _inside(truth: Truth, causes: Sequence[Mapping[str, Any]]) -> bool | None:
    """Whether the intervals of the first true cause hold each known parameter that they state."""
    for fault in truth.faults:
        cause = causes[0]
        if not _is(fault, cause):
            continue
        held = []
        for name, value in fault.parameters.items():
            stated = dict(cause.get("parameters") or {}).get(name) or {}
            low, high = _number(stated.get("low")), _number(stated.get("high"))
            if low is not None and high is not None:
                held.append(low <= value <= high)
        if held:
            return all(held)
    return None


def remainder_of(diagnosis: Mapping[str, Any]) -> float | None:
    """Share of the gap that an answer leaves to no effect: its field `remainder`, a number or a
    mapping with `share`; None where it has none.

    Args:
        diagnosis: the answer.

    Returns:
        The share, or None.
    """
    left = diagnosis.get("remainder")
    if isinstance(left, Mapping):
        left = left.get("share")
    return _number(left)


def _number(value: Any) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value)


def said(diagnosis: Mapping[str, Any]) -> str:
    """Verdict and causes, or the first two rivals of an `unknown`, or what went wrong.

    Args:
        diagnosis: the answer.

    Returns:
        The text.
    """
    verdict = str(diagnosis.get("verdict", FAILED))
    if verdict == FAILED:
        return f"{FAILED}: {diagnosis.get('message', '')}"[:120]
    naming = verdict in NAMING
    listed = list(diagnosis.get("causes" if naming else "rivals") or [])
    if verdict == "none":
        return verdict
    named = [
        f"{c.get('effect')} at {c.get('location')}" for c in (listed if naming else listed[:2])
    ]
    left = remainder_of(diagnosis)
    tail = "" if left is None else f"; remainder {left:.0%}"
    lead = ", ".join(named) if naming else "rivals " + (", ".join(named) or "none")
    return f"{verdict}: {lead}{tail}"
