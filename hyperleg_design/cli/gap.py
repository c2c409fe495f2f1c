"""Verbs of `hyperleg gap`: where hardware and simulation differ, and why; no logic of their own."""

from __future__ import annotations

import json as json_module
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro

from hyperleg_design.cli.arguments import AtLeast
from hyperleg_design.cli.output import Printing, emit


@dataclass(frozen=True, kw_only=True)
class Check(Printing):
    """Say what logs can and cannot show: rates, jitter, dropouts, units, excitation of each effect.
    Exit code 2 on errors.
    """

    logs: Annotated[tuple[str, ...], tyro.conf.Positional]
    """Files or folders: Parquet, CSV, PACE .pt, BAM JSON, SAGE folder, LeRobot dataset, MCAP or ROS
    2 bag."""
    robot: str = ""
    """Shipped design, YAML, MJCF or URDF; compares names and ranges of joints."""
    map: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """Column of a CSV file and the signal that it holds, THEIRS=OURS, such as q1=position/knee."""
    out: Path | None = None
    """Folder to write check.json and the logs as Parquet to."""

    def run(self) -> None:
        """Check the logs and print what they can show.

        Raises:
            SystemExit: with code 2, if a log cannot be used.
        """
        from hyperleg_design.gap.checks.checking import check_sources
        from hyperleg_design.report.gap.checks import checks_text

        checks = check_sources(self.logs, robot=self.robot, mapping=self.map, out=self.out)
        self.tell([check.mapping() for check in checks], checks_text(checks))
        if not all(check.usable for check in checks):
            raise SystemExit(2)


@dataclass(frozen=True, kw_only=True)
class Effects(Printing):
    """List the catalogue of effects: places where each can occur, parameters, usual magnitudes and
    their sources.
    """

    def run(self) -> None:
        """Print the catalogue of effects."""
        from hyperleg_design.gap.playback.show import effects_table
        from hyperleg_design.report.gap.show import effects_text

        catalogue = effects_table()
        self.tell(catalogue, effects_text(catalogue))


@dataclass(frozen=True, kw_only=True)
class Show(Printing):
    """Show one effect alone: the residual that it leaves on a standard motion, and how a closed
    loop moves with and without it.
    """

    effect: Annotated[str, tyro.conf.Positional]
    """Identifier of the effect; `hyperleg gap effects` lists them."""
    robot: str = ""
    """Design, MJCF or URDF to show it on; by default what suits the effect: one joint on a servo,
    or the biped."""
    location: str = ""
    """Joint, motor or link at which it occurs; the first possible place by default."""
    set: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """Value of a parameter of the effect, PARAMETER=VALUE; a usual magnitude by default."""
    out: Path = Path("results/gap_show")
    """Folder to write the figure to."""

    def run(self) -> None:
        """Draw the effect and print its summary."""
        from hyperleg_design.gap.playback.show import show
        from hyperleg_design.report.gap.show import show_figure, show_summary, show_text

        shown = show(
            self.effect, self.robot or None, location=self.location or None, settings=self.set
        )
        path = show_figure(shown, self.out / f"{self.effect}.png")
        summary = {**show_summary(shown), "figure": str(path)}
        self.tell(summary, show_text(summary))


@dataclass(frozen=True, kw_only=True)
class Apply(Printing):
    """Write the causes of a diagnosis as an overlay that simulator, training and evaluation accept;
    say what it changes.
    """

    diagnosis: Annotated[Path, tyro.conf.Positional]
    """`diagnosis.json` or its folder, or an overlay that was written before."""
    out: Path = Path("overlay.yaml")
    """File to write; with `--logs` or `--policy`, the results go to a JSON file of the same
    name."""
    robot: str = ""
    """Design, MJCF or URDF on which to check the places; unchecked by default."""
    logs: tuple[str, ...] = ()
    """Logs to replay without and with the effect: held-out ones, if possible."""
    policy: str = ""
    """ONNX file, or name of a shipped training, to evaluate without and with the effect."""
    protocol: str = ""
    """walk, t_test, or a YAML file; what suits the policy's task by default."""

    def run(self) -> None:
        """Write the overlay, or replay logs and a walk with it."""
        from hyperleg_design.gap.playback import added
        from hyperleg_design.gap.playback.overlay import (
            overlay_of_diagnosis,
            read_overlay,
            write_overlay,
        )
        from hyperleg_design.report.gap.text import changed_text, replayed_text
        from hyperleg_design.writing import write_json

        ready = self.diagnosis.suffix in (".yaml", ".yml")
        overlay = (
            read_overlay(self.diagnosis)
            if ready
            else overlay_of_diagnosis(self.diagnosis, self.robot)
        )
        logs, walk = [], []
        if self.robot:
            from hyperleg_design.gap.signals.loading import load_subject

            overlay.alterations(load_subject(self.robot))
        if self.logs:
            from hyperleg_design.gap.checks.intake import take_in

            logs = added.replayed(take_in(self.robot, self.logs, ()).tests, overlay)
        if self.policy:
            walk = added.walked(self.policy, overlay, self.protocol or None)
        path = write_overlay(self.out, overlay)
        changes = added.mapping(logs, walk)
        if logs or walk:
            write_json(path.with_suffix(".json"), changes)
        if self.json:
            emit({"file": str(path), **overlay.mapping(), **changes})
            return
        effects = ", ".join(f"{effect} at {location}" for effect, location in overlay.change)
        print(f"{effects} -> {path}")
        for text in (replayed_text(logs), changed_text(walk)):
            if text:
                print(text)


