"""Logs of one robot that contradict each other: other joints, other gains, other units."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from hyperleg_design.gap.checks.rules import RULES
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.results.finding import WARNING, Finding

DECLARED = ("robot", "base", "gains", "torque_constant", "gravity")
"""Metadata that belong to the robot and not to a recording."""
COMPARED = ("velocity", "joint_torque", "motor_torque", "motor_torque_command", "motor_current")
"""Signals whose sizes are compared."""


def disagreements(logs: Sequence[Log]) -> dict[str, list[Finding]]:
    """Find where single logs differ from most of the others: in joints, declared metadata, or sizes
    of signals.

    Args:
        logs: of one robot; fewer than two are not compared.

    Returns:
        Findings by name of a log; logs that agree with the majority are absent. Of two that
        disagree, the later one is named.
    """
    findings: dict[str, list[Finding]] = {}

    def note(log: Log, signal: str, what: str, remedy: str) -> None:
        findings.setdefault(log.name, []).append(Finding(WARNING, signal, what, remedy))

    if len(logs) < 2:
        return findings
    usual = _majority([tuple(sorted(log.joints)) for log in logs])
    for log in logs:
        extra, lacking = set(log.joints) - set(usual), set(usual) - set(log.joints)
        if extra or lacking:
            names = ", ".join(sorted(extra or lacking)[:4])
            what = f"has joints that the other logs lack: {names}"
            if not extra:
                what = f"lacks joints of the other logs: {names}"
            note(log, "", what, "diagnose one robot at a time")
    for key in DECLARED:
        values = [_comparable(getattr(log.metadata, key)) for log in logs]
        usual_value = _majority([value for value in values if value])
        for log, value in zip(logs, values, strict=True):
            if value and value != usual_value:
                text = f"declares another {key} than the other logs"
                note(log, "", text, "correct the metadata, or diagnose it apart")
    sizes = [_sizes(log) for log in logs]
    for column in sorted(set().union(*sizes)):
        known = [size[column] for size in sizes if column in size]
        if len(known) < 2:
            continue
        middle = float(np.median(known)) if len(known) > 2 else known[0]
        for log, size in zip(logs, sizes, strict=True):
            ratio = size.get(column, middle) / middle
            if not 1 / RULES.unit.apart < ratio < RULES.unit.apart:
                note(
                    log,
                    column,
                    f"is {ratio:.3g} times as large as in the other logs",
                    "check its unit, and that the motion is the same",
                )
    return findings


def _majority(values: list[Any]) -> Any:
    """The most frequent value, the first of those that are equally frequent."""
    return Counter(values).most_common(1)[0][0] if values else ()


def _comparable(value: Any) -> Any:
    """Mappings and sequences as tuples, which can be counted."""
    if hasattr(value, "items"):
        return tuple(sorted((key, _comparable(inner)) for key, inner in value.items()))
    if isinstance(value, list | tuple):
        return tuple(_comparable(inner) for inner in value)
    return value


def _sizes(log: Log) -> dict[str, float]:
    """Size of every compared column that moves: the 90th percentile of its magnitude."""
    sizes = {}
    for column, values in log.signals.items():
        known = np.abs(values[np.isfinite(values)])
        if column.partition("/")[0] in COMPARED and len(known):
            size = float(np.percentile(known, 90))
            if size > 0:
                sizes[column] = size
    return sizes
