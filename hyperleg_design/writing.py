"""Files and folders are written whole or not at all, and never over somebody else's."""

from __future__ import annotations

import contextlib
import json
import math
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from hyperleg_design.errors import OutputError

MARKER = ".hyperleg"
"""File that says a folder was made by this package and may be replaced by it."""
MADE = "made by hyperleg; these files are replaced when it is written again:"
"""First line of a marker that lists what was written."""


def write_bytes(path: str | os.PathLike[str], content: bytes) -> Path:
    """Write a file atomically: a temporary file beside it, flushed, then renamed over it.

    Args:
        path: of the file.
        content: its bytes.

    Returns:
        The path.

    Raises:
        OutputError: the disk is full, the place cannot be written or is a folder; the old file, if
            any, is untouched.
    """
    path = Path(path)
    temporary: Path | None = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
        temporary = Path(name)
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        temporary.chmod(0o644)
        temporary.replace(path)
        temporary = None
    except IsADirectoryError:
        raise OutputError(f"{path}: is a folder; give the name of a file") from None
    except OSError as error:
        raise OutputError(
            f"{path}: cannot be written ({error.strerror or error}); free some space or choose "
            f"another folder"
        ) from error
    finally:  # also when the user interrupts
        if temporary is not None:
            with contextlib.suppress(OSError):
                temporary.unlink(missing_ok=True)
    return path


def write_text(path: str | os.PathLike[str], text: str) -> Path:
    """Write text as UTF-8, atomically as `write_bytes` does.

    Args:
        path: of the file.
        text: its content.

    Returns:
        The path.
    """
    return write_bytes(path, text.encode())


def plain(value: Any) -> Any:
    """Write a value as JSON can say it.

    Args:
        value: numbers, texts, and mappings and sequences of them, of Python or numpy.

    Returns:
        The same in Python's own types, None for numbers that are not finite.
    """
    if isinstance(value, Mapping):
        return {str(key): plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [plain(inner) for inner in value]
    number = value.item() if hasattr(value, "item") else value
    return None if isinstance(number, float) and not math.isfinite(number) else number


def write_json(path: str | os.PathLike[str], content: object) -> Path:
    """Write a value as indented JSON, atomically as `write_bytes` does.

    Args:
        path: of the file.
        content: what `json.dumps` can write.

    Returns:
        The path.

    Raises:
        OutputError: as `write_bytes`, or the content holds a number that is not finite, which JSON
        cannot say.
    """
    try:
        text = json.dumps(content, indent=2, allow_nan=False)
    except ValueError as error:
        raise OutputError(
            f"{path}: a result is not a finite number ({error}); nothing was written"
        ) from error
    return write_text(path, text + "\n")


def check_output_file(path: str | os.PathLike[str]) -> None:
    """Check that a file may be written, before work is done for it.

    Args:
        path: of the file.

    Raises:
        OutputError: it is a folder, or nothing can be written where it would stand.
    """
    path = Path(path)
    if path.is_dir():
        raise OutputError(f"{path}: is a folder; give the name of a file")
    place = next(parent for parent in path.absolute().parents if parent.exists())
    try:
        with tempfile.TemporaryFile(dir=place):
            pass
    except OSError as error:
        raise OutputError(
            f"{path}: cannot be written ({error.strerror or error}); choose another folder"
        ) from None


def check_output_folder(folder: str | os.PathLike[str], option: str = "--out") -> Path:
    """Check that a folder may be written: it is missing, empty, or one of ours (it holds `MARKER`).

    Args:
        folder: to be written.
        option: that names it, for the error.

    Returns:
        Its absolute path.

    Raises:
        OutputError: it is a file or lies below one, is closed to writing, or is a folder with
        somebody else's content.
    """
    try:
        folder = Path(folder).resolve()
        if folder.exists() and not folder.is_dir():
            raise OutputError(f"{folder}: is a file, not a folder; choose another {option}")
        place = next(p for p in (folder, *folder.parents) if p.exists())
        if not place.is_dir():
            raise OutputError(f"{place}: is a file, not a folder; choose another {option}")
        if not os.access(place, os.W_OK | os.X_OK):
            raise OutputError(f"{place}: is closed to writing; choose another {option}")
        foreign = folder.is_dir() and not (folder / MARKER).is_file() and any(folder.iterdir())
    except (OSError, ValueError) as error:
        raise OutputError(
            f"{folder}: cannot be read ({getattr(error, 'strerror', None) or error}); choose "
            f"another {option}"
        ) from error
    if foreign:
        raise OutputError(
            f"{folder}: holds files that hyperleg did not write; choose an empty or new folder"
        )
    return folder


@contextmanager
def output_folder(folder: str | os.PathLike[str], keep: Sequence[str] = ()) -> Iterator[Path]:
    """Build a folder aside and put it in place when the block ends well.

    A folder of ours is replaced, but for files that somebody added to it; on an error nothing
    changes.

    Args:
        folder: to be written.
        keep: patterns of files of ours that stay when they are not written anew.

    Yields:
        The temporary folder to write to.

    Raises:
        OutputError: the target is not ours, or cannot be written.
    """
    folder = check_output_folder(folder)
    temporary: Path | None = None
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        temporary = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", dir=folder.parent))
        temporary.chmod(0o755)
        yield temporary
        carried = _carried(folder, temporary, keep)
        written = sorted(
            {str(p.relative_to(temporary)) for p in temporary.rglob("*") if p.is_file()} - carried
        )
        (temporary / MARKER).write_text("\n".join((MADE, *written, "")))
        if folder.exists():
            _swap(folder, temporary)
        else:
            temporary.replace(folder)
    except OSError as error:
        raise OutputError(
            f"{folder}: cannot be written ({error.strerror or error}); free some space or choose "
            f"another folder"
        ) from error
    except OutputError as error:  # of a file inside: name it where it would have stood
        raise OutputError(str(error).replace(str(temporary), str(folder))) from error
    finally:
        if temporary is not None and temporary.exists():
            shutil.rmtree(temporary, ignore_errors=True)


def _carried(folder: Path, new: Path, keep: Sequence[str]) -> set[str]:
    """Copy what somebody added to a folder, and what is to be kept, into its successor; the names
    of what was added.
    """
    marker = folder / MARKER
    lines = marker.read_text(encoding="utf-8").splitlines() if marker.is_file() else []
    if not lines or lines[0] != MADE:
        return set()
    ours, added = set(lines[1:]), set()
    for path in folder.rglob("*"):
        name = str(path.relative_to(folder))
        if (
            name == MARKER
            or not path.is_file()
            or (new / name).exists()
            or (name in ours and not any(path.match(p) for p in keep))
        ):
            continue
        (new / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(path, new / name)
        if name not in ours:
            added.add(name)
    return added


def _swap(folder: Path, new: Path) -> None:
    """Put `new` in the place of `folder`; the old one comes back if that fails."""
    old = Path(tempfile.mkdtemp(prefix=f".{folder.name}.old.", dir=folder.parent))
    try:
        folder.replace(old / "old")
        try:
            new.replace(folder)
        except OSError:
            (old / "old").replace(folder)
            raise
    finally:
        shutil.rmtree(old, ignore_errors=True)
