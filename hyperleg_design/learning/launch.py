"""Trainings as processes of their own, with the surroundings that make them fast."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

THREADS = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS")
MALLOC = {
    "MALLOC_MMAP_THRESHOLD_": "4000000000",
    "MALLOC_TRIM_THRESHOLD_": "16000000000",
    "MALLOC_TOP_PAD_": "67000000",
    "MALLOC_ARENA_MAX": "2",
}
"""Keeps glibc from giving memory back to the system and fetching it anew, a third of the system's
time otherwise."""


def surroundings(threads: int = 1) -> dict[str, str]:
    """Collect the environment variables of a training.

    Args:
        threads: of the training.

    Returns:
        This process's variables with those that make a training fast.
    """
    return {**os.environ, **MALLOC, **dict.fromkeys(THREADS, str(threads))}


def command(arguments: Mapping[str, object]) -> list[str]:
    """Write the command line of a training.

    Args:
        arguments: as `train` takes them, names and paths only.

    Returns:
        The words of the command.
    """
    return [
        sys.executable,
        "-m",
        "hyperleg_design.learning",
        *(f"--{key}={value}" for key, value in arguments.items()),
    ]


def start(arguments: Mapping[str, object], log: Path, threads: int = 1) -> subprocess.Popen[bytes]:
    """Start a training in a process of its own.

    Args:
        arguments: as `train` takes them, names and paths only.
        log: file for its progress.
        threads: of the training.

    Returns:
        The process.
    """
    with log.open("ab") as stream:
        return subprocess.Popen(
            command(arguments),
            stdout=stream,
            stderr=stream,
            stdin=subprocess.DEVNULL,
            env=surroundings(threads),
        )


def run_here(
    arguments: Sequence[str], threads: int = 1, module: str = "hyperleg_design.learning"
) -> None:
    """Replace this process by that of a training.

    Args:
        arguments: of the command line.
        threads: of the training.
        module: that is run.
    """
    os.execve(sys.executable, [sys.executable, "-m", module, *arguments], surroundings(threads))


def surrounded() -> bool:
    """Decide whether this process has the environment variables of a training.

    Returns:
        True if it has.
    """
    return all(os.environ.get(key) == value for key, value in MALLOC.items())
