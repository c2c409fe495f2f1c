"""A trial: cases made and sealed by a process of their own, then diagnosed one by one; either part
goes on where it was stopped.

| in the folder | |
|---|---|
| `seal.json` | SHA-256 of the key, written before any case can be seen |
| `key.zip` | the truth; nothing but the scoring opens it |
| `cases/000/case.json` | what the diagnosis is given |
| `cases/000/robot.xml` | the robot, where it is no design |
| `cases/000/logs/`, `references/` | Parquet files |
| `diagnoses/000/` | `diagnosis.json`, `seconds.json` |
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import os
import shutil
import subprocess
import sys
import time
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hyperleg_design.errors import HyperlegError, InputError, OutputError
from hyperleg_design.gap.logs.log import read_log, write_log
from hyperleg_design.gap.pipeline.diagnose import diagnose as own_diagnosis
from hyperleg_design.validation.blind.case import describe
from hyperleg_design.validation.blind.plan import PLANTS, Plan, plan_cases
from hyperleg_design.validation.blind.rig_case import rig_case
from hyperleg_design.validation.blind.walking_case import walking_case
from hyperleg_design.validation.spread import ONE_THREAD, spread
from hyperleg_design.writing import check_output_folder, write_bytes, write_json

SEAL, KEY, CASES, DIAGNOSES, MAKING = "seal.json", "key.zip", "cases", "diagnoses", ".making"
FAILED = "error"
"""Verdict of a diagnosis that raised an error; counts as a miss."""


@dataclass(frozen=True)
class Seal:
    """What is known of a trial before it is scored."""

    sha256: str
    """Of `key.zip`."""
    cases: int
    seed: int
    plants: tuple[str, ...]
    duration: tuple[float, float]
    """Range of the logs' lengths [s]."""


def make_trial(
    cases: int,
    seed: int,
    out: str | os.PathLike[str],
    *,
    plants: Sequence[str] = tuple(PLANTS),
    workers: int = 1,
    progress: bool = False,
    duration: tuple[float, float] = (10.0, 14.0),
) -> Seal:
    """Make a trial in a process of its own and return its seal; one that was stopped goes on.

    Args:
        cases: how many.
        seed: of everything.
        out: folder, new, empty or of this very trial.
        plants: of `plan.PLANTS`.
        workers: processes that simulate.
        progress: show a bar, and the hash as soon as it stands.
        duration: range of the logs' lengths [s].

    Raises:
        InputError: no cases, or an unknown plant.
        OutputError: `out` holds something else, or another trial.
    """
    if cases < 1:
        raise InputError("blind", "cases", cases, "expects at least one")
    unknown = [p for p in plants if p not in PLANTS]
    if unknown or not plants:
        raise InputError("blind", "plants", list(plants), f"choose of {', '.join(PLANTS)}")
    command = [
        sys.executable,
        "-m",
        "hyperleg_design.validation.blind",
        "--cases",
        str(cases),
        "--seed",
        str(seed),
        "--out",
        str(Path(out).resolve()),
    ]
    command += [
        "--workers",
        str(workers),
        "--plants",
        *plants,
        "--duration",
        *(str(d) for d in duration),
        *(["--progress"] if progress else []),
    ]
    run = subprocess.run(
        command,
        env={**os.environ, **ONE_THREAD},
        stdout=None if progress else subprocess.PIPE,
        stderr=None if progress else subprocess.PIPE,
        check=False,
    )
    if run.returncode:
        said = (run.stderr or b"").decode(errors="replace").strip().splitlines()
        raise OutputError(
            f"{out}: the trial could not be made "
            f"({said[-1] if said else f'exit status {run.returncode}'})"
        )
    return read_seal(out)


def read_seal(folder: str | os.PathLike[str]) -> Seal:
    """Seal of a trial.

    Args:
        folder: of the trial.

    Returns:
        The seal.

    Raises:
        InputError: no finished trial there.
    """
    path = Path(folder) / SEAL
    try:
        content = json.loads(path.read_text())
        return Seal(
            content["sha256"],
            content["cases"],
            content["seed"],
            tuple(content["plants"]),
            tuple(content["duration"]),
        )
    except (OSError, ValueError, KeyError, TypeError):
        raise InputError(
            str(folder), "", None, f"holds no finished trial ({SEAL} is missing or unreadable)"
        ) from None


def make_here(
    cases: int,
    seed: int,
    out: Path,
    *,
    plants: Sequence[str],
    workers: int,
    duration: tuple[float, float],
    progress: bool = False,
    say: Callable[[str], None] | None = None,
) -> Seal:
    """What the separate process does: simulate, seal, and only then show the cases. Arguments as
    `make_trial`; `say` is told the hash.

    Args:
        cases: how many.
        seed: of all randomness.
        out: folder to write.
        plants: names of the plants.
        workers: processes that simulate.
        duration: shortest and longest log [s].
        progress: whether to show a bar.
        say: is told the hash.

    Returns:
        The seal.
    """
    asked = {"cases": cases, "seed": seed, "plants": list(plants), "duration": list(duration)}
    if (out / SEAL).is_file():
        seal = read_seal(out)
        if (seal.cases, seal.seed, list(seal.plants), list(seal.duration)) != (
            cases,
            seed,
            list(plants),
            list(duration),
        ):
            raise OutputError(
                f"{out}: holds another trial ({seal.cases} cases, seed {seal.seed}); choose "
                f"another folder"
            )
        if (out / CASES).is_dir():
            return seal
    making = out / MAKING
    plans = plan_cases(cases, seed, plants=plants, duration=duration)
    if not making.is_dir():
        check_output_folder(out)
        (making / CASES).mkdir(parents=True)
        (making / "truth").mkdir()
        write_json(making / "asked.json", asked)
    elif json.loads((making / "asked.json").read_text()) != asked:
        raise OutputError(
            f"{out}: holds the beginning of another trial; choose another folder or remove it"
        )
    (out / ".hyperleg").write_text("a blind trial\n")
    waiting = [p for p in plans if not (making / CASES / _name(p)).is_dir()]
    with _bar(cases, cases - len(waiting), "cases", progress) as bar:
        for _ in spread(_make_one, [(p, str(making)) for p in waiting], workers):
            bar.update()
    key = sealed(
        [json.loads((making / "truth" / f"{_name(p)}.json").read_text()) for p in plans], asked
    )
    digest = hashlib.sha256(key).hexdigest()
    if say is not None:
        say(digest)
    write_json(out / SEAL, {"sha256": digest, **asked})
    write_bytes(out / KEY, key)
    shutil.rmtree(making / "truth")
    (making / CASES).replace(out / CASES)
    shutil.rmtree(making)
    return read_seal(out)


