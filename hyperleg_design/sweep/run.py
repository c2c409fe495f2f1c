"""Running a sweep: in chunks of bounded memory, each kept as soon as it is done, joined into one
table at the end.

    OUT/designs.parquet     the table, with the resolved configuration, seed, versions and commit in its metadata
    OUT/summary.json        counts, ranges of the measures, Pareto fronts
    OUT/chunks/             while it runs, or after it was killed: finished chunks and what they belong to

The table depends on the definition and its seed only, not on chunks, interruptions or the number of
processes.
"""  # noqa: E501

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hyperleg_design import provenance
from hyperleg_design.errors import InputError, OutputError
from hyperleg_design.sweep import table
from hyperleg_design.sweep.jobs import completed
from hyperleg_design.sweep.measuring.evaluate import Columns, evaluate_range
from hyperleg_design.sweep.space import load_sweep
from hyperleg_design.sweep.spaces.definition import Sweep
from hyperleg_design.sweep.summary import summarise
from hyperleg_design.writing import (
    MARKER,
    check_output_folder,
    output_folder,
    write_bytes,
    write_json,
    write_text,
)

TABLE, SUMMARY, CHUNKS, STATE = "designs.parquet", "summary.json", "chunks", "state.json"

CHUNK = 4096
"""Samples evaluated and kept at a time: about 20 MB of working memory a variant."""

PACKAGES = ("hyperleg-design", "numpy", "scipy", "pyarrow")
"""Packages whose versions a table records."""


@dataclass(frozen=True, eq=False)
class SweepResult:
    """A finished sweep and where its files are."""

    sweep: Sweep
    folder: Path
    summary: dict[str, Any]

    @property
    def table_path(self) -> Path:
        """Path of the table with one row for each design."""
        return self.folder / TABLE

    def columns(self, names: list[str] | None = None) -> Columns:
        """Read columns of the table.

        Args:
            names: of the columns; all by default.

        Returns:
            Values by column, one for each row.
        """
        return table.read(self.table_path, names)


def run_sweep(
    definition: Sweep | str | Path,
    out: str | Path,
    *,
    resume: bool = True,
    progress: bool = True,
    chunk: int = CHUNK,
    executor: Executor | None = None,
) -> SweepResult:
    """Evaluate all designs of a sweep.

    Args:
        definition: a sweep, a shipped name, or a YAML file.
        out: folder to write.
        resume: go on where an earlier run of the same sweep stopped, or return what it finished;
            otherwise start anew.
        progress: show a bar.
        chunk: samples evaluated and kept at a time; a resumed run keeps its first one.
        executor: spreads chunks over processes or machines; in this process by default.

    Returns:
        The sweep, its folder with the table of all designs, and a summary.

    Raises:
        InputError: the definition is wrong.
        OutputError: the folder is not ours, holds something else (another sweep, another version),
            or cannot be written.
    """
    sweep = definition if isinstance(definition, Sweep) else load_sweep(definition)
    if isinstance(chunk, bool) or not isinstance(chunk, int) or chunk < 1:
        raise InputError("run_sweep", "chunk", chunk, "expects a whole number of at least 1")
    folder = check_output_folder(out)
    made_by = {"versions": provenance.versions(PACKAGES), "commit": provenance.git_commit()}
    state = {"name": sweep.name, "digest": sweep.digest(), **made_by}
    finished, started = _earlier(folder, state, resume)
    if finished is not None:
        return SweepResult(sweep, folder, finished)
    chunks = folder / CHUNKS
    if started is not None:
        chunk = started
    else:
        with _written(folder):
            folder.mkdir(parents=True, exist_ok=True)
            write_text(
                folder / MARKER, "made by hyperleg; replaced as a whole when written again\n"
            )
            shutil.rmtree(chunks, ignore_errors=True)
            chunks.mkdir()
        write_json(chunks / STATE, {**state, "chunk": chunk})
    _evaluate(sweep, chunks, chunk, progress, executor)
    parts = [_chunk_path(chunks, a, b) for a, b in _ranges(sweep.count, chunk)]
    with _written(folder), output_folder(folder) as place:
        table.join(sweep, parts, place / TABLE, {**state, "sweep": sweep.to_mapping()})
        summary = {**state, **summarise(sweep, place / TABLE)}
        write_json(place / SUMMARY, summary)
    return SweepResult(sweep, folder, summary)


