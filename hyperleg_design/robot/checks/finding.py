"""One thing that a check of a file finds, and the lines that report several."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

MOST_PLACES = 4
"""Places that a line names at most."""


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong, or looks wrong, in a file."""

    severity: str
    """`error` where the file cannot be used as it stands, `warning` where it may not mean what its
    author meant."""
    place: str
    """Element, field or line."""
    message: str
    """What is there."""
    remedy: str = ""
    """What would be right; empty where the message says it."""

    def __str__(self) -> str:
        said = f"{self.message}; {self.remedy}" if self.remedy else self.message
        return f"{self.severity}: {self.place}: {said}"


def finding_lines(findings: Iterable[Finding]) -> list[str]:
    """Write findings one a line; what is equally wrong at several places stands once.

    Args:
        findings: of one file.

    Returns:
        The lines, in the order of the first place of each.
    """
    places: dict[tuple[str, str, str], list[str]] = {}
    for finding in findings:
        places.setdefault((finding.severity, finding.message, finding.remedy), []).append(
            finding.place
        )
    lines = []
    for (severity, message, remedy), at in places.items():
        more = f" and {len(at) - MOST_PLACES} more" if len(at) > MOST_PLACES else ""
        place = ", ".join(at[:MOST_PLACES]) + more
        lines.append(str(Finding(severity, place, message, remedy)))
    return lines
