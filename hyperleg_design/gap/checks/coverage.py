"""Whether reference logs show the motions of the logs under test."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hyperleg_design.gap.model.joint_units import unit_at
from hyperleg_design.gap.signals.signals import Signals

FASTER = 1.25
"""Speed under test over that of the references from which a joint moves faster [-] (assumed)."""
FURTHER = 0.2
"""Part of its range under test that a joint spends outside that of the references, from which it
moves further [-] (assumed)."""
REMEDY = "record references of the same motion"
ENDS = (1.0, 99.0)
"""Percentiles of positions and speeds that count as their ends [%]."""


def beyond_references(tests: Sequence[Signals], references: Sequence[Signals]) -> list[str]:
    """Find joints that move faster or further under test than in any reference.

    What a model lacks in such motion no reference tells, so a healthy robot may seem to have
    changed.

    Args:
        tests: logs under test of one robot.
        references: logs of the healthy robot; none where there are none.

    Returns:
        A remark for each such joint.
    """
    if not references:
        return []
    (low, high, speed), (below, above, usual) = _ends(tests), _ends(references)
    outside = np.maximum(below - low, 0.0) + np.maximum(high - above, 0.0)
    further = outside > FURTHER * np.maximum(high - low, 1e-9)
    remarks = []
    for place, joint in enumerate(tests[0].subject.joints):
        more = []
        unit = unit_at(tests[0].subject, "joint", joint, "rad")
        if speed[place] > FASTER * usual[place]:
            more.append(f"at up to {speed[place]:.3g} {unit}/s (references {usual[place]:.3g})")
        if further[place]:
            more.append(
                f"from {low[place]:.3g} to {high[place]:.3g} {unit} (references "
                f"{below[place]:.3g} to {above[place]:.3g})"
            )
        if more:
            remarks.append(
                f"joint {joint} moves {' and '.join(more)}: references do not tell what the "
                f"model lacks there; {REMEDY}"
            )
    return remarks


def _ends(logs: Sequence[Signals]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Ends of the positions [rad], and of the speed [rad/s], of each joint over some logs."""
    positions = np.concatenate([signals.position for signals in logs])
    speeds = np.abs(np.concatenate([signals.velocity for signals in logs]))
    low, high = np.nanpercentile(positions, ENDS, axis=0)
    return low, high, np.nanpercentile(speeds, ENDS[1], axis=0)
