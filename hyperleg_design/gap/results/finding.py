"""What is wrong or noteworthy in a log, with its remedy."""

from __future__ import annotations

from dataclasses import dataclass

ERROR, WARNING, NOTE = "error", "warning", "note"
SEVERITIES = (ERROR, WARNING, NOTE)
"""An error would give wrong causes: nothing is diagnosed from such a log; a warning weakens the
answer."""


@dataclass(frozen=True)
class Finding:
    """One fact about a log."""

    severity: str
    """How bad it is, one of `SEVERITIES`."""
    signal: str
    """Column, or empty for the whole log."""
    what: str
    remedy: str
