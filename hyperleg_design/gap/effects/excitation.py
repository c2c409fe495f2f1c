"""What excites an effect: facts of a log's motion, and what a log can say of an effect by them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.logs.log import Log

REVERSALS = 4
"""That friction needs to be told from a constant torque."""
SWING = 0.3
"""Range of a joint that changes what gravity asks of it [rad]."""
SLOW = 0.05
"""Share of the moving time below a tenth of the top speed that counts as slow motion."""
FEW = f"no joint reverses {REVERSALS} times"
STILL = f"no joint swings by {SWING} rad"
REVERSES, POSTURES = "motion reverses", "several postures"


@dataclass(frozen=True)
class Excitation:
    """What a log can say of one effect."""

    effect: str
    """Its identifier."""
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
    """[rad]"""
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

    @property
    def reversing(self) -> np.ndarray:
        """Joints that reverse often enough to tell friction `(n,)` of bool."""
        return np.asarray(self.reversals >= REVERSALS)

    @property
    def swinging(self) -> np.ndarray:
        """Joints that swing far enough to change what gravity asks of them `(n,)` of bool."""
        return np.asarray(self.swing > SWING)


def at_joints(
    effect: str, motion: Motion, passed: np.ndarray, good: str, lacking: str
) -> Excitation:
    """Of what sits at joints: those that pass, of which the torque is known.

    Args:
        effect: its identifier.
        motion: of the log.
        passed: joints that move as the effect needs it `(n,)` of bool.
        good: what is there, where one passes.
        lacking: what is lacking, where none does.
    """
    if not motion.torque.any():
        return Excitation(
            effect,
            False,
            (),
            "no torque, no current, and no targets with gains: forces are unknown",
        )
    shown = passed & motion.torque
    return Excitation(
        effect, bool(shown.any()), tuple(motion.joints[shown]), good if shown.any() else lacking
    )


def at_drives(
    effect: str, motion: Motion, passed: np.ndarray, good: str, lacking: str
) -> Excitation:
    """Of what needs command and measurement of the same motor to be told apart from mechanics;
    arguments as of `at_joints`.

    Args:
        effect: its identifier.
        motion: facts of the log.
        passed: joints that move as the effect needs it `(n,)` of bool.
        good: what is there, where one passes.
        lacking: what is lacking, where none does.

    Returns:
        Whether the log can show it, where, and why or why not.
    """
    if not motion.asked.any():
        return Excitation(
            effect,
            False,
            (),
            "no targets with gains and no torque command: what was asked for is unknown",
        )
    shown = passed & motion.asked
    both = (shown & motion.measured).any()
    text = good if both else f"{good}; no measured torque or current, so only through the motion"
    return Excitation(
        effect, bool(shown.any()), tuple(motion.joints[shown]), text if shown.any() else lacking
    )


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
