"""Why no trial of an evaluation gives some of its measures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from hyperleg_design.evaluation.protocols.walk import STRIDES

FELL = "every trial fell, and measures are means over trials that did not fall"
ARRIVAL = ("time", "mean_speed")
"""Measures that need an arrival."""
NO_ARRIVAL = "no trial arrived"
TRANSPORT = ("cost_of_transport", "battery_cost_of_transport")
"""Measures that need a way of more than 1 m."""
NO_WAY = "no trial went farther than 1 m"
NO_STRIDES = (
    f"no trial without a fall has {STRIDES} whole strides in the steady part of the walk: lengthen "
    "`distance` or lower `steady: {begin: ...}` of the protocol"
)


def lacking_text(own: Mapping[str, Mapping[str, Any]], lacking: Sequence[str]) -> str:
    """Name measures that no trial has, with the reason where it is known.

    Args:
        own: rows of `evaluation_rows` of one protocol, variant and design, by measure.
        lacking: measures among them whose mean is None.

    Returns:
        A line; empty where no measure is lacking.
    """
    by_reason: dict[str, list[str]] = {}
    for name in lacking:
        by_reason.setdefault(_reason(name, own), []).append(name)
    parts = [
        ", ".join(names) + (f" ({reason})" if reason else "") for reason, names in by_reason.items()
    ]
    return f"without a value in any trial: {'; '.join(parts)}" if parts else ""


def _reason(name: str, own: Mapping[str, Mapping[str, Any]]) -> str:
    def mean(measure: str) -> Any:
        return own.get(measure, {}).get("mean")

    if mean("fell") == 1.0:
        return FELL
    if name in ARRIVAL:
        return NO_ARRIVAL if mean("arrived") == 0.0 else ""
    if name in TRANSPORT:
        return NO_WAY
    return NO_STRIDES if "steady_speed" in own and mean("steady_speed") is None else ""
