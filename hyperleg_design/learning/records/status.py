"""Files of a training's folder that others read, without torch."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

RUN, CHECKPOINT, STATUS, PROGRESS, POLICY, CRITIC = (
    "run.json",
    "checkpoint.pt",
    "status.json",
    "progress.jsonl",
    "policy.onnx",
    "critic.onnx",
)


def read_status(folder: Path) -> dict[str, Any] | None:
    """Read the `status.json` of a training.

    Args:
        folder: of the training.

    Returns:
        Its content; None before the first lines of progress.
    """
    try:
        status: dict[str, Any] = json.loads((folder / STATUS).read_text())
    except (OSError, ValueError):
        return None
    return status


def policies(folder: Path) -> list[Path]:
    """List the ONNX files of a training.

    Args:
        folder: of the training.

    Returns:
        The files, earliest first; the last one is the final policy if the training is done.
    """
    final = folder / POLICY
    return [*sorted(folder.glob("late_*.onnx")), *([final] if final.exists() else [])]
