"""The one place of the benchmark that knows where the diagnosis and its readers live.

A diagnosis runs in a process of its own (`worker.py`), on files, so that another checkout can be
scored by the same runner; rooms of `gap/` that are moved are found by the first module that exists.
"""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import hyperleg_design
from hyperleg_design.errors import InputError
from hyperleg_design.validation.benchmark.case import Recording

READERS = ("hyperleg_design.gap.readers", "hyperleg_design.gap.logs.readers")
"""Modules that may hold `open_log`."""
BLIND = ("hyperleg_design.validation.blind", "hyperleg_design.gap.blind")
"""Packages that may hold the blind plants."""
WORKER = Path(__file__).with_name("worker.py")
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
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
    logs = _first(READERS, "open_log")(path, metadata=metadata)
    return tuple(
        Recording(log.name, log.time, dict(log.signals), log.metadata.mapping()) for log in logs
    )


def blind_module(name: str) -> Any:
    """A module of the blind plants, such as `plan`.

    Args:
        name: of the module.

    Returns:
        The module.

    Raises:
        InputError: no package holds it.
    """
    for package in BLIND:
        try:
            return importlib.import_module(f"{package}.{name}")
        except ModuleNotFoundError as error:
            if error.name is None or not f"{package}.{name}".startswith(error.name):
                raise
    raise InputError("benchmark", name, None, f"is in none of {', '.join(BLIND)}")


def _first(modules: tuple[str, ...], name: str) -> Any:
    for module in modules:
        try:
            return getattr(importlib.import_module(module), name)
        except ModuleNotFoundError as error:
            if error.name is None or not module.startswith(error.name):
                raise
        except AttributeError:
            continue
    raise InputError("benchmark", name, None, f"is in none of {', '.join(modules)}")


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
            command,
            cwd=case,
            env=environment,
            capture_output=True,
            timeout=longest,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return {"verdict": FAILED, "message": f"took more than {longest:g} s"}, longest
    if run.returncode or not out.is_file():
        lines = run.stderr.decode(errors="replace").strip().splitlines()
        message = lines[-1] if lines else f"exit status {run.returncode}"
        return {"verdict": FAILED, "message": message}, 0.0
    answer = json.loads(out.read_text())
    return answer["diagnosis"], float(answer["seconds"])
