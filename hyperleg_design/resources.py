"""Where the content folders are: beside the package in a checkout, inside it when installed from a
wheel.

This is the only place in the package that knows; `HYPERLEG_HOME` overrides it.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path

from hyperleg_design.errors import InputError, meant

CONTENT = ("descriptions", "motors", "sweeps", "sim")
NOUNS = {"descriptions": "design", "motors": "motor", "sweeps": "sweep", "sim": "sim"}
"""What a file of each content folder is, for errors."""
POLICIES = "policies"
"""Folder of the shipped policies in `sim/`."""


def home() -> Path:
    """Find the folder that holds the content folders of `CONTENT`.

    Raises:
        InputError: `HYPERLEG_HOME` is set and names no such folder.
    """
    chosen = os.environ.get("HYPERLEG_HOME")
    if chosen:
        if not (Path(chosen) / "descriptions").is_dir():
            raise InputError(
                "HYPERLEG_HOME", "", chosen, "is not a folder with descriptions/, motors/, sweeps/"
            )
        return Path(chosen)
    return _own_home()


@cache
def _own_home() -> Path:
    package = Path(__file__).resolve().parent
    inside = package / "content"
    return inside if inside.is_dir() else package.parent


def content_folder(kind: str) -> Path:
    """Find a content folder.

    Args:
        kind: one of `CONTENT`.

    Returns:
        Its path.

    Raises:
        ValueError: another kind.
    """
    if kind not in CONTENT:
        raise ValueError(f"no content folder {kind!r}; there are {', '.join(CONTENT)}")
    return _inside(home(), kind)


@cache
def _inside(folder: Path, kind: str) -> Path:
    """The same path object each time, because a path keeps its hash, and catalogues are looked up
    by it thousands of times.
    """
    return folder / kind


def find(kind: str, name: str | os.PathLike[str], suffix: str = ".yaml", noun: str = "") -> Path:
    """Find a content file that a user names: a path as it stands, or the bare name of a shipped
    file.

    Args:
        kind: content folder, one of `CONTENT`.
        name: path to a file, or a name such as `hyperleg`.
        suffix: ending of shipped files.
        noun: what errors call it, where that is also how the names of such files begin.

    Returns:
        The path of the file.

    Raises:
        InputError: neither exists; the message lists what is shipped.
    """
    path = Path(name)
    try:
        if (path.suffix or len(path.parts) > 1) and path.is_file():
            return path
        shipped = content_folder(kind) / f"{name}{suffix}"
        if path.name == str(name) and shipped.is_file():
            return shipped
    except OSError as error:  # a name too long, a folder closed to us
        remedy = f"cannot be read ({error.strerror})"
        raise InputError(noun or NOUNS[kind], "", str(name), remedy) from None
    known = [each for each in names(kind, suffix) if each.startswith(noun)]
    raise _absent(noun or NOUNS[kind], name, known)


def _absent(noun: str, name: str | os.PathLike[str], known: list[str]) -> InputError:
    """The error of a file that is not there, or is a folder."""
    reason = "is a folder, not a file" if str(name) and Path(name).is_dir() else "no such file"
    shipped = meant(str(name), known, f"shipped: {', '.join(known) or 'none'}")
    return InputError(noun, "", str(name), f"{reason}; {shipped}")


@contextmanager
def named_in(where: str, field: str) -> Iterator[None]:
    """Say of a file that is not found where it was named.

    Args:
        where: file that names it.
        field: of that file.

    Yields:
        Nothing.

    Raises:
        InputError: there is no such file; names both.
    """
    try:
        yield
    except InputError as error:
        if error.field or error.where not in (*NOUNS.values(), "task", "preset"):
            raise
        raise InputError(where, field, error.value, error.remedy) from None


def names(kind: str, suffix: str = ".yaml") -> list[str]:
    """List the shipped files of a kind.

    Args:
        kind: content folder, one of `CONTENT`.
        suffix: ending of the files.

    Returns:
        Their names without the ending, sorted.
    """
    return sorted(p.name[: -len(suffix)] for p in content_folder(kind).glob(f"*{suffix}"))


def sim_names(what: str) -> list[str]:
    """List the shipped files `sim/WHAT_NAME.yaml`.

    Args:
        what: kind of file, such as `task`, `preset` or `protocol`.

    Returns:
        The names, without kind and ending.
    """
    return [n.removeprefix(f"{what}_") for n in names("sim") if n.startswith(f"{what}_")]


def shipped_folder() -> Path:
    """Find the folder of the shipped policies.

    Returns:
        Its path, which need not exist.
    """
    return content_folder("sim") / POLICIES


def find_sim(what: str, name: str | os.PathLike[str]) -> Path:
    """Find the file of a task, preset or protocol.

    Args:
        what: kind of file, such as `task`.
        name: of a shipped one, or a path.

    Returns:
        The path of the file.

    Raises:
        InputError: neither; the message lists what is shipped.
    """
    known = sim_names(what)
    path = find("sim", f"{what}_{name}") if str(name) in known else Path(name)
    if not path.is_file():
        raise _absent(what, name, known)
    return path
