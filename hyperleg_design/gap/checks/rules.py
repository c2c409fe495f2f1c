"""Every number by which the checks of logs decide, with its unit and where it comes from.

Labels: *derived* follows from something else in the project, *assumed* is an engineering estimate.
What an effect needs to show in a log stands with that effect (`gap/effects/`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field


@dataclass(frozen=True)
class ClockRules:
    """Length and clock of a log."""

    shortest: float = 2.0
    """Duration below which little can be held out [s] (assumed)."""
    few: int = 200
    """Ticks below which little can be held out [-] (assumed)."""
    fewest: int = 20
    """Ticks that velocities and accelerations need at least [-], by the smoothing's window
    (derived)."""
    slowest: float = 2.0
    """Rate below which the time is in another unit [Hz] (assumed)."""
    fastest: float = 50_000.0
    """Rate above which the time is in another unit [Hz] (assumed)."""
    slow: float = 40.0
    """Rate below which friction and delay blur [Hz] (assumed)."""
    jitter: float = 0.2
    """Share of a step from which jitter is worth a word [-] (assumed)."""
    dropouts: float = 0.01
    """Share of the time from which dropouts are worth a word [-] (assumed)."""
    missing: float = 0.01
    """Share of a column from which unknown values are worth a word [-] (assumed)."""
    saturated: float = 0.005
    """Share of the time at a bound from which it is worth a word [-] (assumed)."""


@dataclass(frozen=True)
class UnitRules:
    """Sizes that tell of another unit, or of signals that do not belong together."""

    window: float = 0.1
    """Time over which motion is compared [s] (assumed)."""
    tolerance: float = 0.15
    """Of a slope that stands for a unit [-] (assumed)."""
    fits: float = 0.9
    """Correlation above which two signals are of one motion [-] (assumed)."""
    strange: float = 0.6
    """Correlation below which they are not [-] (assumed)."""
    half_turn: float = 3.3
    """Angle beyond which a target that is not followed is taken for degrees [rad] (assumed)."""
    largest_angle: float = 4 * math.pi
    """Angle that no joint reaches in radians [rad] (assumed: two turns)."""
    largest_rate: float = 40.0
    """Rate of a gyroscope beyond the full scale of usual ones, 2000 deg/s [rad/s] (derived)."""
    largest_current: float = 500.0
    """Of motors of legs and arms; beyond, another unit [A] (assumed)."""
    largest_voltage: float = 1000.0
    """The same of their supply [V] (assumed)."""
    largest_temperature: float = 200.0
    """The same of their temperature [degC] (assumed)."""
    largest_torque: float = 1e5
    """Torque that no joint of a legged robot or arm has [Nm] (assumed)."""
    beyond: float = 100.0
    """Torque over the drive's limit that is in another unit [-] (assumed)."""
    doubtful: float = 5.0
    """Torque over the drive's limit that is worth a warning [-] (assumed: a limit that a file
    declares may be the continuous one, a fifth of the peak)."""
    percentile: float = 90.0
    """Of a torque's size, so that a spike does not refuse a log [%] (assumed)."""
    apart: float = 30.0
    """Ratio of a signal's size to its median over all logs from which the units may differ [-]
    (assumed: motions of one robot differ by less; degrees are 57 rad)."""


@dataclass(frozen=True)
class MotionRules:
    """Facts of the motion that effects ask for."""

    moving: float = 0.05
    """Speed from which a joint counts as moving [rad/s] (assumed); of a slide, over
    `lever`."""
    lever: float = 0.3
    """Length over which the metres of a slide count as radians [m] (assumed: a link of an arm)."""
    noise: float = 1.5
    """Times the power of noise that does not count as motion [-] (assumed)."""


@dataclass(frozen=True)
class CheckRules:
    """All rules of the checks."""

    clock: ClockRules = field(default_factory=ClockRules)
    unit: UnitRules = field(default_factory=UnitRules)
    motion: MotionRules = field(default_factory=MotionRules)


RULES = CheckRules()
"""By which logs are checked."""
