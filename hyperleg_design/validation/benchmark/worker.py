"""Diagnose one case of the benchmark with whatever `hyperleg_design` stands first on the path.

Run as a file, `python -P worker.py CASE ANSWER`, never imported: it must work in checkouts that
have no benchmark. `CASE` holds `case.json`; `ANSWER` gets the diagnosis and the seconds it took.
"""

from __future__ import annotations

import importlib
import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

DIAGNOSE = ("hyperleg_design.gap.pipeline.diagnose", "hyperleg_design.gap.diagnose")
READ = ("hyperleg_design.gap.logs.log", "hyperleg_design.gap.log")


def first(modules: tuple[str, ...], name: str) -> Any:
    """An attribute of the first of some modules that exists and has it; None where none has.

    Args:
        modules: dotted names, in the order in which they are tried.
        name: of the attribute.

    Returns:
        The attribute, or None.
    """
    for module in modules:
        try:
            return getattr(importlib.import_module(module), name)
        except ModuleNotFoundError as error:
            if error.name is None or not module.startswith(error.name):
                raise
        except AttributeError:
            continue
    return None


def main() -> None:
    """Diagnose by the Python interface, or by the command line where no module is known."""
    case, answer = Path(sys.argv[1]), Path(sys.argv[2])
    entry = json.loads((case / "case.json").read_text())
    robot = str(case / entry["robot"]) if (case / entry["robot"]).is_file() else entry["robot"]
    diagnose, read = first(DIAGNOSE, "diagnose"), first(READ, "read_log")
    begun = time.perf_counter()
    if diagnose is None or read is None:
        diagnosis = by_command(case, robot, entry)
    else:
        try:
            logs = [read(case / name) for name in entry["logs"]]
            references = [read(case / name) for name in entry["references"]]
            begun = time.perf_counter()
            result = diagnose(robot, logs, references, seed=0, threads=1)
            diagnosis = result if isinstance(result, dict) else result.mapping()
        except Exception as error:  # a case that breaks the diagnosis is a miss, not the end
            message = f"{type(error).__name__}: {error}"
            diagnosis = {"schema": 1, "verdict": "error", "message": message}
    seconds = time.perf_counter() - begun
    answer.write_text(json.dumps({"diagnosis": diagnosis, "seconds": seconds}))


def by_command(case: Path, robot: str, entry: dict[str, Any]) -> dict[str, Any]:
    """The diagnosis by `hyperleg gap diagnose`.

    Args:
        case: folder of the case.
        robot: its robot.
        entry: what is to be diagnosed.

    Returns:
        The content of `diagnosis.json`.
    """
    out = case / "by_command"
    command = [sys.executable, "-m", "hyperleg_design.cli", "gap", "diagnose", "--robot", robot]
    command += ["--logs", *(str(case / name) for name in entry["logs"])]
    if entry["references"]:
        command += ["--reference", *(str(case / name) for name in entry["references"])]
    command += ["--threads", "1", "--json", "--out", str(out)]
    run = subprocess.run(command, capture_output=True, check=False)
    if run.returncode:
        lines = run.stderr.decode(errors="replace").strip().splitlines()
        return {"verdict": "error", "message": lines[-1] if lines else str(run.returncode)}
    content: dict[str, Any] = json.loads((out / "diagnosis.json").read_text())
    return content


if __name__ == "__main__":
    main()
