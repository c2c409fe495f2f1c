"""Reading logs for the benchmark, and diagnosing its cases.

A diagnosis runs in a process of its own (`worker.py`), on files, so that another checkout can be
scored by the same runner.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import hyperleg_design
from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.readers import open_log
from hyperleg_design.validation.benchmark.case import Recording
from hyperleg_design.validation.spread import ONE_THREAD

WORKER = Path(__file__).with_name("worker.py")
LONGEST = 900.0
"""Time after which a diagnosis is given up [s]."""
FAILED = "error"
"""Verdict of a diagnosis that raised an error or took too long."""


def own_checkout() -> Path:
    """Folder that holds the package that runs."""
    return Path(hyperleg_design.__file__).resolve().parent.parent


def checked_checkout(checkout: Path | None) -> Path:
    """The folder of a checkout, by default of this one.

    Args:
        checkout: the folder; None for this one.

    Returns:
        The folder.

    Raises:
        InputError: it holds no package.
    """
    folder = own_checkout() if checkout is None else Path(checkout).resolve()
    if not (folder / "hyperleg_design" / "__init__.py").is_file():
        raise InputError("benchmark", "checkout", str(checkout), "holds no hyperleg_design")
    return folder


def open_recordings(path: Path, metadata: Mapping[str, Any] | None = None) -> tuple[Recording, ...]:
    """Logs of any format that the package reads.

    Args:
        path: of the file.
        metadata: that the file does not tell.

    Returns:
        The recordings.

    Raises:
        InputError: unreadable.
    """
    return tuple(
        Recording(log.name, log.time, dict(log.signals), log.metadata.mapping())
        for log in open_log(path, metadata=metadata)
    )


def diagnose_folder(
    case: Path, checkout: Path | None = None, *, longest: float = LONGEST
) -> tuple[dict[str, Any], float]:
    """Diagnose the files of a case in a process of its own.

    Args:
        case: folder that `case.write_case` wrote.
        checkout: folder that holds a `hyperleg_design` to be scored; by default this one.
        longest: time after which the process is ended [s].

    Returns:
        The diagnosis in the form of `diagnosis.json`, and the seconds that it took without the
        start of the process. Failures have the verdict `FAILED` and a `message`.

    Raises:
        InputError: the checkout holds no package.
    """
    checkout = checked_checkout(checkout)
    out = case / "answer.json"
    environment = {**os.environ, **ONE_THREAD, "PYTHONPATH": str(checkout)}
    command = [sys.executable, "-P", str(WORKER), str(case), str(out)]
    try:
        run = subprocess.run(
            command, cwd=case, env=environment, capture_output=True, timeout=longest, check=False
        )
    except subprocess.TimeoutExpired:
        return {"verdict": FAILED, "message": f"took more than {longest:g} s"}, longest
    if run.returncode or not out.is_file():
        lines = run.stderr.decode(errors="replace").strip().splitlines()
        message = lines[-1] if lines else f"exit status {run.returncode}"
        return {"verdict": FAILED, "message": message}, 0.0
    answer = json.loads(out.read_text())
    return answer["diagnosis"], float(answer["seconds"])
