"""A diagnosis in sentences and table rows, for its page."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.pipeline.unexplained import HIDING
from hyperleg_design.report.gap.alike import (
    of_every_day,
    places,
    span_text,
    spans,
    telling,
    together,
)
from hyperleg_design.report.gap.run import Run
from hyperleg_design.report.gap.text import beyond_references, lacking

Entry = Mapping[str, Any]
"""A cause, a rival or another entry, as `diagnosis.json` holds it."""
NOTHING_LEFT = 0.995
"""Share closed that counts as the whole gap."""

MOST_SIZED = 2
"""Causes that a sentence tells with their sizes; an effect at many places counts as one."""
NEAREST = 0.1
"""Probability from which the nearest rival of an unknown gap is mentioned beside the verdict."""


@dataclass(frozen=True)
class ValueRow:
    """One parameter of a cause, ready to be read."""

    name: str
    value: str
    interval: str
    """Interval of 95 %; empty for a choice."""


@dataclass(frozen=True)
class CauseRow:
    """One cause or rival, ready to be read."""

    effect: str
    location: str
    values: tuple[ValueRow, ...]
    closed: str
    probability: str


def title(effect: str) -> str:
    """Name an effect inside a sentence, such as `Coulomb friction` or `payload`.

    Args:
        effect: its identifier.

    Returns:
        The name.
    """
    return EFFECTS[effect].title if effect in EFFECTS else effect.replace("_", " ")


def cause_row(*causes: Entry) -> CauseRow:
    """Make the table row of a cause, of a rival, or of causes of one effect at several places, with
    each of their parameters.

    Args:
        causes: as `diagnosis.json` holds them.

    Returns:
        The row.
    """
    values = []
    for span in spans(causes):
        unit = f" {span.unit}".replace("^2", "²").rstrip()
        words = span.name.replace("_", " ")
        if span.words:
            values.append(ValueRow(words, span.words, ""))
        else:
            size = f"{span_text(span.least, span.most)}{unit}"
            values.append(ValueRow(words, size, f"{span.low:.3g} to {span.high:.3g}"))
    closed = sorted(float(cause["closed"]) for cause in causes)
    shares = dict.fromkeys(share_text(share) for share in (closed[0], closed[-1]))
    return CauseRow(
        capital(title(causes[0]["effect"])),
        places(causes),
        tuple(values) or (ValueRow("", "", ""),),
        " to ".join(shares) + (" each" if len(causes) > 1 else ""),
        probability_text(min(float(cause["probability"]) for cause in causes)),
    )


def share_text(share: float) -> str:
    """Write a share in per cent; a dash where it is none.

    Args:
        share: [-].

    Returns:
        The text.
    """
    return f"{100 * share:.0f} %" if round(100 * share) else "–"


def probability_text(value: float) -> str:
    """Write a probability with two digits, never as a bare zero.

    Args:
        value: the probability [-].

    Returns:
        The text.
    """
    return f"{value:.2f}" if value >= 0.005 else "< 0.01"


def verdict_sentence(diagnosis: Entry) -> str:
    """State the verdict in one sentence.

    Args:
        diagnosis: as `diagnosis.json` holds it.

    Returns:
        The sentence.
    """
    causes, verdict = list(diagnosis["causes"]), str(diagnosis["verdict"])
    where = joined(places_of(diagnosis)[:2])
    if verdict == "none":
        if lacking(diagnosis):
            return "Nothing has changed since the reference logs."
        return "These logs show no gap between robot and model."
    hidden = [
        str(shape["location"])
        for shape in diagnosis.get("residual_shape", ())
        if shape["shape"] in HIDING
    ]
    if verdict == "unknown" and hidden and diagnosis["gap"]["before"] <= diagnosis["gap"]["floor"]:
        plural = len(hidden) > 1
        return (
            f"{joined(hidden)} {'ring or swing' if plural else 'rings or swings'} as in no "
            "reference, so that other faults cannot be seen."
        )
    if verdict == "unknown" or not causes:
        return (
            f"There is a gap{f' at {where}' if where else ''}, and no effect of the catalogue "
            "explains it."
        )
    if verdict == "ambiguous":
        sets = [[named(member) for member in group] for group in diagnosis["equivalent"]]
        alike = "; ".join(joined(group, "or") for group in sets)
        undecided = {named(member) for group in diagnosis["equivalent"] for member in group}
        certain = [cause for cause in causes if named(cause) not in undecided]
        if alike and certain:
            return f"{capital(phrase(certain))}, and either {alike}: these logs cannot tell which."
        return f"Either {alike or phrase(causes)}: these logs cannot tell which."
    plural = len(together(causes)) > 1
    most = "most of " if diagnosis.get("remainder") else ""
    return f"{capital(phrase(causes))} explain{'' if plural else 's'} {most}the gap."


def phrase(causes: Sequence[Entry]) -> str:
    """List all causes in words, such as `Coulomb friction at elbow (0.25 Nm) and payload at hand
    (0.5 kg)`; an effect at several places is named once.

    Args:
        causes: as `diagnosis.json` holds them.

    Returns:
        The phrase.
    """
    groups = together(causes)
    where: dict[str, list[str]] = {}
    for group in groups:
        size = _size(group) if len(groups) <= MOST_SIZED else ""
        names = joined(places(group).split(", "))
        where.setdefault(str(group[0]["effect"]), []).append(f"{names}{size}")
    return joined(f"{title(effect)} at {joined(names)}" for effect, names in where.items())


def _size(group: Sequence[Entry]) -> str:
    """The size that tells most, in parentheses; empty where there is none."""
    name = telling(group)
    sizes = zip(spans(group), cause_row(*group).values, strict=False)
    own = (value for span, value in sizes if span.name == name and value.interval)
    return next((f" ({value.name} {value.value})" for value in own), "")


def named(entry: Entry) -> str:
    """Name an effect and its place, where it has one.

    Args:
        entry: a cause or a rival.

    Returns:
        The words.
    """
    effect, location = title(str(entry.get("effect", ""))), entry.get("location", "")
    return f"{effect} at {location}" if location else effect


def places_of(diagnosis: Entry) -> list[str]:
    """List the places of the gap, the largest share first.

    Args:
        diagnosis: as `diagnosis.json` holds it.

    Returns:
        Names of joints and other places.
    """
    return [str(w["location"]) for w in diagnosis["where"] if w["regime"] == "all"]


def lead(diagnosis: Entry, left: Sequence[str]) -> list[str]:
    """Write what follows the verdict: which references differ, how far the gap shrinks, what
    remains, what joints do at rest, and what the model lacks already.

    Args:
        diagnosis: as `diagnosis.json` holds it.
        left: sentences on what is left.

    Returns:
        Sentences.
    """
    gap, remainder = diagnosis["gap"], diagnosis.get("remainder")
    texts = [
        f"The reference log {difference['log']} differs from the others by "
        f"{phrase([difference])}{of_every_day(difference)}, which was taken out of it."
        for difference in diagnosis.get("reference_differences", ())
    ]
    if diagnosis["causes"]:
        closed = float(gap["closed"])
        low, high = (100 * float(v) for v in gap["closed_interval"])
        much = "All" if closed >= NOTHING_LEFT else f"{100 * closed:.0f} %"
        wide = f" (95 % interval {low:.0f} to {high:.0f} %)" if high - low >= 1 else ""
        texts.append(
            f"{much} of the gap beyond the noise floor is gone on data that the fit has not "
            f"seen{wide}."
        )
    if remainder:
        share = f"{100 * float(remainder):.0f} %"
        texts.append(f"{share} of the gap is left that no effect of the catalogue explains.")
    if diagnosis["verdict"] == "unknown":
        nearest = [r for r in diagnosis["rivals"][:1] if float(r["probability"]) >= NEAREST]
        texts += [f"The nearest of all is {phrase(nearest)}." for _ in nearest]
        texts += left[:1]
    lacks = diagnosis.get("lacks")
    if lacks and lacks.get("causes"):
        advice = (
            "" if diagnosis["verdict"] in ("explained", "none") else " Correct the model first."
        )
        texts.append(
            f"The reference logs already show what the model lacks: {phrase(lacks['causes'])}."
            f"{advice}"
        )
    return texts


def next_steps(diagnosis: Entry, run: Run | None = None) -> list[tuple[str, str]]:
    """List what to do next.

    Args:
        diagnosis: as `diagnosis.json` holds it.
        run: that made it, whose paths go into the commands.

    Returns:
        A sentence and a command for each step; the command may be empty.
    """
    steps, verdict, run = [], diagnosis["verdict"], run or Run()
    experiment = diagnosis["separating_experiment"]
    if experiment:
        steps.append((_experiment(experiment), ""))
    if diagnosis["causes"]:
        steps.append(
            (
                "Add what was named to the simulation, and replay a log that was not used here:",
                run.command(
                    "apply",
                    run.out,
                    *run.named_robot,
                    *("--logs", "OTHER_LOG"),
                    *("--out", f"{run.out.rstrip('/')}_overlay.yaml"),
                ),
            )
        )
    referred = bool(diagnosis.get("provenance", {}).get("reference"))
    if not referred and verdict != "explained":
        steps.append(
            (
                "Give logs of the same motion from when all was well: what the model always lacks "
                "is then no part of the gap.",
                run.command(
                    "diagnose",
                    *run.named_robot,
                    *("--logs", *run.logs),
                    *("--reference", "HEALTHY_LOG"),
                    *("--out", f"{run.out.rstrip('/')}_with_reference"),
                ),
            )
        )
    if verdict == "unknown":
        steps += [(f"{capital(text)}.", "") for text in beyond_references(diagnosis)]
    if verdict in ("unknown", "none"):
        steps.append(
            (
                "Record motions that show more: they stay inside the robot's limits and tell "
                "effects apart.",
                run.command("excite", *run.named_robot, "--out", "motions"),
            )
        )
    return steps


def _experiment(experiment: Entry) -> str:
    text = str(experiment.get("do") or experiment.get("experiment") or experiment.get("name", ""))
    name = experiment.get("name")
    minutes = experiment.get("minutes")
    text = f"{capital(str(name))}: {text}" if name and name != text else capital(text)
    if minutes:
        text += f" ({float(minutes):g} minutes)"
    separates = [str(cause) for cause in experiment.get("separates", ())]
    return text + (f". It tells apart {joined(separates)}." if len(separates) > 1 else ".")


def joined(parts: Iterable[str], word: str = "and") -> str:
    """Join parts as people list them: `a, b and c`.

    Args:
        parts: the parts.
        word: before the last one.

    Returns:
        The text.
    """
    *first, last = [*parts] or [""]
    return f"{', '.join(first)} {word} {last}" if first else last


def capital(text: str) -> str:
    """Write a text with a capital first letter, the rest as it is.

    Args:
        text: the text.

    Returns:
        The changed text.
    """
    return text[:1].upper() + text[1:]


def plain(value: Any) -> str:
    """Write any value of a diagnosis as text.

    Args:
        value: a number, text, list or mapping.

    Returns:
        The text.
    """
    if isinstance(value, Mapping):
        return "; ".join(f"{str(k).replace('_', ' ')}: {plain(part)}" for k, part in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(plain(part) for part in value)
    return f"{value:.4g}" if isinstance(value, float) else str(value)
