"""The file of the design that another design file names as its base."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hyperleg_design import resources
from hyperleg_design.errors import InputError, meant
from hyperleg_design.reading import given_path, read_yaml

WHOLE = ("family", "pelvis")
"""Sections by which a file holds a design that has no base."""


def base_file(path: Path, name: Any) -> Path:
    """Find the file of the design that another one is based on.

    Args:
        path: of the file that names its base.
        name: of the base: the name of a design, or a path with or without `.yaml`.

    Returns:
        The file that is meant from the folder of `path`; else, of a path, that from the working
        directory; else the shipped design of this name.

    Raises:
        InputError: there is none, or it cannot be read; lists the designs that there are.
    """
    text, shipped = str(name), resources.names("descriptions")
    is_path = "/" in text or "\\" in text or text.endswith((".yaml", ".yml"))
    try:
        for place in _places(path, text, is_path):
            if place.is_file():
                return place
    except OSError as error:  # a name too long, a folder closed to us
        remedy = f"cannot be read ({error.strerror})"
        raise InputError(given_path(path), "base", name, remedy) from None
    if text in shipped:
        return resources.find("descriptions", text)
    beside = [file for file in sorted(path.parent.glob("*.yaml")) if file != path]
    known = [*shipped, *(file.stem for file in beside if _holds_design(file))]
    reason = "no such design"
    if is_path:
        reason += ", neither from the folder of this file nor from that of the command"
    remedy = f"{reason}; {meant(Path(text).stem, known)}"
    raise InputError(given_path(path), "base", name, remedy)


def _places(path: Path, name: str, is_path: bool) -> list[Path]:
    """Where the base of a file may lie, the first one first."""
    files = [name, f"{name}.yaml"] if is_path else [f"{name}.yaml"]
    return [path.parent / file for file in files] + [Path(file) for file in files if is_path]


def _holds_design(path: Path, depth: int = 8) -> bool:
    """Whether a file holds a design; training presets have bases, too, but none that is a design.

    `depth` bounds the bases that are followed, which may lead back to themselves.
    """
    try:
        data = read_yaml(path)
    except InputError:
        return False
    if "axes" in data:
        return False
    if any(section in data for section in WHOLE):
        return True
    base = data.get("base")
    if not isinstance(base, str) or depth == 0:
        return False
    if base in resources.names("descriptions"):
        return True
    files = _places(path, base, is_path=True)
    return any(_holds_design(file, depth - 1) for file in files if file.is_file())