def _earlier(
    folder: Path, state: dict[str, Any], resume: bool
) -> tuple[dict[str, Any] | None, int | None]:
    """Summary of a finished run, or chunk size of one that was stopped; neither where to start
    anew.
    """
    finished, stopped = _read_state(folder / SUMMARY), _read_state(folder / CHUNKS / STATE)
    if finished is None and stopped is None:
        # a run killed before its state was there leaves the marker and at most an empty folder of
        # chunks
        names = {entry.name for entry in folder.iterdir()} if folder.is_dir() else set()
        if TABLE in names and resume:
            raise OutputError(
                f"{folder}: holds a sweep whose {SUMMARY} is damaged; choose another folder, or "
                f"restart (--restart) to replace it"
            )
        if TABLE not in names and names - {MARKER, CHUNKS}:
            raise OutputError(
                f"{folder}: holds a result of hyperleg that is no sweep; choose an empty or new "
                f"folder"
            )
        return None, None
    if not resume:
        return None, None
    held = stopped if stopped is not None else finished
    assert held is not None
    if held.get("digest") != state["digest"]:
        was = held.get("name")
        raise OutputError(
            f"{folder}: holds the sweep {was} with another definition, design or motors; choose "
            f"another folder, or restart (--restart) to replace it"
        )
    if (held.get("versions"), held.get("commit")) != (state["versions"], state["commit"]):
        raise OutputError(
            f"{folder}: was made by another version of the code; choose another folder, or restart "
            f"(--restart) to replace it"
        )
    if stopped is not None:
        return None, int(stopped["chunk"])
    return (finished, None) if table.rows_of(folder / TABLE) >= 0 else (None, None)


def _read_state(path: Path) -> dict[str, Any] | None:
    try:
        state = json.loads(path.read_text())
    except (OSError, ValueError):
        return None
    return state if isinstance(state, dict) and "digest" in state else None


@contextmanager
def _written(folder: Path) -> Iterator[None]:
    """Failures of the disk as one clear error."""
    try:
        yield
    except OSError as error:
        raise OutputError(
            f"{folder}: cannot be written ({error.strerror or error}); free some space or choose "
            f"another folder"
        ) from error


def _ranges(count: int, chunk: int) -> list[tuple[int, int]]:
    return [(start, min(start + chunk, count)) for start in range(0, count, chunk)]


def _chunk_path(folder: Path, start: int, stop: int) -> Path:
    return folder / f"{start:08d}-{stop:08d}.parquet"


def _evaluate(
    sweep: Sweep, folder: Path, chunk: int, progress: bool, executor: Executor | None
) -> None:
    """Evaluate and keep the chunks that are missing."""
    from tqdm import tqdm

    variants = len(sweep.variants)
    missing = [
        (a, b)
        for a, b in _ranges(sweep.count, chunk)
        if table.rows_of(_chunk_path(folder, a, b)) != (b - a) * variants
    ]
    have = sweep.size - variants * sum(b - a for a, b in missing)
    with tqdm(
        total=sweep.size,
        initial=have,
        disable=not progress,
        desc=sweep.name,
        unit="design",
        delay=0.5,
    ) as bar:
        for (start, stop), columns in _columns(sweep, missing, executor):
            write_bytes(_chunk_path(folder, start, stop), table.to_bytes(sweep, columns))
            bar.update((stop - start) * variants)


def _columns(
    sweep: Sweep, missing: list[tuple[int, int]], executor: Executor | None
) -> Iterator[tuple[tuple[int, int], Columns]]:
    # in this process, samples are drawn once; they are not sent to others
    samples = (sweep.samples(),) if executor is None else ()
    jobs = (((start, stop), (sweep, start, stop, *samples)) for start, stop in missing)
    yield from completed(evaluate_range, jobs, executor)
