"""A row of measures as JSON takes it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np


def plain_values(row: Mapping[str, Any]) -> dict[str, Any]:
    """A row as JSON takes it: plain values, None for numbers that are not finite.

    Args:
        row: what was measured of a design.

    Returns:
        The plain row.
    """
    return {str(name): _plain(value) for name, value in row.items()}


def _plain(value: Any) -> Any:
    plain = value.item() if hasattr(value, "item") else value
    return None if isinstance(plain, float) and not np.isfinite(plain) else plain
