"""Checks of logs as text for a terminal."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from hyperleg_design.gap.checks.check import Check
from hyperleg_design.gap.logs.sampling import Column

MOST_PLACES = 4
"""Names listed before the rest is counted."""


def checks_text(checks: Sequence[Check]) -> str:
    """Describe what each log can and cannot show.

    Args:
        checks: of the logs.

    Returns:
        The text.
    """
    return "\n\n".join(_text(check) for check in checks)


def _text(check: Check) -> str:
    clock = check.sampling
    lines = [
        f"{check.name}: {clock.duration:.4g} s at {clock.rate:.4g} Hz, {clock.ticks} ticks, jitter "
        f"{100 * clock.jitter:.1f} % of a step, "
        f"dropouts {100 * clock.dropouts:.1f} % of the time"
    ]
    for finding in check.findings:
        place = f"{finding.signal} " if finding.signal else ""
        lines.append(
            f"  {finding.severity:8}{place}{finding.what}{f': {finding.remedy}' if finding.remedy else ''}"  # noqa: E501
        )
    lines += [f"  signals {line}" for line in _signals(check.columns)]
    shown = [e for e in check.excitation if e.shown]
    columns = (column.column.partition("/") for column in check.columns)
    joints = {joint for kind, _, joint in columns if kind == "position"}
    lines += [f"  shows   {e.effect}{_places(e.where, joints)}: {e.why}" for e in shown]
    lines += [f"  cannot  {e.effect}: {e.why}" for e in check.excitation if not e.shown]
    if not check.usable:
        lines.append("  not fit for a diagnosis: mend the errors first")
    elif not shown:
        lines.append("  fit for a diagnosis, which would say nothing: this log shows no effect")
    else:
        lines.append("  fit for a diagnosis")
    return "\n".join(lines)


def _places(where: tuple[str, ...], joints: Collection[str]) -> str:
    if not where:
        return ""
    if len(where) > 2 and set(where) == joints:
        return f" at all {len(where)} joints"
    more = f" and {len(where) - MOST_PLACES} more" if len(where) > MOST_PLACES else ""
    return f" at {', '.join(where[:MOST_PLACES])}{more}"


def _signals(columns: Sequence[Column]) -> list[str]:
    """One line a kind of signal: how many, the lowest rate, ranges of quantisation and noise, the
    longest saturation.
    """
    kinds: dict[str, list[Column]] = {}
    for column in columns:
        kinds.setdefault(column.column.partition("/")[0], []).append(column)
    lines = []
    for kind, members in kinds.items():
        steps = _ranges([(c.quantum, c.unit) for c in members if c.quantum])
        parts = [
            f"{kind} ({len(members)})",
            f"{min(c.rate for c in members):.4g} Hz",
            f"steps of {steps}" if steps else "",
            f"noise {_ranges([(c.noise, c.unit) for c in members])}",
            f"at a bound up to {100 * max(c.saturated for c in members):.2g} %"
            if max(c.saturated for c in members) > 0.005
            else "",
        ]
        lines.append(", ".join(part for part in parts if part))
    return lines


def _ranges(sizes: Sequence[tuple[float, str]]) -> str:
    """Sizes from the least to the largest, in each unit: `5e-06 m and 0.0002 .. 0.0004 rad`."""
    by_unit: dict[str, list[float]] = {}
    for size, unit in sizes:
        by_unit.setdefault(unit, []).append(size)
    texts = []
    for unit, values in by_unit.items():
        ends = dict.fromkeys(f"{end:.2g}" for end in (min(values), max(values)))
        texts.append(f"{' .. '.join(ends)} {unit}".rstrip())
    return " and ".join(texts)
