"""The sections of a design that describe the build whose masses are known."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from hyperleg_design.robot.parameters.fields import number, text
from hyperleg_design.robot.parameters.values import Checked


@dataclass(frozen=True, eq=False, kw_only=True)
class Place(Checked):
    """Where the reference build has an actuator."""

    housed_in: Any = text("pelvis", "thigh", "shank")
    """Segment that carries it."""
    position_fraction: Any = number("", 0, 1, default=0.0)
    """Where along thigh or shank it sits, over the length from the upper joint [-]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Places:
    """Where the reference build has its actuators."""

    hip_yaw: Place
    hip_roll: Place
    hip_pitch: Place
    knee: Place
    ankle: Place
    toe: Place


@dataclass(frozen=True, eq=False, kw_only=True)
class ReferenceReductions(Checked):
    """Total reductions of the reference build in one posture; 0 stands for the design's own."""

    knee: Any = number("", 0, 1000, default=0.0)
    """Knee over each of the knee, ankle and toe motors [-]."""
    ankle_pitch: Any = number("", 0, 1000, default=0.0)
    """Ankle pitch over each ankle motor [-]."""
    ankle_roll: Any = number("", 0, 1000, default=0.0)
    """Ankle roll over each ankle motor [-]."""
    toe_ankle_pitch: Any = number("", 0, 1000, default=0.0)
    """Ankle pitch over the toe motor [-]."""
    toe: Any = number("", 0, 1000, default=0.0)
    """Toe over the toe motor [-]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ReferenceTransmission:
    """Reductions for which friction and gears are declared."""

    walking: ReferenceReductions = field(default_factory=ReferenceReductions)
    standing: ReferenceReductions = field(default_factory=ReferenceReductions)


@dataclass(frozen=True, eq=False, kw_only=True)
class ReferenceBuild(Checked):
    """The build for which segment masses, lengths, friction and reductions are declared."""

    hip_motor: Any = text()
    knee_motor: Any = text()
    ankle_motor: Any = text()
    toe_motor: Any = text()
    hip_gear: Any = number("", 1, 500)
    """Reduction of the gears of the hip motors [-]."""
    knee_gear: Any = number("", 1, 500)
    """Reduction of the gear of the knee motor [-]."""
    ankle_gear: Any = number("", 1, 500)
    """Reduction of the gears of the ankle motors [-]."""
    toe_gear: Any = number("", 1, 500)
    """Reduction of the gear of the toe motor [-]."""
    thigh_length: Any = number("m", 0.05, 2)
    """Length of the thigh [m]."""
    shank_length: Any = number("m", 0.05, 2)
    """Length of the shank [m]."""
    places: Places
    transmission: ReferenceTransmission = field(default_factory=ReferenceTransmission)
