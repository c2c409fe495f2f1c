"""What a check of a file found."""

from __future__ import annotations

from dataclasses import dataclass


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
    remedy: str
    """What would be right."""

    def __str__(self) -> str:
        return f"{self.severity}: {self.place}: {self.message}; {self.remedy}"
