"""All that an environment's future depends on, taken out and put back, so that a run can go on bit
for bit.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError

if TYPE_CHECKING:
    from hyperleg_design.simulation.environment import Environment
    from hyperleg_design.simulation.stepping.chunk import Chunk

_ARRAYS = (
    "action",
    "previous_action",
    "smoothed",
    "motor_torque",
    "motor_velocity",
    "sensors",
    "episode_step",
    "_clock_start",
)


def take_snapshot(environment: Environment) -> dict[str, Any]:
    """Take the state of an environment that has been reset.

    Settings that were changed since it was made (assist, rewards, commands) are not part of it.

    Args:
        environment: the environment.

    Returns:
        Numbers, texts and arrays in nested mappings.
    """
    return {
        "simulations": environment.simulations,
        "chunks": [_of_chunk(chunk) for chunk in environment.chunks],
    }


def put_snapshot(environment: Environment, snapshot: dict[str, Any]) -> None:
    """Put an environment made with the same arguments back into a state.

    Args:
        environment: made with the same arguments as the one that the state is of.
        snapshot: as `take_snapshot` gives it.

    Raises:
        InputError: the state is of another environment.
    """
    if snapshot["simulations"] != environment.simulations or len(snapshot["chunks"]) != len(
        environment.chunks
    ):
        raise InputError(
            "snapshot", "simulations", snapshot["simulations"], f"must be {environment.simulations}"
        )
    environment.reset()
    for chunk, state in zip(environment.chunks, snapshot["chunks"], strict=True):
        _into_chunk(chunk, state)


def _of_chunk(chunk: Chunk) -> dict[str, Any]:
    return {
        "physics": np.array(chunk.batch.state),
        "arrays": {name: np.array(getattr(chunk, name)) for name in _ARRAYS},
        "thermal": chunk.thermal.average.copy(),
        "commander": {
            k: v.copy() for k, v in vars(chunk.commander).items() if isinstance(v, np.ndarray)
        },
        "motion": _fields(chunk.motion),
        "goal": None if chunk.goal is None else _fields(chunk.goal),
        "random": chunk.rng.state,
        **({} if chunk.drive.chain is None else {"chain": chunk.drive.chain.state()}),
    }


def _into_chunk(chunk: Chunk, state: dict[str, Any]) -> None:
    if state["physics"].shape != chunk.batch.state.shape:
        raise InputError(
            "snapshot",
            "physics",
            state["physics"].shape,
            f"must have the shape {chunk.batch.state.shape}; it is of another robot",
        )
    chunk.batch.state[:] = state["physics"]
    for name, value in state["arrays"].items():
        getattr(chunk, name)[:] = value
    chunk.thermal.average[:] = state["thermal"]
    for name, value in state["commander"].items():
        getattr(chunk.commander, name)[:] = value
    for name, value in state["motion"].items():
        setattr(chunk.motion, name, value.copy())
    if chunk.drive.chain is not None:
        chunk.drive.chain.put_state(state["chain"])
    if state["goal"] is not None:
        for name, value in state["goal"].items():
            setattr(chunk.goal, name, value.copy())
    chunk.rng.restore(state["random"])


def _fields(record: Any) -> dict[str, np.ndarray]:
    return {f.name: np.array(getattr(record, f.name)) for f in dataclasses.fields(record)}
