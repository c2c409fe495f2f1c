"""Logs of plain rollouts of a simulation."""

from __future__ import annotations

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.recording import TRIAL_SIGNALS, log_of_signals
from hyperleg_design.simulation.drives.told import TOLD
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.rollout import Recording


def log_of_recording(environment: Environment, recording: Recording, simulation: int = 0) -> Log:
    """Make the log of one simulation of `simulation.rollout.rollout`, up to the end of its first
    episode.

    Args:
        environment: that was recorded.
        recording: with all signals.
        simulation: which.

    Returns:
        The log.

    Raises:
        InputError: no such simulation, or a signal that was not kept.
    """
    count = len(recording.first_end)
    if not 0 <= simulation < count:
        raise InputError("recording", "simulation", simulation, f"expects 0 .. {count - 1}")
    missing = [n for n in TRIAL_SIGNALS if n not in recording.signals]
    if missing:
        raise InputError("recording", "signals", missing[0], "was not kept; record with keep=None")
    design = (
        environment.design.take(simulation)
        if environment.design.batch_shape
        else environment.design
    )
    rows = int(recording.first_end[simulation]) * recording.substeps
    found = {
        n: values[simulation, :rows]
        for n, values in recording.signals.items()
        if n in TRIAL_SIGNALS or n.startswith(TOLD)
    }
    return log_of_signals(design, environment.layout, recording.time_step, found, "rollout", {})
