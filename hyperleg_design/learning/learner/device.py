"""Updates on another device than the simulations: what an update reads is moved there, and what it
changed is moved back.
"""

from __future__ import annotations

import contextlib
import copy
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import torch

from hyperleg_design.errors import InputError

if TYPE_CHECKING:
    from rsl_rl.algorithms import PPO
    from rsl_rl.storage import RolloutStorage

HOST = "cpu"
"""Where simulations run and policies act."""


def check_device(name: str) -> str:
    """Check that torch can compute on a device.

    Args:
        name: as torch writes it: `cpu`, `cuda`, `cuda:1`.

    Returns:
        The name.

    Raises:
        InputError: unknown, or not there.
    """
    try:
        torch.zeros(1, device=name)
    except (RuntimeError, AssertionError, NotImplementedError):
        remedy = "torch has no such device here; leave the option out to learn on the processor"
        raise InputError("--device", "", name, remedy) from None
    return name


@contextlib.contextmanager
def learning_on(algorithm: PPO, device: str) -> Iterator[None]:
    """Let an algorithm update its networks on a device.

    Args:
        algorithm: with a full storage; its networks, its optimiser and a copy of its storage are on
            the device meanwhile, and on the processor again afterwards, the storage cleared.
        device: as torch writes it. Nothing is moved for `cpu`.
    """
    if device == HOST:
        yield
        return
    storage = algorithm.storage
    try:
        _move(algorithm, device)
        algorithm.storage = _moved_storage(storage, device)
        yield
    finally:
        algorithm.storage = storage
        _move(algorithm, HOST)
    storage.clear()


def _move(algorithm: PPO, device: str) -> None:
    """Move networks, the optimiser's state and mirror maps, in place."""
    algorithm.device = device
    algorithm.actor.to(device)
    algorithm.critic.to(device)
    for state in algorithm.optimizer.state.values():
        for key, value in state.items():
            if key != "step":  # torch keeps it on the processor
                state[key] = value.to(device)
    if algorithm.symmetry is not None:
        algorithm.symmetry.mirrors.to(device)


def _moved_storage(storage: RolloutStorage, device: str) -> RolloutStorage:
    """A copy of a storage on a device."""

    def moved(value: Any) -> Any:
        if isinstance(value, tuple):
            return tuple(moved(each) for each in value)
        return value.to(device) if hasattr(value, "to") else value

    result = copy.copy(storage)
    result.__dict__.update({key: moved(value) for key, value in vars(storage).items()})
    result.device = device
    return result