@dataclass(frozen=True, kw_only=True)
class Measure(Printing):
    """Measure the gap between logs and model by signal, joint, motor and regime, against the
    repeatability of the reference logs.
    """

    robot: str = ""
    """Shipped design, YAML, MJCF or URDF; by default what the logs name."""
    logs: tuple[str, ...]
    """Logs to be measured, files or folders of any format that `hyperleg gap check` reads."""
    reference: tuple[str, ...] = ()
    """Logs of the healthy robot."""
    out: Path | None = None
    """Folder to write gap.json to."""

    def run(self) -> None:
        """Measure the gap and print it."""
        from hyperleg_design.gap.checks.intake import take_in
        from hyperleg_design.gap.playback.measure import measure
        from hyperleg_design.report.gap.text import gap_text
        from hyperleg_design.writing import output_folder, write_json

        session = take_in(self.robot, self.logs, self.reference)
        gap = measure(session.tests, session.references)
        if self.out is not None:
            with output_folder(self.out) as folder:
                write_json(folder / "gap.json", gap.mapping())
        self.tell(gap.mapping(), gap_text(gap))


@dataclass(frozen=True, kw_only=True)
class Diagnose(Printing):
    """Say where hardware and simulation differ, which effect is the cause, and how far the gap
    shrinks once it is added.
    """

    robot: str = ""
    """Shipped design, YAML, MJCF or URDF; by default what the logs name."""
    logs: tuple[str, ...]
    """Logs to be diagnosed, files or folders of any format that `hyperleg gap check` reads."""
    reference: tuple[str, ...] = ()
    """Logs of the healthy robot; they tell how well the model fits when nothing is wrong."""
    reference_robot: str = ""
    """Design, YAML, MJCF or URDF of the robot in the reference logs, if it was built differently
    then; the same as now by default."""
    out: Path
    """Folder to write diagnosis.json, index.html and its figures to."""
    seed: Annotated[int, AtLeast(0)] = 0
    """Seed of all random numbers."""
    threads: Annotated[int, AtLeast(1)] = 2
    """Number of threads; the answer does not depend on it."""

    def run(self) -> None:
        """Diagnose the logs, write the page, and print the answer."""
        from hyperleg_design.report.gap.report import diagnose_to_folder
        from hyperleg_design.report.gap.text import diagnosis_text

        show = None if self.json else print
        diagnosis, page = diagnose_to_folder(
            self.robot,
            self.logs,
            self.reference,
            self.out,
            reference_robot=self.reference_robot,
            seed=self.seed,
            threads=self.threads,
            show=show,
        )
        self.tell(diagnosis, f"{diagnosis_text(diagnosis)}\nopen {page}")


