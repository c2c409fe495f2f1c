"""Measured gaps and diagnoses as text for a terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from hyperleg_design.gap.checks.coverage import REMEDY
from hyperleg_design.gap.pipeline.answer import AT_END
from hyperleg_design.gap.pipeline.detected_causes import APART
from hyperleg_design.gap.playback.added import Changed, Replayed
from hyperleg_design.gap.playback.measure import Gap
from hyperleg_design.report.gap.alike import (
    of_every_day,
    places,
    span_text,
    spans,
    telling,
    together,
)

NOISE_FROM = {
    "reference": "reference logs",
    "repeats": "repeats of the same motion",
    "split": "the smooth part against the noisy part of the logs",
}
"""What the size of the noise rests on."""
LEAST_PROBABILITY = 0.005
"""Probability below which a rival is not printed; `diagnosis.json` has all."""
ALONE = " (without reference logs: what the model lacks, whether it has changed or not)"
"""End of the verdict where no log tells what the robot was like before."""
LACKS = "model lacks"
"""Beginning of a line on what acts in the references, too; it holds fitted numbers alone."""


def gap_text(gap: Gap, most: int = 12) -> str:
    """Describe where the gap lies: each signal's places, largest excess first, and the regimes in
    which the largest stands out.

    Args:
        gap: as measured.
        most: rows for each signal at most.

    Returns:
        The text.
    """
    lines = [f"noise from {NOISE_FROM[gap.floor_from]}"]
    lines += [f"note: {note}" for note in gap.notes]
    for signal in dict.fromkeys(row.signal for row in gap.rows):
        rows = sorted(gap.select(signal), key=lambda row: -row.excess)
        units = sorted({row.unit for row in rows})
        mixed = len(units) > 1
        lines += [
            "",
            f"{signal} [{', '.join(units)}]",
            f"  {'place':<24} {'gap':>10} {'noise':>10} {'excess':>10} {'share':>7}",
        ]
        titles = _titles([{"location": row.location, "kind": row.kind} for row in rows])
        lines += [
            f"  {titles[row.kind, row.location]:<24} {row.gap:>10.4g} {row.floor:>10.4g} "
            f"{row.excess:>10.4g} {100 * row.share:>6.0f}%{f'  {row.unit}' if mixed else ''}"
            for row in rows[:most]
        ]
        if len(rows) > most:
            lines.append(f"  and {len(rows) - most} more")
        worst = rows[0]
        regimes = sorted(
            (
                r
                for r in gap.select(signal, location=worst.location, regime="")
                if r.regime != "all"
            ),
            key=lambda r: -r.share,
        )
        if worst.excess > 0 and regimes:
            shares = ", ".join(f"{r.regime} {100 * r.share:.0f} %" for r in regimes[:4])
            lines.append(f"  {worst.location} mostly in: {shares}")
    return "\n".join(lines)


def sensitivity_rows(diagnosis: Mapping[str, Any]) -> list[tuple[str, str, str, str]]:
    """Tabulate the smallest changes that the logs would have shown.

    Args:
        diagnosis: as `diagnosis.json` holds it.

    Returns:
        For each parameter of each effect, and each unit that it has: effect, parameter, where the
        change is least and where it is most.
    """
    groups: dict[tuple[str, str, str], list[Mapping[str, Any]]] = {}
    for entry in diagnosis.get("sensitivity", ()):
        key = str(entry["effect"]), str(entry["parameter"]), str(entry["unit"])
        groups.setdefault(key, []).append(entry)
    rows = []
    for (effect, parameter, _), members in groups.items():
        ordered = sorted(members, key=lambda entry: float(entry["change"]))
        least, most = (
            f"{change_text(entry)} at {entry['location']}" for entry in (ordered[0], ordered[-1])
        )
        rows.append((effect, parameter, least, most if len(ordered) > 1 else ""))
    return rows


def change_text(entry: Mapping[str, Any]) -> str:
    """Write a change of a parameter as people state it: shares in per cent, anything else in its
    unit.

    Args:
        entry: an element of `sensitivity`.

    Returns:
        The text.
    """
    change, unit = float(entry["change"]), str(entry["unit"])
    return f"{change:.2g} {unit}" if unit else f"{100 * change:.2g} %"


def lacking(diagnosis: Mapping[str, Any]) -> list[Any]:
    """List what the model lacks of the robot in the references already.

    Args:
        diagnosis: as `diagnosis.json` holds it.

    Returns:
        Its causes.
    """
    return list((diagnosis.get("lacks") or {}).get("causes", ()))


def diagnosis_text(diagnosis: Mapping[str, Any]) -> str:
    """Write verdict, gap, causes, rivals, what the model lacked in the references already, and what
    to do next.

    Args:
        diagnosis: as `diagnosis.json` holds it.

    Returns:
        The text.
    """
    gap, remainder = diagnosis["gap"], diagnosis.get("remainder") or 0.0
    size = f"residuals [{gap['unit']}]: {gap['before']:.4g}"
    lines = [f"verdict: {diagnosis['verdict']}", f"{size}, of which noise {gap['floor']:.4g}"]
    if diagnosis["causes"]:
        if remainder:
            lines[0] += " in part"
        if diagnosis.get("provenance", {}).get("reference") == []:
            lines[0] += ALONE
        low, high = (100 * float(v) for v in gap["closed_interval"])
        lines[1] = (
            f"{size} before, {gap['after']:.4g} with the causes added, noise {gap['floor']:.4g}; "
            f"closed on held-out data: {100 * gap['closed']:.0f} % ({low:.0f} .. {high:.0f})"
        )
    rivals = [r for r in diagnosis["rivals"] if r["probability"] >= LEAST_PROBABILITY]
    lacks = lacking(diagnosis)
    groups = (
        *(
            (
                f"reference {row['log']} differs from the others{of_every_day(row)}; taken out of "
                "it:",
                [row],
            )
            for row in diagnosis.get("reference_differences", ())
        ),
        ("cause", diagnosis["causes"]),
        ("rival", rivals[:4]),
    )
    for title, rows in groups:
        collapsed = together(rows) if title != "rival" else [[row] for row in rows]
        for group in collapsed:
            lines += _cause_lines(title, group)
    if remainder:
        share = f"{100 * remainder:.0f} %"
        lines.append(f"  remainder: {share} of the gap, which no effect of the catalogue explains")
    lines += [
        f"  {shape['location']} {shape['says']}"
        for shape in diagnosis.get("residual_shape", ())
        if shape["shape"] in APART
    ]
    titles = _titles(diagnosis["where"])
    places = [
        f"{titles[w['kind'], w['location']]} {100 * w['share']:.0f} %"
        for w in diagnosis["where"]
        if w["regime"] == "all"
    ][:5]
    if places:
        lines.append(f"  where: {', '.join(places)}")
    if diagnosis["verdict"] in ("unknown", "none") or remainder:
        left = [
            shape for shape in diagnosis.get("residual_shape", ()) if shape["shape"] not in APART
        ]
        lines += [
            f"  left: {shape['shape']} at {shape['location']}: {shape['says']}"
            for shape in left[:3]
        ]
    if diagnosis["verdict"] == "unknown":
        lines += [f"  {text}" for text in beyond_references(diagnosis)]
    lines += [f"  {text}" for text in diagnosis.get("checks", ()) if AT_END in text]
    if diagnosis["verdict"] == "none" and (rows := sensitivity_rows(diagnosis)):
        lines.append("  these logs would have shown, nine times in ten, from:")
        lines += [
            f"    {effect} {parameter}: {least}{f' to {most}' if most else ''}"
            for effect, parameter, least, most in rows
        ]
    if diagnosis["separating_experiment"]:
        lines.append(f"  to tell them apart: {_experiment(diagnosis['separating_experiment'])}")
    for group in together(lacks):
        lines += _cause_lines(LACKS, group)
    return "\n".join(lines)


def _cause_lines(title: str, group: Sequence[Mapping[str, Any]]) -> list[str]:
    """One line for a cause; for an effect at several places another one with the size at each."""
    words = ", ".join(
        span.words
        or f"{span.name} {span_text(span.least, span.most, 4, '..')} {span.unit} "
        f"({span_text(span.low, span.high, 4, '..')})".replace("  ", " ")
        for span in spans(group)
        if title != LACKS or (not span.words and span.low < span.high)
    )
    closes = ""
    if title == "cause":
        ends = dict.fromkeys(f"{100 * row['closed']:.0f}" for row in sorted(group, key=_closed))
        ends = dict.fromkeys([next(iter(ends)), [*ends][-1]])
        closes = f", closes {' .. '.join(ends)} %{' each' if len(group) > 1 else ''}"
    probability = min(float(row["probability"]) for row in group)
    where = places(group)
    line = f"  {title} {group[0]['effect']} at {where}: p {probability:.2f}{closes}; {words}"
    if len(group) == 1:
        return [line]
    name = telling(group)
    values = [_value(row, name) for row in group]
    each = (
        f"{row['location']} {float(value['value']):.4g}"
        for row, value in zip(group, values, strict=True)
    )
    unit = f" {values[0]['unit']}" if values[0]["unit"] else ""
    return [line, f"    {', '.join(each)}{unit}"]


def _value(cause: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    """A parameter of a cause; the first one where it has none of that name."""
    parameters = cause["parameters"]
    return dict(parameters.get(name) or next(iter(parameters.values())))


def _closed(cause: Mapping[str, Any]) -> float:
    return float(cause["closed"])


def beyond_references(diagnosis: Mapping[str, Any]) -> list[str]:
    """Pick out the remarks on joints that move as in no reference log.

    Args:
        diagnosis: as `diagnosis.json` holds it.

    Returns:
        One sentence a joint, without a full stop.
    """
    return [text for text in diagnosis.get("checks", ()) if REMEDY in text]


def _titles(where: Sequence[Mapping[str, Any]]) -> dict[tuple[str, str], str]:
    """Names of places by kind and name, with the kind before a name that two places share."""
    kinds: dict[str, set[str]] = {}
    for place in where:
        kinds.setdefault(str(place["location"]), set()).add(str(place["kind"]))
    return {
        (kind, name): f"{kind} {name}" if len(own) > 1 else name
        for name, own in kinds.items()
        for kind in own
    }


def _experiment(experiment: Mapping[str, Any]) -> str:
    """What to do next, for how long, and what it separates."""
    plan = dict(experiment)
    text = str(plan.pop("name", "an experiment"))
    if "minutes" in plan:
        text += f" ({plan.pop('minutes'):g} min)"
    if "do" in plan:
        text += f": {plan.pop('do')}"
    if "separates" in plan:
        text += f"; it separates {' from '.join(plan.pop('separates'))}"
    return "; ".join([text, *(f"{k.replace('_', ' ')}: {value}" for k, value in plan.items())])


def replayed_text(rows: Sequence[Replayed]) -> str:
    """Write the errors of replayed logs without and with an effect.

    Args:
        rows: one for each joint.

    Returns:
        The text; empty without rows.
    """
    if not rows:
        return ""
    wide = max(len(r.joint) for r in rows)
    units = list(dict.fromkeys(f"m{r.unit}" for r in rows))
    mixed = len(units) > 1
    lines = [
        f"replayed over {rows[0].windows} short windows, following each log's {rows[0].follows}; "
        f"error of position [{', '.join(units)}]:"
    ]
    lines += [
        f"  {r.joint:{wide}}  {1e3 * r.before:8.3g} -> {1e3 * r.after:8.3g}"
        f"{f' m{r.unit}' if mixed else ''}"
        for r in rows
    ]
    return "\n".join(lines)


def changed_text(rows: Sequence[Changed]) -> str:
    """Write the measures of a policy's trials without and with an effect.

    Args:
        rows: one for each measure.

    Returns:
        The text; empty without rows.
    """
    if not rows:
        return ""
    wide = max(len(r.measure) for r in rows)
    lines = [f"  {'':{wide}}  {'without':>9} {'with':>9}  difference, 95 % interval over trials"]
    for r in rows:
        change = f"{r.difference:+.3g} ({r.low:+.3g} .. {r.high:+.3g})" if r.trials > 1 else "-"
        lines.append(
            f"  {r.measure:{wide}}  {r.before:9.4g} {r.after:9.4g}  "
            f"{change}{f' {r.unit}' if r.unit else ''}"
        )
    return "\n".join(lines)
