"""Causes that are heard: in what joints do at high frequencies or in short knocks, and in no
residual.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hyperleg_design.gap.results.diagnosis import Named

RINGING, KNOCKING, UNSTABLE = "ringing", "knocking", "unstable"
"""How it is known: by the torque that a belt's joints take of nobody (`loose`), by joints that
knock about (`knocking`), by which joints a loop swings (`unstable`)."""


@dataclass(frozen=True)
class Heard:
    """What makes the noise."""

    location: str
    """Motor, joint or robot."""
    shape: str
    """`RINGING`, `KNOCKING` or `UNSTABLE`."""
    says: str
    """For people."""
    frequency: float
    """Of the chatter in the log where it is most [Hz]; NaN of knocks."""
    size: float
    """Of what is heard, root mean square."""
    unit: str
    """Of that."""
    closed: float
    """Share of it that is explained, in data that it was not taken from."""
    closed_interval: tuple[float, float]
    """Of the logs, or of odd and even blocks."""
    kind: str
    """Of the places in `shares`: `motor` or `joint`."""
    shares: Mapping[str, float]
    """Of all such places, in its squares."""
    causes: tuple[Named, ...]
    """That make such a noise, the likeliest first."""
