"""The page of a diagnosis: verdict, where, which effect, how far the gap shrinks, what else it
could be, what to do next.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design import provenance
from hyperleg_design.gap.inference.detectors.heard import KNOCKING, RINGING, UNSTABLE
from hyperleg_design.gap.inference.detectors.knocking import struck
from hyperleg_design.gap.inference.detectors.loose import ringing
from hyperleg_design.gap.inference.detectors.sinking import EFFECT as SOFT
from hyperleg_design.gap.inference.detectors.sinking import SINKS, bearings
from hyperleg_design.gap.inference.detectors.slipping import EFFECT as SLIPPERY
from hyperleg_design.gap.inference.detectors.slipping import SLIPS, contacts
from hyperleg_design.gap.inference.detectors.unstable import swinging
from hyperleg_design.gap.pipeline.beside_balances import APART
from hyperleg_design.gap.playback.evidence import Evidence, evidence, rms
from hyperleg_design.gap.signals.ground import footings
from hyperleg_design.report.gap import figures as gap_figures
from hyperleg_design.report.gap.text import change_text, chosen, sensitivity_rows
from hyperleg_design.report.page import (
    Cell,
    Details,
    Heading,
    Page,
    Picture,
    Section,
    Table,
    render,
)
from hyperleg_design.report.style import save
from hyperleg_design.writing import write_text

if TYPE_CHECKING:
    from hyperleg_design.gap.signals.signals import Signals

FIGURES = "figures"
VERDICTS = {
    "explained": "One explanation closes the gap, and no other does as well.",
    "ambiguous": "Several causes close the gap alike on these data; the experiment below would "
    "tell them apart.",
    "none": "No gap beyond the repeatability floor.",
    "unknown": "There is a gap, and no effect of the catalogue closes it; the shape of what is "
    "left is described below.",
}

SENSITIVITY = (
    "How small a fault could have been and still been named, nine times in ten, beside the "
    "calibration errors that robots usually have. "
    "What is smaller these logs do not show, whatever the verdict; more excitation, longer logs or "
    "reference logs make it less."
)
HIDDEN = " The gap that no effect explains hides more."
MOST_SWINGING = 4
"""Joints that are drawn as they swing by themselves."""
LEAST_CLOSED = 0.05
"""Share of the excess that a cause must close to be said to close the gap."""


def write_gap_page(folder: Path, diagnosis: Mapping[str, Any], signals: Sequence[Signals]) -> Path:
    """Write `index.html` and its figures beside `diagnosis.json`.

    Args:
        folder: of the diagnosis, exists.
        diagnosis: as `diagnosis.json` holds it.
        signals: of the logs that were diagnosed, for the figures.
    """
    (folder / FIGURES).mkdir(exist_ok=True)
    causes, rivals, gap = list(diagnosis["causes"]), list(diagnosis["rivals"]), diagnosis["gap"]
    shape, noisy = _heard(diagnosis)
    slid, sunk = _feet(diagnosis, SLIPS), _feet(diagnosis, SINKS)
    of_feet = {*((SLIPPERY, foot) for foot in slid), *((SOFT, foot) for foot in sunk)}
    others = [
        one
        for one in causes
        if one["location"] != noisy and (one["effect"], one["location"]) not in of_feet
    ]
    apart = shape in (RINGING, UNSTABLE) or bool(
        of_feet
    )  # what rings is in no residual, and what feet tell in none in which it is the largest
    shown = (
        []
        if apart and not others
        else [evidence(one, others or causes, _balance(one, others or causes)) for one in signals]
    )
    shown = [
        one for one in shown if np.isfinite(one.before).any()
    ]  # joints that stand all the time show nothing
    pictures = [
        *(_noises(folder, shape, noisy, causes, signals) if noisy else []),
        *_slipping(folder, slid, signals),
        *_sinking(folder, sunk, signals),
        *(
            _traces(folder, shown, others, bool(diagnosis.get("provenance", {}).get("reference")))
            if others or not (noisy or of_feet)
            else []
        ),
    ]
    sections = [
        Section("Where the gap lies", _where(folder, diagnosis, signals, shown)),
        Section("Measured against predicted", pictures),
        Section("Which effect, and how far the gap shrinks", _causes(folder, gap, causes, rivals)),
        Section("What would tell the rivals apart", _next_steps(diagnosis)),
        Section("What these data can show", _limits(diagnosis)),
    ]
    verdict = str(diagnosis["verdict"])
    page = Page(
        title=f"Gap diagnosis of {signals[0].subject.name}" if signals else "Gap diagnosis",
        lead=f"Verdict: {verdict}. {_meaning(diagnosis)} "
        f"{_sentence(causes)}{_chatter(diagnosis)}{_at_rest(diagnosis)}",
        sections=[section for section in sections if section.content],
        facts=_facts(gap, causes),
        provenance={
            **dict(diagnosis.get("provenance", {})),
            "page made by commit": provenance.git_commit(),
        },
    )
    return write_text(folder / "index.html", render(page))


def _meaning(diagnosis: Mapping[str, Any]) -> str:
    """What the verdict says of these logs."""
    if (
        diagnosis["causes"]
        and diagnosis.get("at_rest")
        and float(diagnosis["gap"]["closed"]) < LEAST_CLOSED
    ):
        return (
            "One explanation goes with what joints do at rest; in motion they show no gap "
            "beyond the repeatability floor."
        )
    return VERDICTS[str(diagnosis["verdict"])]


def _chatter(diagnosis: Mapping[str, Any]) -> str:
    """Joints that swing to and fro, if that is what is named, or what is left."""
    shapes = diagnosis.get("residual_shape", ())
    joints = [one["location"] for one in shapes if one["shape"] == "chatter"]
    if not joints:
        return "".join(
            f" {one['location']} {one['says']}." for one in shapes if one["shape"] in APART
        )
    return (
        f"What is left first of all: {', '.join(joints)} "
        f"chatter{'s' if len(joints) == 1 else ''}, as of a loop that is hardly stable."
    )


def _at_rest(diagnosis: Mapping[str, Any]) -> str:
    """What joints show while they stand."""
    said = [str(one["says"]) for one in diagnosis.get("at_rest", ())]
    return (
        f" At rest, which is in no balance and in no share closed: {'; '.join(said)}."
        if said
        else ""
    )


def cause_text(cause: Mapping[str, Any]) -> str:
    """`coulomb_friction at left_knee (torque 1.9 Nm, 1.7 .. 2.1)`."""
    return (
        f"{cause['effect']} at {cause['location']} "
        f"({', '.join(_parameter_texts(cause['effect'], cause['parameters']))})"
    )


def _facts(gap: Mapping[str, Any], causes: Sequence[Mapping[str, Any]]) -> list[tuple[str, str]]:
    unit = str(gap["unit"])
    facts = [
        (f"{float(gap['before']):.3g} {unit}", "gap before"),
        (f"{float(gap['floor']):.3g} {unit}", "repeatability floor"),
    ]
    if causes:
        low, high = (100 * float(v) for v in gap["closed_interval"])
        facts.insert(1, (f"{float(gap['after']):.3g} {unit}", "gap after"))
        facts.append(
            (
                f"{100 * float(gap['closed']):.0f} %",
                f"of the excess closed on held-out data ({low:.0f} .. {high:.0f} %)",
            )
        )
        facts.append(
            (f"{float(causes[0]['probability']):.2f}", f"probability of {causes[0]['effect']}")
        )
    return facts


def _sentence(causes: Sequence[Mapping[str, Any]]) -> str:
    return f"Named: {'; '.join(cause_text(c) for c in causes)}." if causes else ""


def _parameter_texts(effect: str, parameters: Mapping[str, Mapping[str, Any]]) -> list[str]:
    return [
        told or f"{name} {p['value']:.4g} {p['unit']}, {p['low']:.4g} .. {p['high']:.4g}"
        for name, p, told in chosen(effect, parameters)
    ]


def _balance(signals: Signals, causes: Sequence[Mapping[str, Any]]) -> str:
    """The residual in which the first cause shows; motion without one."""
    from hyperleg_design.gap.effects import effect

    for cause in causes[:1]:
        kind = effect(str(cause["effect"]))
        traces = kind.trace(signals, str(cause["location"]), kind.nulls[None])
        for residual_name in ("motion", *sorted(traces)):
            if residual_name in traces and residual_name in signals.residual:
                return residual_name
    return "motion"


def _where(
    folder: Path,
    diagnosis: Mapping[str, Any],
    signals: Sequence[Signals],
    shown: Sequence[Evidence],
) -> list[Any]:
    rows = [
        [
            w["location"],
            w["kind"],
            w["regime"],
            f"{100 * float(w['share']):.0f} %" + ("" if w["regime"] == "all" else " of its own"),
        ]
        for w in diagnosis["where"]
    ]
    if not rows:
        return []
    shares: dict[str, float] = {}
    for entry in diagnosis["where"]:
        if entry["regime"] == "all":  # the share of a regime is one of its place's own gap
            shares[str(entry["location"])] = max(
                shares.get(str(entry["location"]), 0.0), float(entry["share"])
            )
    content: list[Any] = []
    if signals and max(shares.values(), default=0.0) > 0:
        save(gap_figures.robot_figure(signals[0].subject, shares), folder / FIGURES / "where.png")
        pictures = [
            Picture(
                f"{FIGURES}/where.png",
                "The robot at rest, its joints coloured by their share of the gap.",
                wide=False,
            )
        ]
        alike = [one for one in shown if one.residual_name == shown[0].residual_name]
        if alike and len(alike[0].rows) > 1:
            save(gap_figures.rows_figure(alike), folder / FIGURES / "rows.png")
            pictures.append(
                Picture(
                    f"{FIGURES}/rows.png",
                    "Size of the gap, each joint or motor, before and after.",
                    wide=False,
                )
            )
        content.append(pictures)
    content.append(Table(["location", "kind", "regime", "share of the gap"], rows[:12]))
    if len(rows) > 12:
        content.append(
            Details(
                f"All {len(rows)} places and regimes",
                [Table(["location", "kind", "regime", "share of the gap"], rows)],
            )
        )
    return content


def _traces(
    folder: Path, shown: Sequence[Evidence], causes: Sequence[Mapping[str, Any]], referred: bool
) -> list[Any]:
    content: list[Any] = []
    says = "what the named causes predict, and what is left" if causes else "no cause is named"
    says += ", that which reference logs show as well included" if referred else ""
    telling = sorted(
        shown, key=lambda one: -float(np.nan_to_num(rms(one.explained)).max(initial=0.0))
    )  # where causes show most, first
    for i, one in enumerate(telling[:2]):
        name = f"trace-{i + 1}.png"
        save(gap_figures.trace_figure(one), folder / FIGURES / name)
        right = "; right, against speed" if np.isfinite(one.speed[:, one.worst]).any() else ""
        content.append(
            Picture(
                f"{FIGURES}/{name}",
                f"{one.rows[one.worst]} in {one.log}: torque that the model lacks, {says}, but for "
                f"its rest{right}.",
            )
        )
    return content


def _heard(diagnosis: Mapping[str, Any]) -> tuple[str, str]:
    """How a cause is known that is heard, and its place, if that is what is named."""
    shapes = diagnosis.get("residual_shape", ())
    return next(
        (
            (str(one["shape"]), str(one["location"]))
            for one in shapes
            if one["shape"] in (RINGING, KNOCKING, UNSTABLE)
        ),
        ("", ""),
    )


def _noises(
    folder: Path,
    shape: str,
    place: str,
    causes: Sequence[Mapping[str, Any]],
    signals: Sequence[Signals],
) -> list[Any]:
    """Torques by which a belt is known that rings, or lets its joints knock about, or joints that
    swing by themselves.
    """
    if shape == UNSTABLE:
        effect = next(
            (str(one["effect"]) for one in reversed(causes) if one["location"] == place), ""
        )
        return _swinging(folder, effect, place, signals)
    return (
        _ringing(folder, place, signals) if shape == RINGING else _knocking(folder, place, signals)
    )


def _swinging(folder: Path, effect: str, place: str, signals: Sequence[Signals]) -> list[Any]:
    """Joints that swing by themselves, those that do most, and what of it goes with the mode that
    the cause makes unstable.
    """
    content: list[Any] = []
    found = [
        (one, *shown) for one in signals if (shown := swinging(one, effect, place)) is not None
    ]
    found.sort(key=lambda row: -float(np.abs(row[2]).max()))
    for i, (one, time, speed, mode) in enumerate(found[:2]):
        most = np.argsort(-np.mean(speed**2, 0), kind="stable")[:MOST_SWINGING]
        name, joints = f"swinging-{i + 1}.png", one.subject.joints
        drawn = gap_figures.swinging_figure(
            [joints[j] for j in most], one.log.name, time, speed[:, most], mode[:, most]
        )
        save(drawn, folder / FIGURES / name)
        says = (
            f"nothing commands this; dashed, what of it goes with the mode that {effect} at "
            f"{place} makes unstable."
        )
        content.append(
            Picture(
                f"{FIGURES}/{name}",
                f"{one.log.name}, where its joints swing most, about that frequency: {says}",
            )
        )
    return content


def _ringing(folder: Path, motor: str, signals: Sequence[Signals]) -> list[Any]:
    """Torque that joints take beside the one that their motor gives, where it rings on its belt."""
    content: list[Any] = []
    found = [(one, shown) for one in signals if (shown := ringing(one, motor)) is not None]
    found.sort(key=lambda pair: -float(np.abs(pair[1][1] - pair[1][2]).max()))
    for i, (one, shown) in enumerate(found[:2]):
        name = f"ringing-{i + 1}.png"
        save(gap_figures.ringing_figure(motor, one.log.name, *shown), folder / FIGURES / name)
        says = (
            "on a rigid transmission the two are one; the difference is the rotor's, which "
            "moves on its belt."
        )
        content.append(
            Picture(
                f"{FIGURES}/{name}",
                f"{motor} in {one.log.name} about the frequency at which it chatters: {says}",
            )
        )
    return content


def _knocking(folder: Path, motor: str, signals: Sequence[Signals]) -> list[Any]:
    """Torques that the model lacks in the joints that tell most, beside those of a motion that no
    encoder tells.
    """
    content: list[Any] = []
    found = [(one, *struck(one, motor)) for one in signals]
    found.sort(key=lambda row: -float(np.abs(row[3]).max()))
    for i, (one, time, left, explained) in enumerate(found[:2]):
        told = np.argsort(-np.mean(explained**2, 0), kind="stable")[:2]
        name, joints = f"knocking-{i + 1}.png", one.subject.joints
        save(
            gap_figures.knocking_figure(
                [joints[j] for j in told], one.log.name, time, left[:, told], explained[:, told]
            ),
            folder / FIGURES / name,
        )
        says = (
            "two joints at once, in the proportions that one hidden motion makes; a torque "
            "would show in one of them."
        )
        content.append(
            Picture(f"{FIGURES}/{name}", f"{one.log.name}, where it knocks hardest: {says}")
        )
    return content


def _feet(diagnosis: Mapping[str, Any], shape: str) -> list[str]:
    """Feet that tell of their ground."""
    return [
        str(one["location"]) for one in diagnosis.get("residual_shape", ()) if one["shape"] == shape
    ]


def _slipping(folder: Path, feet: Sequence[str], signals: Sequence[Signals]) -> list[Any]:
    """Forces of feet that slide, over the speeds at which they do, in the log in which they do so
    most.
    """
    content: list[Any] = []
    for i, foot in enumerate(feet):
        place = signals[0].subject.feet.index(foot)
        found = [(one, shown) for one in signals if (shown := contacts(one, place)) is not None]
        if not found:
            continue
        one, shown = max(found, key=lambda pair: int(pair[1].slides.sum()))
        name, nominal = f"slipping-{i + 1}.png", footings(one)[place].friction
        coefficient = float(np.median(shown.ratio[shown.slides])) if shown.slides.any() else nominal
        drawn = gap_figures.slipping_figure(
            foot,
            one.log.name,
            shown.against[shown.loaded],
            shown.ratio[shown.loaded],
            nominal,
            coefficient,
        )
        save(drawn, folder / FIGURES / name)
        says = (
            "what sticks or creeps may have any force below the line, what slides has that of "
            "the line at any speed."
        )
        content.append(Picture(f"{FIGURES}/{name}", f"{foot} in {one.log.name}: {says}"))
    return content


def _sinking(folder: Path, feet: Sequence[str], signals: Sequence[Signals]) -> list[Any]:
    """Heights over loads of feet that sink, in the log whose loads vary most."""
    content: list[Any] = []
    for i, foot in enumerate(feet):
        found = [
            (one, pads)
            for one in signals
            if (pads := bearings(one, signals[0].subject.feet.index(foot)))
        ]
        if not found:
            continue
        one, pads = max(found, key=lambda pair: sum(pad.weight for pad in pair[1]))
        load, height, nominal = (
            np.concatenate([getattr(pad, name) - getattr(pad, name).mean() for pad in pads])
            for name in ("load", "height", "nominal")
        )
        drawn = gap_figures.sinking_figure(
            foot, one.log.name, load, height, nominal, float(load @ height / (load @ nominal))
        )
        save(drawn, folder / FIGURES / f"sinking-{i + 1}.png")
        says = (
            "how much lower a pad stands under more load is how the ground gives, wherever the "
            "floor lies."
        )
        content.append(
            Picture(f"{FIGURES}/sinking-{i + 1}.png", f"{foot} in {one.log.name}: {says}")
        )
    return content


def _causes(
    folder: Path,
    gap: Mapping[str, Any],
    causes: Sequence[Mapping[str, Any]],
    rivals: Sequence[Mapping[str, Any]],
) -> list[Any]:
    content: list[Any] = []
    pictures: list[Picture] = []
    if causes:
        rows = [_cause_row(cause) for cause in causes]
        content.append(
            Table(
                [
                    "effect",
                    "where",
                    "parameters with 95 % intervals",
                    "closes (held out)",
                    "probability",
                ],
                rows,
            )
        )
        save(gap_figures.waterfall_figure(gap, causes), folder / FIGURES / "waterfall.png")
        says = (
            "The gap on held-out data: before, taken off by each cause, after; dashed, the floor."
        )
        pictures.append(Picture(f"{FIGURES}/waterfall.png", says, wide=False))
    if any(
        float(rival["closed"]) != 0 for rival in rivals
    ):  # where there is no gap, nothing closes any of it
        save(gap_figures.rivals_figure(causes, rivals), folder / FIGURES / "rivals.png")
        pictures.append(
            Picture(
                f"{FIGURES}/rivals.png",
                "What was tried: how much of the excess gap each closes on held-out data.",
                wide=False,
            )
        )
    content += [pictures] if pictures else []
    if rivals:
        content.append(
            Details(
                "Rivals in full",
                [
                    Table(
                        ["effect", "where", "parameters", "closes", "probability"],
                        [_cause_row(r) for r in rivals],
                    )
                ],
            )
        )
    return content


def _cause_row(cause: Mapping[str, Any]) -> list[Any]:
    parameters = "; ".join(_parameter_texts(cause["effect"], cause["parameters"]))
    return [
        cause["effect"],
        cause["location"],
        parameters,
        f"{100 * float(cause['closed']):.0f} %",
        f"{float(cause['probability']):.2f}",
    ]


def _next_steps(diagnosis: Mapping[str, Any]) -> list[Any]:
    content: list[Any] = []
    for group in diagnosis["equivalent"]:
        content.append(
            "Cannot be told apart on these data: "
            + ", ".join(_name(member) for member in group)
            + "."
        )
    experiment = diagnosis["separating_experiment"]
    if experiment:
        content.append(Heading("Cheapest experiment"))
        content.append(
            Table(
                ["", ""],
                [[str(key).replace("_", " "), _plain(value)] for key, value in experiment.items()],
            )
        )
    return content


def _limits(diagnosis: Mapping[str, Any]) -> list[Any]:
    content: list[Any] = []
    if smallest := sensitivity_rows(diagnosis):
        content.append(SENSITIVITY + (HIDDEN if diagnosis["verdict"] == "unknown" else ""))
        content.append(
            Table(
                ["effect", "of which", "where it shows best, from", "where it shows least, from"],
                [list(row) for row in smallest],
            )
        )
        every = [
            [one["effect"], one["location"], one["parameter"], change_text(one)]
            for one in diagnosis["sensitivity"]
        ]
        content.append(
            Details(
                f"All {len(every)}, place by place",
                [Table(["effect", "where", "of which", "from"], every)],
            )
        )
    if diagnosis.get("residual_shape"):
        rows = [
            [
                one["location"],
                one["says"],
                f"{100 * one['closed_beyond']:.0f} %",
                f"{one['gain']:.1f}",
            ]
            for one in diagnosis["residual_shape"]
        ]
        content += [
            Heading("Shape of what is left"),
            Table(["where", "looks like", "would close of it", "log-likelihood"], rows),
        ]
    if diagnosis.get("not_judged"):
        rows = [
            [
                _name(entry),
                _plain(entry.get("reason", entry.get("why", "")))
                if isinstance(entry, Mapping)
                else "",
            ]
            for entry in diagnosis["not_judged"]
        ]
        content.append(
            Details(
                f"{len(rows)} effects that these logs cannot judge",
                [Table(["effect", "why"], rows)],
            )
        )
    if diagnosis.get("checks"):
        remarks = [[Cell(_plain(entry), "note")] for entry in diagnosis["checks"]]
        content.append(Details(f"{len(remarks)} remarks on the logs", [Table(["remark"], remarks)]))
    return content


def _name(entry: Any) -> str:
    if isinstance(entry, Mapping):
        return " at ".join(str(entry[key]) for key in ("effect", "location") if entry.get(key))
    return (
        " at ".join(str(part) for part in entry) if isinstance(entry, list | tuple) else str(entry)
    )


def _plain(value: Any) -> str:
    if isinstance(value, Mapping):
        return "; ".join(
            f"{str(key).replace('_', ' ')}: {_plain(part)}" for key, part in value.items()
        )
    if isinstance(value, list | tuple):
        return ", ".join(_plain(part) for part in value)
    return f"{value:.4g}" if isinstance(value, float) else str(value)
