"""Records of a training's progress: a line of JSON for each iteration, and TensorBoard's events."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.learning.status import PROGRESS
from hyperleg_design.writing import write_text


def open_writer(folder: Path, first: int, steps: int) -> Any:
    """Open TensorBoard's writer; what was logged after the checkpoint is taken back.

    Args:
        folder: of the training.
        first: iterations that are done.
        steps: policy steps of an iteration.

    Returns:
        The writer.
    """
    from torch.utils.tensorboard import SummaryWriter

    path = folder / PROGRESS
    if path.exists():
        remaining = [
            line for line in path.read_text().splitlines() if line and _iteration(line) <= first
        ]
        write_text(path, "".join(f"{line}\n" for line in remaining))
    return SummaryWriter(str(folder), purge_step=(first + 1) * steps)


def log_measures(folder: Path, writer: Any, measures: dict[str, Any]) -> None:
    """Add the measures of an iteration to both records.

    Args:
        folder: of the training.
        writer: of `open_writer`.
        measures: numbers by name, nested.
    """
    for name, value in _flat(measures):
        writer.add_scalar(name, value, measures["steps"])
    with (folder / PROGRESS).open("a") as stream:
        stream.write(json.dumps(finite(measures)) + "\n")


def finite(value: Any) -> Any:
    """Replace numbers that are not finite by None, as JSON needs it.

    Args:
        value: a number, or nested mappings of some.

    Returns:
        The same without infinities and NaN.
    """
    if isinstance(value, dict):
        return {k: finite(v) for k, v in value.items()}
    return None if isinstance(value, float) and not np.isfinite(value) else value


def _flat(measures: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, float]]:
    for name, value in measures.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name}/")
        elif np.isfinite(value):
            yield prefix + name, value


def _iteration(line: str) -> int:
    try:
        return int(json.loads(line)["iteration"])
    except (ValueError, KeyError, TypeError):  # cut off when the process was killed
        return 1 << 62