def sealed(truths: list[dict[str, Any]], asked: dict[str, Any]) -> bytes:
    """The key as a zip file, the same bytes for the same truth.

    Args:
        truths: of the cases.
        asked: what the trial was asked for.

    Returns:
        The bytes of the file.
    """
    content = json.dumps({"trial": asked, "cases": truths}, indent=1, allow_nan=False).encode()
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(
            zipfile.ZipInfo("key.json", (1980, 1, 1, 0, 0, 0)), content, zipfile.ZIP_DEFLATED
        )
    return buffer.getvalue()


def _name(plan: Plan) -> str:
    return f"{plan.index:03d}"


def _make_one(plan: Plan, making: str) -> str:
    case = walking_case(plan) if plan.plant == "walking" else rig_case(plan)
    name = _name(plan)
    folder, place = Path(making) / CASES / f".{name}", Path(making) / CASES / name
    shutil.rmtree(folder, ignore_errors=True)
    entry: dict[str, Any] = {"robot": case.robot, "logs": [], "references": []}
    for group, logs in (("logs", case.logs), ("references", case.references)):
        for number, log in enumerate(logs):
            path = f"{group}/{number}.parquet"
            (folder / group).mkdir(parents=True, exist_ok=True)
            write_log(folder / path, log)
            entry[group].append(path)
    if case.mjcf is not None:
        write_bytes(folder / case.robot, case.mjcf.encode())
    write_json(folder / "case.json", entry)
    write_json(Path(making) / "truth" / f"{name}.json", describe(case))
    folder.replace(place)
    return name


def diagnose_trial(
    folder: str | os.PathLike[str],
    *,
    workers: int = 1,
    progress: bool = False,
    diagnose: Callable[..., Any] = own_diagnosis,
) -> int:
    """Diagnose every case that has no diagnosis yet; a stopped run goes on.

    Args:
        folder: of the trial.
        workers: processes, each on one thread.
        progress: show a bar.
        diagnose: `diagnose(robot, logs, reference, threads=)`, by default the room's own; an
            object that can be pickled.

    Returns:
        Number of cases diagnosed now.

    Raises:
        InputError: no finished trial there.
    """
    folder = Path(folder)
    seal = read_seal(folder)
    names = [f"{i:03d}" for i in range(seal.cases)]
    waiting = [n for n in names if not (folder / DIAGNOSES / n / "seconds.json").is_file()]
    with _bar(len(names), len(names) - len(waiting), "diagnoses", progress) as bar:
        for _ in spread(
            _diagnose_one,
            [(str(folder / CASES / n), str(folder / DIAGNOSES / n), diagnose) for n in waiting],
            workers,
        ):
            bar.update()
    return len(waiting)


def _diagnose_one(case: str, out: str, diagnose: Callable[..., Any]) -> None:
    entry = json.loads((Path(case) / "case.json").read_text())
    robot = Path(case) / entry["robot"]
    begun = time.perf_counter()
    try:
        logs = [read_log(Path(case) / p) for p in entry["logs"]]
        references = [read_log(Path(case) / p) for p in entry["references"]]
        diagnosis = as_mapping(
            diagnose(str(robot) if robot.is_file() else entry["robot"], logs, references, threads=1)
        )
    except HyperlegError as error:
        diagnosis = {"schema": 1, "verdict": FAILED, "message": str(error)}
    except Exception as error:
        # one case that breaks the diagnosis is a miss, not the end of a trial
        diagnosis = {"schema": 1, "verdict": FAILED, "message": f"{type(error).__name__}: {error}"}
    seconds = time.perf_counter() - begun
    write_json(Path(out) / "diagnosis.json", diagnosis)
    write_json(Path(out) / "seconds.json", {"seconds": seconds})


def as_mapping(diagnosis: Any) -> dict[str, Any]:
    """A diagnosis in the form of `diagnosis.json`.

    Args:
        diagnosis: a mapping already, or a `Diagnosis`.

    Returns:
        The mapping.
    """
    if isinstance(diagnosis, dict):
        return diagnosis
    content: dict[str, Any] = diagnosis.mapping()
    return content


@contextlib.contextmanager
def _bar(total: int, done: int, what: str, show: bool) -> Any:
    from tqdm import tqdm

    with tqdm(total=total, initial=done, desc=what, disable=not show, unit="case") as bar:
        yield bar
