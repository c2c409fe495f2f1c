"""Check logs of any format, and write them as Parquet: the work behind `hyperleg gap check`."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from hyperleg_design.errors import InputError
from hyperleg_design.gap.checks.agreement import disagreements
from hyperleg_design.gap.checks.check import Check, check_log
from hyperleg_design.gap.logs.log import Log, write_log
from hyperleg_design.gap.logs.readers import open_log
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.writing import check_output_folder, output_folder, write_json


def check_sources(
    sources: Sequence[str | os.PathLike[str]],
    *,
    robot: str = "",
    mapping: Sequence[str] = (),
    out: str | os.PathLike[str] | None = None,
) -> list[Check]:
    """Open and check logs.

    Args:
        sources: files or folders of any known format.
        robot: design, MJCF or URDF to compare with; by default the one that each log names, if any.
        mapping: `THEIRS=OURS` each, columns of CSV files.
        out: folder for `check.json` and every log as Parquet, beside those written before; nothing
            is written by default.

    Returns:
        One check for each log.

    Raises:
        InputError: no source, one that cannot be opened, or a robot that cannot be read.
        OutputError: the folder cannot be written.
    """
    if not sources:
        raise InputError("gap check", "logs", None, "expects files or folders of logs")
    if out is not None:
        check_output_folder(out)
    columns = dict(_pair(text) for text in mapping)
    logs = [log for source in sources for log in open_log(source, mapping=columns)]
    known: dict[str, Subject] = {}
    apart = disagreements(logs)
    checks = [
        check.with_findings(apart.get(log.name, ()))
        for log, check in ((log, check_log(log, _subject(log, robot, known))) for log in logs)
    ]
    if out is not None:
        with output_folder(out, keep=("*.parquet",)) as folder:
            write_json(folder / "check.json", [check.mapping() for check in checks])
            for name, log in zip(_names(logs), logs, strict=True):
                write_log(folder / f"{name}.parquet", log)
    return checks


def _pair(text: str) -> tuple[str, str]:
    theirs, sign, ours = text.partition("=")
    if not sign or not theirs or not ours:
        raise InputError("--map", "", text, "expects THEIRS=OURS, such as q1=position/knee")
    return theirs, ours


def _subject(log: Log, robot: str, known: dict[str, Subject]) -> Subject | None:
    """The robot as it is described, whatever the log says of it, so that a log of another robot is
    told and not refused.
    """
    name = robot or log.metadata.robot
    if not name:
        return None
    beside = Path(log.folder) / name
    place = str(beside) if log.folder and not robot and beside.is_file() else name
    if place not in known:
        known[place] = load_subject(place, overrides=log.metadata.overrides)
    return known[place]


def _names(logs: Sequence[Log]) -> list[str]:
    """Of files, each once."""
    names: list[str] = []
    for log in logs:
        name = "".join(c if c.isalnum() or c in "-._" else "_" for c in log.name) or "log"
        names.append(name if name not in names else f"{name}_{len(names)}")
    return names
