"""What excites an effect: facts of a log's motion, and what a log can say of an effect by them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.logs.log import Log

REVERSALS = 4
"""Least number of reversals by which friction can be told from a constant torque."""
SWING = 0.3
"""Range of a joint that changes what gravity asks of it [rad]."""
SLOW = 0.05
"""Share of the moving time below a tenth of the top speed that counts as slow motion."""


@dataclass(frozen=True)
class Excitation:
    """What a log can say of one effect."""

    effect: str
    """Identifier of the effect."""
    shown: bool
    """Whether this log can show it anywhere."""
    where: tuple[str, ...]
    """Joints, motors, feet or sensors at which it can; empty where it sits at the robot as a
    whole."""
    why: str
    """What is there, or what is lacking."""


@dataclass(frozen=True, eq=False)
class Motion:
    """Facts of each joint of a log, `(n,)`."""

    joints: np.ndarray
    reversals: np.ndarray
    spread: np.ndarray
    """Of speeds while moving [-]."""
    swing: np.ndarray
    """[rad]; of slides over a lever."""
    acceleration: np.ndarray
    """Size that is exceeded for a twentieth of the time [rad/s^2]; of slides over a lever."""
    content: np.ndarray
    """Frequency below which 98 % of the speed's power lies [Hz]."""
    command: np.ndarray
    """The same of the targets or commands [Hz]; 0 where there are none."""
    slow: np.ndarray
    """Share of the moving time below a tenth of the top speed [-]."""
    torque: np.ndarray
    """Whether a torque, a current, or targets with gains tell the joint's torque."""
    measured: np.ndarray
    """Whether a torque or current was measured."""
    asked: np.ndarray
    """Whether targets with gains or torque commands are known."""
    steered: np.ndarray
    """Whether targets with gains are known."""
    posture: np.ndarray
    """Whether the joint's position changes the torques that the robot needs."""
    turning: np.ndarray
    """Whether what the joint carries changes its direction."""

    @property
    def reversing(self) -> np.ndarray:
        """Joints that reverse often enough to tell friction `(n,)` of bool."""
        return np.asarray(self.reversals >= REVERSALS)

    @property
    def swinging(self) -> np.ndarray:
        """Joints that swing far enough to change what gravity asks of them `(n,)` of bool."""
        return np.asarray(self.swing > SWING)


@dataclass(frozen=True)
class Need:
    """What an effect needs of the motion of a joint to show there."""

    passed: Callable[[Motion], np.ndarray]
    """Which joints move so `(n,)` of bool."""
    good: str
    """What is there, where one passes."""
    lacking: str
    """What is lacking, where none does."""
    asked: bool = False
    """Whether only what was asked of drives, and measured of them, tells it apart from mechanics;
    else their torque has to be known."""
    steered: bool = False
    """Whether what was asked must be known by targets with gains."""
    speeds: bool = False
    """Whether speeds of motors and joints show it, where a log has both."""


def shown_by(effect: str, need: Need, log: Log, motion: Motion) -> Excitation:
    """State what a log can show of an effect by what the effect needs.

    Args:
        effect: its identifier.
        need: of the effect.
        log: as it was read.
        motion: facts of it.

    Returns:
        Whether the log can show the effect, where, and why or why not.
    """
    if need.speeds and (by := by_speeds(effect, log, motion)) is not None:
        return by
    known = motion.asked if need.asked else motion.torque
    if need.steered:
        known = motion.steered
    if not known.any():
        why = "no torque, no current, and no targets with gains: forces are unknown"
        if need.asked:
            why = "no targets with gains and no torque command: what was asked for is unknown"
        if need.steered:
            why = "no targets with gains: what the controller asked for is unknown"
        return Excitation(effect, False, (), why)
    shown = need.passed(motion) & known
    good = need.good
    if need.asked and not (shown & motion.measured).any():
        good = f"{good}; no measured torque or current, so only through the motion"
    where = tuple(motion.joints[shown])
    return Excitation(effect, bool(where), where, good if where else need.lacking)


def by_speeds(effect: str, log: Log, motion: Motion) -> Excitation | None:
    """Of what sits between motors and joints, where a log has the speeds of both; else none.

    Args:
        effect: its identifier.
        log: as it was read.
        motion: facts of it.

    Returns:
        What the log can show, or None where it has not both speeds.
    """
    motors = tuple(m for m in log.motors if log.has("motor_velocity", m))
    if motors and (motion.reversals > 0).any():
        return Excitation(effect, True, motors, "speeds of motors and joints")
    return None


REVERSING = Need(
    lambda motion: motion.reversing, "motion reverses", f"no joint reverses {REVERSALS} times"
)
SWINGING = Need(
    lambda motion: motion.swinging, "several postures", f"no joint swings by {SWING} rad"
)
