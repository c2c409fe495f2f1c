"""What a protocol decides about a run of trials: its task, when a trial has arrived, and what is
measured.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from hyperleg_design.evaluation.motion.motor_use import MotorUse
    from hyperleg_design.evaluation.motion.power import CyclePower
    from hyperleg_design.evaluation.rollout import Trial
    from hyperleg_design.simulation.environment import Environment
    from hyperleg_design.simulation.tasks import Task

Measured: TypeAlias = "tuple[dict[str, float], MotorUse | None, CyclePower | None]"
"""Measures of one trial by name, the use of its motors, and its power over the gait cycle."""


@dataclass(frozen=True)
class ProtocolRun:
    """How trials of one policy's task are run and measured under one protocol."""

    task: Task
    """The policy's task with the commands, starting states and time of the protocol."""
    measure: Callable[[Trial], Measured]
    """Computes the measures of one trial."""
    arrived: Callable[[np.ndarray, np.ndarray], np.ndarray] | None = None
    """Tells which trials have arrived, `(n,)`, from the first and the present positions of the
    pelvis, `(n, 3)` [m]; None where the task itself ends a trial that arrives."""
    before_step: Callable[[Environment], None] | None = None
    """Is called before each step of the policy, to set commands that depend on the state."""
