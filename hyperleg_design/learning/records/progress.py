"""Records of a training's progress: a line of JSON for each iteration, TensorBoard's events, and a
line of text.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.learning.records.status import PROGRESS
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


def progress_line(
    task: str,
    robot: str,
    measures: Mapping[str, Any],
    trial: Mapping[str, float],
    left: float,
) -> str:
    """Describe the latest iteration in one line of text.

    Args:
        task: name of the task.
        robot: name of the design, and the seed.
        measures: of the iteration.
        trial: measures of the latest trial; empty before the first.
        left: time that is left [s].

    Returns:
        The line.
    """
    terms = " ".join(f"{name} {value:+.2f}" for name, value in measures["terms"].items() if value)
    parts = [
        f"{task} {robot}",
        f"{measures['steps'] / 1e6:.2f}/{measures['total'] / 1e6:.1f} M steps, "
        f"{measures['rate']:.0f}/s",
        f"stage {measures['stage']}, assist {measures['assist']:.2f}",
        f"reward {measures['reward']:.2f} ({terms})",
        f"speed {measures['speed']:.2f} m/s, falls {measures['falls']:.1f}/min, CoT "
        f"{measures['cost_of_transport']:.2f}",
        f"rate {measures['learning_rate']:.1e}",
    ]
    if trial:
        parts.append("trial " + " ".join(f"{name} {value:.2f}" for name, value in trial.items()))
    return " | ".join([*parts, f"left {left / 60:.0f} min"])


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
