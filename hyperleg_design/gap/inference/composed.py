"""What motors give on a robot whose model lacks something: the logs under test as causes that act
in the references, too, leave them.

A cause that is new in the logs under test acts on the robot as it was before. If its drives lag, a
further delay shifts what they gave, not what they were asked for; a motor that gave 0.85 of what is
believed, and now gives 0.75 of that, has lost another 0.85 x 0.25. Traces add up, so that of a new
cause is computed from torques that hold the standing ones already.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.fit import Cause
from hyperleg_design.gap.inference.samples import Samples
from hyperleg_design.gap.signals.filtering import FilteredLog


def after(samples: Samples, causes: Sequence[tuple[Cause, np.ndarray]]) -> Samples:
    """Samples whose logs hold commands and torques of motors as some causes leave them; their
    residuals stay what they are.

    Args:
        samples: of logs.
        causes: that act in drives, and their values `(k,)` each.
    """
    logs = tuple(_after(log, causes) for log in samples.filtered_logs)
    return replace(samples, filtered_logs=logs)


def _after(log: FilteredLog, causes: Sequence[tuple[Cause, np.ndarray]]) -> FilteredLog:
    signals = log.signals
    command, believed = signals.command, signals.believed
    for cause, values in causes:
        left = EFFECTS[cause.effect].trace(signals, cause.location, values[None])
        if command is not None and "drive" in left:
            command = command + np.nan_to_num(left["drive"][0])
        if "motion" in left:
            lost = np.nan_to_num(left["motion"][0]) @ signals.subject.motor_from_joint.T
            believed = believed - lost
    return replace(log, signals=replace(signals, command=command, believed=believed))
