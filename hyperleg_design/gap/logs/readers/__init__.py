"""Readers of logs: every format ends as a `Log` that states what its source lacks; which reader
fits is told by the content.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.log import Log, read_log
from hyperleg_design.gap.logs.metadata import metadata_from_mapping
from hyperleg_design.gap.logs.readers.bam import is_bam, read_bam
from hyperleg_design.gap.logs.readers.lerobot import is_lerobot, read_lerobot
from hyperleg_design.gap.logs.readers.mcap import MAGIC
from hyperleg_design.gap.logs.readers.pace import read_pace
from hyperleg_design.gap.logs.readers.rosbag import SQLITE, is_bag, read_bag
from hyperleg_design.gap.logs.readers.sage import is_sage, read_sage
from hyperleg_design.gap.logs.readers.table import read_csv

FORMATS = "Parquet, CSV, PACE .pt, BAM JSON, SAGE folder, LeRobot dataset, MCAP or ROS 2 bag"
"""What can be opened."""
_TEXTS = (".csv", ".tsv", ".txt")


def open_log(
    path: str | os.PathLike[str],
    *,
    mapping: Mapping[str, str] | None = None,
    metadata: Mapping[str, Any] | None = None,
) -> list[Log]:
    """Read the logs in a file or folder, of any known format.

    Metadata come from the source. The side file (`NAME.json`, `NAME.meta.json` beside a JSON file,
    `hyperleg.json` in a folder) takes precedence over the source, and the argument `metadata` over
    both. Besides the fields of `Metadata` these may name `joints` (in the source's order, where it
    names none), `columns` (of a CSV file, ours by the file's) and `units`.

    Args:
        path: file or folder; a folder that is no recording itself gives the logs of all recordings
            in it.
        mapping: our column by the file's own, for CSV.
        metadata: fields that win.

    Returns:
        The logs.

    Raises:
        InputError: missing, of no known format, damaged, empty, or without what every log needs.
    """
    path = Path(path)
    if not path.exists():
        raise InputError(str(path), "", None, "does not exist")
    if path.is_dir():
        return _open_folder(path, metadata)
    with path.open("rb") as stream:
        magic = stream.read(512)
    if not magic:
        raise InputError(path.name, "", None, "is an empty file")
    if magic.startswith(b"PAR1") or path.suffix.lower() == ".parquet":
        return [_overruled(read_log(path), metadata)]
    if magic.startswith(b"PK\x03\x04"):
        return read_pace(path, metadata)
    if magic.startswith((SQLITE, MAGIC)):
        return read_bag(path, metadata)
    if magic.lstrip(b"\xef\xbb\xbf \t\r\n").startswith((b"{", b"[")):
        return read_bam(path, metadata)
    if magic.startswith((b"type,timestamp,positions",)):
        return read_sage(path, metadata)
    if b"\0" in magic:
        raise InputError(path.name, "", None, f"is of no known format: expects {FORMATS}")
    return read_csv(path, metadata, mapping)


def _open_folder(path: Path, metadata: Mapping[str, Any] | None) -> list[Log]:
    for fits, read in ((is_sage, read_sage), (is_lerobot, read_lerobot), (is_bag, read_bag)):
        if fits(path):
            return read(path, metadata)
    inside = sorted(p for p in path.iterdir() if not p.name.startswith("."))
    kinds, endings = (is_sage, is_lerobot, is_bag), (".parquet", ".pt", ".mcap", ".db3", *_TEXTS)
    folders = [p for p in inside if p.is_dir() and any(fits(p) for fits in kinds)]
    inside = [p for p in inside if p.is_file()]
    files = [p for p in inside if p.suffix.lower() in endings or _is_bam(p)]
    if not folders and not files:
        raise InputError(str(path), "", None, f"holds no logs: expects {FORMATS}")
    return [
        log for source in sorted(folders + files) for log in open_log(source, metadata=metadata)
    ]


def _is_bam(path: Path) -> bool:
    if path.suffix.lower() != ".json":
        return False
    try:
        return is_bam(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError, RecursionError):
        return False


def _overruled(log: Log, metadata: Mapping[str, Any] | None) -> Log:
    if not metadata:
        return log
    return log.changed(
        metadata=metadata_from_mapping({**log.metadata.mapping(), **metadata}, "metadata")
    )
