"""Parameters of a cause with words for those that are a choice, not a size."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hyperleg_design.gap.effects import EFFECTS


def chosen(
    effect: str, parameters: Mapping[str, Mapping[str, Any]]
) -> list[tuple[str, Mapping[str, Any], str]]:
    """List parameters by name, with words for those that are a choice.

    Args:
        effect: its identifier.
        parameters: values by name, as `diagnosis.json` holds them.

    Returns:
        Name, value and words of each parameter; the words are empty for a number.
    """
    choices = {p.name: p.choices for p in EFFECTS[effect].parameters}
    rows = []
    for name, value in parameters.items():
        words = choices.get(name, ())
        rows.append(
            (
                name,
                value,
                words[min(max(round(float(value["value"])), 0), len(words) - 1)] if words else "",
            )
        )
    return rows
