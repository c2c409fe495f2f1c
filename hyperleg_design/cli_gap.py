"""Verbs of `hyperleg gap` that measure, diagnose, plan and try; no logic of their own."""

from __future__ import annotations

import json as json_module
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from hyperleg_design.errors import InputError


def emit(content: object) -> None:
    """Print as JSON."""
    print(json_module.dumps(content, indent=2, allow_nan=False))


@dataclass(frozen=True, kw_only=True)
class GapMeasure:
    """Measure the gap by signal, joint, motor and regime against the repeatability floor."""

    robot: str = ""
    """Shipped design, YAML, MJCF or URDF; by default what the logs name."""
    logs: tuple[str, ...]
    """Logs to be measured, files or folders of any format that `hyperleg gap check` reads."""
    reference: tuple[str, ...] = ()
    """Logs of the healthy robot."""
    out: Path | None = None
    """Folder to write gap.json to."""
    json: bool = False
    """Print JSON."""

    def run(self) -> None:
        """Measure."""
        from hyperleg_design.gap.intake import take_in
        from hyperleg_design.gap.measure import measure
        from hyperleg_design.report.gap_text import gap_text
        from hyperleg_design.writing import output_folder, write_json

        found = take_in(self.robot, self.logs, self.reference)
        gap = measure(found.tests, found.references)
        if self.out is not None:
            with output_folder(self.out) as folder:
                write_json(folder / "gap.json", gap.mapping())
        if self.json:
            emit(gap.mapping())
        else:
            print(gap_text(gap))


@dataclass(frozen=True, kw_only=True)
class GapDiagnose:
    """Say where hardware and simulation differ, which effect is the cause, and how far the gap shrinks once it is added."""

    robot: str = ""
    """Shipped design, YAML, MJCF or URDF; by default what the logs name."""
    logs: tuple[str, ...]
    """Logs to be diagnosed, files or folders of any format that `hyperleg gap check` reads."""
    reference: tuple[str, ...] = ()
    """Logs of the healthy robot: they set the floor and the calibration."""
    out: Path
    """Folder to write diagnosis.json, index.html and its figures to."""
    seed: int = 0
    """Of everything random."""
    thresholds: str = ""
    """Rules of the decision, a YAML file; the shipped ones by default."""
    threads: int = 2
    """The answer does not depend on them."""
    json: bool = False
    """Print JSON."""

    def run(self) -> None:
        """Diagnose."""
        from hyperleg_design.report.gap_report import diagnose_to_folder
        from hyperleg_design.report.gap_text import diagnosis_text

        show = None if self.json else print
        found, page = diagnose_to_folder(
            self.robot, self.logs, self.reference, self.out, seed=self.seed, thresholds=self.thresholds or None, threads=self.threads, show=show
        )
        if self.json:
            emit(found)
        else:
            print(diagnosis_text(found))
            print(f"open {page}")


@dataclass(frozen=True, kw_only=True)
class GapExcite:
    """Design the experiments for a rig: targets inside all limits, and which effects each can tell apart."""

    design: str = ""
    """Shipped design or YAML file."""
    robot: str = ""
    """Or an MJCF or URDF file."""
    base: str = "fixed"
    """The rig holds the robot."""
    set: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """PATH=VALUE of a design."""
    rate: float = 200.0
    """Of the targets [Hz]."""
    without_torque: bool = False
    """The rig measures neither torque nor current."""
    format: str = "csv"
    """csv, parquet or both."""
    seed: int = 0
    """Of the multi-sines' phases."""
    out: Path
    """Folder to write targets, plan.json and figures to."""

    def run(self) -> None:
        """Design them."""
        from hyperleg_design.report.gap_report import excite_to_folder

        if bool(self.design) == bool(self.robot):
            raise InputError("gap excite", "", None, "expects --design or --robot")
        print(
            excite_to_folder(
                self.robot or self.design, self.out, base=self.base, rate=self.rate, torque=not self.without_torque, kinds=self.format,
                seed=self.seed, overrides=self.set, progress=True,
            )
        )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class GapBlind:
    """Make a trial with sealed truth in a process of its own, and diagnose its cases; goes on where it was stopped."""

    cases: int = 240
    """How many."""
    seed: int
    """Of the trial; never tune on one that is to be scored."""
    plants: tuple[str, ...] = ("rig", "other", "walking")
    """That make the logs."""
    workers: int = 2
    """Processes side by side."""
    only_make: bool = False
    """Do not diagnose yet."""
    out: Path
    """Folder of the trial."""

    def run(self) -> None:
        """Make and diagnose."""
        from hyperleg_design.gap.blind.trial import diagnose_trial, make_trial

        seal = make_trial(self.cases, self.seed, self.out, plants=self.plants, workers=self.workers, progress=True)
        print(f"{seal.cases} cases, key sealed: sha256 {seal.sha256}")
        if not self.only_make:
            diagnose_trial(self.out, workers=self.workers, progress=True)
            print(f"now, once: hyperleg gap score {self.out}")


@dataclass(frozen=True, kw_only=True)
class GapScore:
    """Open a trial's key, once, and compare its diagnoses with the truth; or score the real logs with withheld truth."""

    folder: Annotated[str, tyro.conf.Positional] = ""
    """Of the trial."""
    real: str = ""
    """Instead: folder of the real logs."""
    reread: bool = False
    """Read the table of a trial that was scored before."""

    def run(self) -> None:
        """Score."""
        from hyperleg_design.gap.blind.real import score_real
        from hyperleg_design.gap.blind.score import score

        if bool(self.folder) == bool(self.real):
            raise InputError("gap score", "", None, "expects the folder of a trial, or --real with the folder of the real logs")
        print(score_real(self.real, progress=True).markdown() if self.real else score(self.folder, reread=self.reread).markdown())


VERBS = {"measure": GapMeasure, "diagnose": GapDiagnose, "excite": GapExcite, "blind": GapBlind, "score": GapScore}
"""By name; `cli` adds its own."""
