"""Joints that a limit cycle unsettles, and what may be to blame for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hyperleg_design.gap.inference.samples import Samples
    from hyperleg_design.gap.signals.signals import Signals


MOVED = 0.3
"""Share of the largest joint's swing from which a joint's own loop and motors may be to blame."""
UNSETTLING = (
    "command_delay",
    "actuator_bandwidth",
    "controller_gain",
    "transmission_elasticity",
    "backlash",
)
"""Effects that can bring a control loop to the edge of its stability."""


def unsettled(samples: Samples) -> tuple[str, ...]:
    """Joints that chatter in any log, and did not in reference logs."""
    signals = [s.signals for s in samples.filtered_logs]
    joints = signals[0].subject.joints
    return tuple(
        joints[j] for j in np.flatnonzero(np.broadcast_to(in_limit_cycle(signals), len(joints)))
    )


def shaking(samples: Samples) -> tuple[str, ...]:
    """Those of the unsettled joints whose own loops or belts may be to blame, in any log: the
    others are shaken along.
    """
    names = unsettled(samples)
    signals = [
        s.signals
        for s in samples.filtered_logs
        if s.signals.limit_cycle is not None and s.signals.limit_cycle.joints.any()
    ]
    found: set[str] = set()
    for one in signals:
        assert one.limit_cycle is not None
        size = np.sqrt(np.mean(one.limit_cycle.speed**2, 0)) * one.limit_cycle.joints
        found |= {one.subject.joints[j] for j in np.flatnonzero(size >= MOVED * size.max())}
    return tuple(name for name in names if name in found)


def swings(signals: Sequence[Signals], joint: str) -> str:
    """How a joint chatters, in the log where it does most; for people."""
    place = signals[0].subject.joints.index(joint)
    shaken = [
        s.limit_cycle
        for s in signals
        if s.limit_cycle is not None and np.isfinite(s.limit_cycle.frequency[place])
    ]
    size, frequency = max(
        (float(np.sqrt(np.mean(c.speed[:, place] ** 2))), float(c.frequency[place])) for c in shaken
    )
    return (
        f"swings to and fro by {size:.2g} rad/s at {frequency:.0f} Hz (or a frequency that this "
        f"log's rate folds there), which nothing commands: "
        f"its control loop is on the edge of stability, as of {', '.join(UNSETTLING)}"
    )


def in_limit_cycle(signals: Sequence[Signals]) -> np.ndarray:
    """Which joints are unsettled in any of some logs `(n,)` of bool; `()`, False, where none is in
    any.
    """
    return np.asarray(
        np.any([s.limit_cycle.joints for s in signals if s.limit_cycle is not None], 0)
    )


def newly(signals: Sequence[Signals], references: Sequence[Signals]) -> list[Signals]:
    """Logs in which only those joints count as unsettled that were settled in all reference
    logs.
    """
    known = in_limit_cycle(references)
    return [
        s
        if s.limit_cycle is None
        else replace(s, limit_cycle=replace(s.limit_cycle, joints=s.limit_cycle.joints & ~known))
        for s in signals
    ]
