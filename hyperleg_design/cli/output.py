"""What verbs print besides plain text, and what they need installed."""

from __future__ import annotations

import json as json_module

from hyperleg_design.errors import InputError


def emit(content: object) -> None:
    """Print as JSON."""
    print(json_module.dumps(content, indent=2, allow_nan=False))


def require(*modules: str) -> None:
    """Raise one clear error where the learning extra is not installed."""
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
