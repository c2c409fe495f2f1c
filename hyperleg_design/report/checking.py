"""Checks of files of every kind, for people and programs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from hyperleg_design import resources
from hyperleg_design.errors import HyperlegError, InputError
from hyperleg_design.reading import read_yaml
from hyperleg_design.robot.check import check_file, finding_of
from hyperleg_design.robot.checks.finding import Finding, finding_lines
from hyperleg_design.sweep.space import load_sweep


def check_paths(paths: Sequence[str]) -> list[dict[str, Any]]:
    """Check files, each by its own rules.

    Args:
        paths: files, or names of shipped designs, motors or sweeps.

    Returns:
        For each: `path`, `errors`, `warnings` (counts) and `findings`; a path that names nothing
        is an error like any other.

    Raises:
        InputError: no paths.
    """
    if not paths:
        raise InputError(
            "check", "", None, "expects files, or names of shipped designs, motors or sweeps"
        )
    results = []
    for path in paths:
        findings = _check(path)
        errors = sum(f.severity == "error" for f in findings)
        results.append(
            {
                "path": path,
                "errors": errors,
                "warnings": len(findings) - errors,
                "findings": [asdict(f) for f in findings],
            }
        )
    return results


def _check(path: str) -> list[Finding]:
    try:
        place = _find(path)
        if place.suffix in (".yaml", ".yml") and {"axes", "sampling"} & set(read_yaml(place)):
            load_sweep(place)
            return []
        return check_file(place)
    except InputError as error:
        return [finding_of(error)]
    except HyperlegError as error:
        return [Finding("error", path, str(error))]


def _find(path: str) -> Path:
    """A file, or a shipped design, motor or sweep by name."""
    if Path(path).is_file():
        return Path(path)
    for kind in ("descriptions", "motors", "sweeps"):
        if path in resources.names(kind):
            return resources.find(kind, path)
    if Path(path).is_dir():
        raise InputError(path, "", None, "is a folder; name the files in it")
    raise InputError(
        path,
        "",
        None,
        "no such file; a name must be that of a shipped design, motor or sweep (hyperleg list)",
    )


def checks_text(findings: list[dict[str, Any]]) -> str:
    """Write findings as text for a terminal.

    Args:
        findings: as `check_paths` returns them.

    Returns:
        The text.
    """
    lines = []
    for entry in findings:
        own = finding_lines(Finding(**f) for f in entry["findings"])
        verdict = (
            f"{_counted(entry['errors'], 'error')}, {_counted(entry['warnings'], 'warning')}"
            if own
            else "good"
        )
        verdict += ", equal ones in one line" if len(own) < len(entry["findings"]) else ""
        lines.append(f"{entry['path']}: {verdict}")
        lines += [f"  {line}" for line in own]
    return "\n".join(lines)


def _counted(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