@dataclass(frozen=True, kw_only=True)
class Excite(Printing):
    """Design the experiments for a rig: targets inside all limits, and which effects each can tell
    apart.
    """

    robot: Annotated[str, tyro.conf.arg(aliases=("--design",))]
    """Shipped design, YAML, MJCF or URDF."""
    base: Literal["fixed"] = "fixed"
    """How the robot is held; the rig holds the base fixed."""
    set: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """Parameter of a design to change, PATH=VALUE; may be repeated."""
    joints: tuple[str, ...] = ()
    """Joints that move; others are held still. All by default."""
    rate: Annotated[float, AtLeast(0, exclusive=True)] = 200.0
    """Sampling rate of the targets [Hz]."""
    without_torque: bool = False
    """Say that the rig measures neither torque nor current."""
    format: Literal["csv", "parquet", "both"] = "csv"
    """Format of the files with the targets."""
    seed: Annotated[int, AtLeast(0)] = 0
    """Seed of the phases of the multi-sine motions."""
    out: Path
    """Folder to write targets, plan.json and figures to."""

    def run(self) -> None:
        """Design the motions and write them."""
        from hyperleg_design.report.gap.report import excite_to_folder

        text = excite_to_folder(
            self.robot,
            self.out,
            base=self.base,
            rate=self.rate,
            torque=not self.without_torque,
            kinds=self.format,
            seed=self.seed,
            overrides=self.set,
            joints=self.joints,
            progress=not self.json,
        )
        self.tell(json_module.loads((self.out / "plan.json").read_text()), text)


@dataclass(frozen=True, kw_only=True)
class Blind(Printing):
    """Make a trial with sealed truth in a process of its own, and diagnose its cases; the same
    command continues a trial that was stopped.
    """

    cases: Annotated[int, AtLeast(1)] = 240
    """Number of cases."""
    seed: Annotated[int, AtLeast(0)]
    """Seed of the trial; never tune a diagnosis on a trial that is to be scored."""
    plants: tuple[str, ...] = ("rig", "other", "walking")
    """Simulated plants that make the logs."""
    workers: Annotated[int, AtLeast(1)] = 2
    """Number of processes that run side by side."""
    only_make: bool = False
    """Only make the cases; do not diagnose them yet."""
    out: Path
    """Folder of the trial."""

    def run(self) -> None:
        """Make the blind cases and diagnose them."""
        from hyperleg_design.validation.blind.trial import diagnose_trial, make_trial

        seal = make_trial(
            self.cases,
            self.seed,
            self.out,
            plants=self.plants,
            workers=self.workers,
            progress=not self.json,
        )
        if not self.json:
            print(f"{seal.cases} cases, key sealed: sha256 {seal.sha256}", flush=True)
        if not self.only_make:
            diagnose_trial(self.out, workers=self.workers, progress=not self.json)
        if self.json:
            emit({"folder": self.out, "seal": seal, "diagnosed": not self.only_make})
        elif not self.only_make:
            print(f"now, once: hyperleg gap score {self.out}")


@dataclass(frozen=True, kw_only=True)
class Score(Printing):
    """Open a trial's key, once, and compare its diagnoses with the truth."""

    folder: Annotated[str, tyro.conf.Positional]
    """Folder of the trial."""
    reread: bool = False
    """Read the table of a trial that was scored before."""

    def run(self) -> None:
        """Score the diagnoses of a blind trial."""
        from hyperleg_design.validation.blind.score import score

        scores = score(self.folder, reread=self.reread)
        self.tell(scores, scores.markdown())


@dataclass(frozen=True, kw_only=True)
class Baselines(Printing):
    """Fit PACE's parameter set (CMA-ES), mujoco.sysid and ours to a trial's cases: gap closed,
    cause named, time, in one table.
    """

    folder: Annotated[str, tyro.conf.Positional]
    """Folder of the trial; its key stays sealed until the trial is scored."""
    methods: tuple[str, ...] = ("diagnosis", "own", "sysid", "pace")
    """Methods to compare; `diagnosis` is what the trial's folder holds."""
    cases: tuple[str, ...] = ()
    """Numbers of the cases, such as 003 017; all by default."""
    budget: Annotated[float, AtLeast(0, exclusive=True)] = 300.0
    """Time limit of one fit [s]."""
    seed: Annotated[int, AtLeast(0)] = 0
    """Seed of CMA-ES."""

    def run(self) -> None:
        """Run the other tools on the cases of a blind trial."""
        from hyperleg_design.validation.baselines.table import baselines_table

        table = baselines_table(
            self.folder,
            methods=self.methods,
            cases=self.cases,
            budget=self.budget,
            seed=self.seed,
            progress=not self.json,
        )
        self.tell(table, table.markdown())


VERBS: dict[str, Any] = {
    "check": Check,
    "effects": Effects,
    "show": Show,
    "apply": Apply,
    "measure": Measure,
    "diagnose": Diagnose,
    "excite": Excite,
    "blind": Blind,
    "score": Score,
    "baselines": Baselines,
}
"""Verbs of `hyperleg gap` by name."""
