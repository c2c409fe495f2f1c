"""The page of a diagnosis, which a person reads in a minute: verdict, where, before and after,
causes, what else it could be, what to do next; everything else is folded away.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design import provenance
from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.pipeline.detected_causes import APART
from hyperleg_design.gap.playback.evidence import Evidence, evidence
from hyperleg_design.gap.playback.sheets import root_mean_square
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.report.gap import figures as gap_figures
from hyperleg_design.report.gap.alike import together
from hyperleg_design.report.gap.drawing import robot_svg
from hyperleg_design.report.gap.left import hints
from hyperleg_design.report.gap.run import Run
from hyperleg_design.report.gap.sentences import (
    CauseRow,
    capital,
    cause_row,
    joined,
    lead,
    named,
    next_steps,
    plain,
    title,
    verdict_sentence,
)
from hyperleg_design.report.gap.text import change_text, lacking, sensitivity_rows
from hyperleg_design.report.page import Details, Picture, Table, fill
from hyperleg_design.report.style import save
from hyperleg_design.writing import write_text

FIGURES = "figures"
MOST_RIVALS = 4
"""Rivals that are not folded away."""
MOST_TRACES = 2
"""Logs that are drawn."""
SENSITIVITY = (
    "How small a fault could have been and still been named, nine times in ten, beside the "
    "calibration errors that robots usually have and the noise that is left with the named causes "
    "added. What is smaller these logs do not show; more "
    "excitation, longer logs or reference logs make it less."
)
HIDDEN = " The gap that no effect explains hides more."


def write_gap_page(
    folder: Path,
    diagnosis: Mapping[str, Any],
    signals: Sequence[Signals],
    run: Run | None = None,
) -> Path:
    """Write `index.html` and its figures beside `diagnosis.json`.

    Args:
        folder: of the diagnosis, exists.
        diagnosis: as `diagnosis.json` holds it.
        signals: of the logs that were diagnosed, for the figures.
        run: that made the diagnosis, for the commands of what to do next.

    Returns:
        The path of the page.
    """
    (folder / FIGURES).mkdir(exist_ok=True)
    causes, rivals = list(diagnosis["causes"]), list(diagnosis["rivals"])
    verdict = str(diagnosis["verdict"])
    residual_name = _telling_residual(signals, causes)
    standing = lacking(diagnosis)
    shown = [evidence(log, causes, residual_name, standing) for log in signals]
    # joints that stand all the time show nothing
    shown = [part for part in shown if np.isfinite(part.before).any()]
    shapes = diagnosis.get("residual_shape", ())
    left = hints(shapes, shown)
    if not causes:
        below = left[1:3]  # the first one stands in the lead
    elif diagnosis.get("remainder"):
        below = left
    else:
        below = hints([shape for shape in shapes if shape["shape"] in APART], shown)
    what = "what the causes predict and what is left" if causes else "no cause is named"
    if standing:
        what = f"beyond what the references show, {what}"
    first, *others = _traces(folder, shown, what) or [[]]
    page = {
        "title": f"Gap diagnosis of {signals[0].subject.name}" if signals else "Gap diagnosis",
        "verdict": verdict,
        "about": _about(diagnosis, signals),
        "sentence": verdict_sentence(diagnosis),
        "lead": lead(diagnosis, left),
        **_where(diagnosis, signals),
        **_bars(diagnosis),
        "causes": [cause_row(*group) for group in together(causes)],
        "remainder": below,
        "trace": [] if verdict == "none" else first,
        "rivals_title": "Nearest explanations" if verdict == "unknown" else "What else was tried",
        "rivals": [] if verdict == "none" else [_brief(rival) for rival in rivals[:MOST_RIVALS]],
        "equivalent": [
            f"These logs cannot tell apart {joined(named(member) for member in group)}."
            for group in diagnosis["equivalent"]
        ],
        "next": next_steps(diagnosis, run),
        "details": _details(diagnosis, shown, others, left),
        "provenance": {
            **{k: plain(v) for k, v in diagnosis.get("provenance", {}).items() if plain(v)},
            "page made by commit": provenance.git_commit(),
        },
    }
    return write_text(folder / "index.html", fill("diagnosis.html", page=page))


def _about(diagnosis: Mapping[str, Any], signals: Sequence[Signals]) -> str:
    """Robot and number of logs."""
    logs = len(diagnosis.get("provenance", {}).get("logs", signals))
    references = len(diagnosis.get("provenance", {}).get("reference", ()))
    beside = f", {references} reference{'s' if references > 1 else ''}" if references else ""
    name = signals[0].subject.name if signals else "robot"
    return f"{name}, {logs} log{'' if logs == 1 else 's'}{beside}"


def _telling_residual(signals: Sequence[Signals], causes: Sequence[Mapping[str, Any]]) -> str:
    """Name of the residual in which the first cause shows; `motion` where there is no cause."""
    for cause in causes[:1]:
        cause_effect = effect(str(cause["effect"]))
        for log_signals in signals[:1]:
            traces = cause_effect.trace(
                log_signals, str(cause["location"]), cause_effect.nulls[None]
            )
            for name in ("motion", *sorted(traces)):
                if name in traces and name in log_signals.residual:
                    return name
    return "motion"


def _where(diagnosis: Mapping[str, Any], signals: Sequence[Signals]) -> dict[str, Any]:
    """The drawing of the robot, and shares of the gap that no joint has."""
    from markupsafe import Markup

    shares: dict[str, float] = {}
    for entry in diagnosis["where"]:
        if entry["regime"] == "all":  # the share of a regime is one of its place's own gap
            place = str(entry["location"])
            shares[place] = max(shares.get(place, 0.0), float(entry["share"]))
    if not signals or max(shares.values(), default=0.0) <= 0:
        return {"robot": "", "elsewhere": ""}
    subject = signals[0].subject
    known = {*subject.joints, *subject.motors, *subject.links}
    rest = [f"{place} {100 * s:.0f} %" for place, s in shares.items() if place not in known]
    return {"robot": Markup(robot_svg(subject, shares)), "elsewhere": ", ".join(rest)}


def _bars(diagnosis: Mapping[str, Any]) -> dict[str, Any]:
    """How large the gap is before and after, beside the noise floor."""
    gap, named_any = diagnosis["gap"], bool(diagnosis["causes"])
    before, after, floor = (float(gap[key]) for key in ("before", "after", "floor"))
    largest = max(before, after, floor, 1e-12)
    sizes = [("before", before, "before"), ("after", after, "after"), ("noise floor", floor, "")]
    bars = [
        (name, f"{size:.3g} {gap['unit']}", 100 * size / largest, mark)
        for name, size, mark in sizes
        if named_any or name != "after"
    ]
    if not named_any:
        bars[0] = ("robot and model", *bars[0][1:])
    return {
        "bars_title": "Before and after" if named_any else "Size of the gap",
        "bars": bars,
        "bars_note": "Root mean square of what robot and model differ by, on data that the fit "
        "has not seen; the floor is what noise and the usual calibration errors leave.",
    }


def _brief(rival: Mapping[str, Any]) -> CauseRow:
    """A rival with its first parameter alone."""
    row = cause_row(rival)
    return CauseRow(row.effect, row.location, row.values[:1], row.closed, row.probability)


def _traces(folder: Path, shown: Sequence[Evidence], what: str) -> list[list[Picture]]:
    """Two pictures a log, over time and over speed; logs where causes show most come first.

    Args:
        folder: of the page.
        shown: evidence of the logs.
        what: the pictures show beside what the model lacks.
    """
    telling = sorted(
        shown,
        key=lambda part: -float(np.nan_to_num(root_mean_square(part.explained)).max(initial=0.0)),
    )
    figures = []
    for number, part in enumerate(telling[:MOST_TRACES], 1):
        name = f"{FIGURES}/trace-{number}.png"
        save(gap_figures.time_figure(part), folder / name)
        caption = f"{part.rows[part.worst]} in {part.log}: what the model lacks, {what}."
        pictures = [Picture(name, caption, chart=True)]
        if np.isfinite(part.speed[:, part.worst]).any():
            name = f"{FIGURES}/speed-{number}.png"
            save(gap_figures.speed_figure(part), folder / name)
            pictures.append(Picture(name, "The same over speed, all of the log.", chart=True))
        figures.append(pictures)
    return figures


def _details(
    diagnosis: Mapping[str, Any],
    shown: Sequence[Evidence],
    traces: Sequence[Sequence[Picture]],
    left: Sequence[str],
) -> list[Details]:
    """All that is folded away; of a verdict of `none`, what the logs would have shown is not."""
    causes = diagnosis["causes"]
    figures = [
        _rows(shown, bool(diagnosis["causes"])),
        Details("Another log", list(traces)) if traces else None,
        _places(diagnosis),
        _in_full("Causes in full", causes) if len(together(causes)) < len(causes) else None,
        _in_full("Rivals in full", diagnosis["rivals"]),
        _limits(diagnosis),
        Details("What is left", list(left)) if left else None,
        _not_judged(diagnosis),
        _remarks(diagnosis),
    ]
    return [figure_or_none for figure_or_none in figures if figure_or_none is not None]


def _rows(shown: Sequence[Evidence], explained: bool) -> Details | None:
    """Size of the residual of every joint or motor, in all logs."""
    if not shown:
        return None
    alike = [evidence for evidence in shown if evidence.residual_name == shown[0].residual_name]
    before, after = (
        root_mean_square(np.concatenate(part))
        for part in ([s.before for s in alike], [s.after for s in alike])
    )
    header = ["", "before", *(["after"] if explained else [])]
    rows = [
        [name, f"{b:.3g} {unit}", *([f"{a:.3g} {unit}"] if explained else [])]
        for name, unit, b, a in zip(alike[0].rows, alike[0].units, before, after, strict=True)
        if np.isfinite(b)
    ]
    return Details("Root mean square of each row", [Table(header, rows)]) if rows else None


def _places(diagnosis: Mapping[str, Any]) -> Details | None:
    """The gap by place and regime."""
    rows = [
        [
            w["location"],
            w["kind"],
            w["regime"],
            f"{100 * float(w['share']):.0f} %" + ("" if w["regime"] == "all" else " of its own"),
        ]
        for w in diagnosis["where"]
    ]
    header = ["location", "kind", "regime", "share of the gap"]
    return Details("Places and regimes", [Table(header, rows)]) if rows else None


def _in_full(summary: str, entries: Sequence[Mapping[str, Any]]) -> Details | None:
    """All causes or rivals, each by itself, with all parameters."""
    rows = []
    for entry in entries:
        row = cause_row(entry)
        for place, value in enumerate(row.values):
            ends = [row.closed, row.probability] if place == 0 else ["", ""]
            names = [row.effect, row.location] if place == 0 else ["", ""]
            rows.append([*names, value.name, value.value, value.interval, *ends])
    header = ["effect", "where", "parameter", "value", "95 % interval", "closes", "probability"]
    return Details(summary, [Table(header, rows)]) if rows else None


def _limits(diagnosis: Mapping[str, Any]) -> Details | None:
    """Smallest faults that the logs would have shown."""
    smallest = sensitivity_rows(diagnosis)
    if not smallest:
        return None
    header = ["effect", "of which", "where it shows best, from", "where it shows least, from"]
    every = [
        [title(entry["effect"]), entry["location"], _words(entry["parameter"]), change_text(entry)]
        for entry in diagnosis["sensitivity"]
    ]
    rows = [[title(effect), _words(of), *places] for effect, of, *places in smallest]
    return Details(
        "What these logs can show",
        [
            SENSITIVITY + (HIDDEN if diagnosis["verdict"] == "unknown" else ""),
            Table(header, rows),
            Details("Place by place", [Table(["effect", "where", "of which", "from"], every)]),
        ],
        unfolded=diagnosis["verdict"] == "none",
    )


def _words(identifier: Any) -> str:
    return str(identifier).replace("_", " ")


def _not_judged(diagnosis: Mapping[str, Any]) -> Details | None:
    """Effects of which the logs say nothing."""
    rows = [
        [capital(named(entry)), plain(entry.get("reason", entry.get("why", "")))]
        for entry in diagnosis.get("not_judged", ())
    ]
    if not rows:
        return None
    return Details("Effects that these logs cannot judge", [Table(["effect", "why"], rows)])


def _remarks(diagnosis: Mapping[str, Any]) -> Details | None:
    """Remarks of the checks of the logs."""
    rows = [[plain(entry)] for entry in diagnosis.get("checks", ())]
    return Details("Remarks on the logs", [Table(["remark"], rows)]) if rows else None
