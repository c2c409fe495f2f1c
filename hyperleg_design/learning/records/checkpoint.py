"""Checkpoints: all that a training's future depends on, in one file that is written whole or not at
all.
"""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import torch

from hyperleg_design.errors import InputError, in_short
from hyperleg_design.reading import given_path
from hyperleg_design.writing import write_bytes

FORMAT = "hyperleg-checkpoint-1"
"""Name and version of the file format."""


def save_checkpoint(path: Path, content: dict[str, Any]) -> None:
    """Write a checkpoint as one file, whole or not at all.

    Args:
        path: of the file.
        content: numbers, texts, arrays and tensors in nested mappings.

    Raises:
        OutputError: the disk is full or the place cannot be written; the old file, if any, is
        untouched.
    """
    stream = io.BytesIO()
    torch.save({"format": FORMAT, **_to_tensors(content)}, stream)
    write_bytes(path, stream.getvalue())


def load_checkpoint(path: Path) -> dict[str, Any]:
    """Read a checkpoint; arrays come back as NumPy's, tensors under `networks` as torch's.

    Args:
        path: of the file.

    Returns:
        The content that was saved.

    Raises:
        InputError: missing, truncated, or no checkpoint.
    """
    where = given_path(path)
    try:
        content = torch.load(path, map_location="cpu", weights_only=True)
    except FileNotFoundError:
        raise InputError(where, "", None, "no such checkpoint") from None
    except Exception as error:  # torch raises whatever its readers meet
        reason = in_short(error)
        raise InputError(
            where,
            "",
            None,
            f"is no checkpoint, or is truncated ({reason}); delete it to start anew, or copy it "
            f"back",
        ) from None
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise InputError(
            where,
            "format",
            content.get("format") if isinstance(content, dict) else None,
            f"expects {FORMAT}",
        )
    return {
        key: value if key == "networks" else _to_arrays(value) for key, value in content.items()
    }


def _to_tensors(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return torch.from_numpy(np.ascontiguousarray(value))
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, dict):
        return {k: _to_tensors(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return type(value)(_to_tensors(v) for v in value)
    return value


def _to_arrays(value: Any) -> Any:
    if isinstance(value, torch.Tensor):
        return value.numpy()
    if isinstance(value, dict):
        return {k: _to_arrays(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return type(value)(_to_arrays(v) for v in value)
    return value
