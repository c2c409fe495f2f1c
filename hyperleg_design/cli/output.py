"""What verbs print: text for people, or one JSON document for programs."""

from __future__ import annotations

import json as json_module
import os
from dataclasses import asdict, dataclass, is_dataclass
from pathlib import Path
from typing import Any

from hyperleg_design.errors import InputError


@dataclass(frozen=True, kw_only=True)
class Printing:
    """Options of a verb that prints a result."""

    json: bool = False
    """Print one JSON document instead of text."""
    motors: Path | None = None
    """Folder with motors of your own (NAME.yaml), beside the shipped ones."""

    def tell(self, content: object, text: str) -> None:
        """Print a result.

        Args:
            content: for programs.
            text: the same for people.
        """
        if self.json:
            emit(content)
        else:
            print(text)


def emit(content: object) -> None:
    """Print a value as JSON; a dataclass becomes a mapping of its fields.

    Args:
        content: what is printed.
    """
    print(json_module.dumps(content, indent=2, allow_nan=False, default=_plain))


def _plain(value: Any) -> Any:
    """What JSON lacks, in what it has."""
    if is_dataclass(value) and not isinstance(value, type):
        return asdict(value)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"{type(value).__name__} cannot be written as JSON")


def require(*modules: str) -> None:
    """Check that packages of the extra `learning` are installed.

    Args:
        modules: names of the modules.

    Raises:
        InputError: one is missing; states how to install it.
    """
    import importlib.util

    missing = [m for m in modules if importlib.util.find_spec(m) is None]
    if missing:
        raise InputError(
            "train",
            "",
            None,
            f"needs {', '.join(missing)}: make .venv/.learning, or install "
            f"hyperleg-design[learning]",
        )
