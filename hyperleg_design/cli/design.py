"""Verbs on designs: list, build, check, import, analyze, compare, sweep, study, version; no logic
of their own.
"""

from __future__ import annotations

import shutil
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from hyperleg_design import __version__, resources
from hyperleg_design.cli.arguments import AtLeast
from hyperleg_design.cli.output import Printing, emit
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.parameters.described import RobotDesign


@dataclass(frozen=True, kw_only=True)
class Chosen(Printing):
    """A design, and what to change of it."""

    design: str = "hyperleg"
    """Shipped name or YAML file; `hyperleg list` shows what is shipped."""
    variant: str = ""
    """Ablation to make of it: toe, toe_locked, toe_removed_matched, toe_removed or toe_passive."""
    set: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """Parameter to change, PATH=VALUE, such as toe.mass=0.3; may be repeated."""
    set_file: Annotated[
        tyro.conf.UseAppendAction[tuple[str, ...]], tyro.conf.arg(aliases=("--overlay",))
    ] = ()
    """YAML file of parameters that differ, applied before --set."""

    def load(self) -> RobotDesign:
        """Load the design that the options describe.

        Returns:
            The design.
        """
        return load_robot(
            self.design, overrides=self.set, overlays=self.set_file, variant=self.variant or None
        )


@dataclass(frozen=True, kw_only=True)
class List(Printing):
    """List what is shipped: designs, motors, sweeps, tasks, protocols, presets and policies."""

    kind: Annotated[str, tyro.conf.Positional] = "all"
    """designs, variants, motors, sweeps, tasks, protocols, presets, policies, measures,
    parameters, or all (without measures and parameters)."""
    design: str = "hyperleg"
    """Design whose parameters are listed: shipped name or YAML file."""

    def run(self) -> None:
        """Print what is shipped, as a list or as JSON."""
        from hyperleg_design.report import listing

        entries = listing.listing(self.kind, self.design)
        if self.json:
            emit(entries)
        else:
            width = shutil.get_terminal_size().columns if sys.stdout.isatty() else None
            print(listing.listing_text(entries, width))


@dataclass(frozen=True, kw_only=True)
class Build(Chosen):
    """Write URDF, MJCF, the resolved design and the mass table."""

    out: Path
    """Folder to write; replaced if hyperleg made it."""
    target: Annotated[Literal["", "isaac"], tyro.conf.arg(name="for")] = ""
    """Program that needs a further file: isaac, for actuator values in Isaac Lab's terms."""

    def run(self) -> None:
        """Write the files and print their names."""
        from hyperleg_design.robot.build import build

        design = self.load()
        folder = build(design, self.out)
        if self.target == "isaac":
            from hyperleg_design.simulation.isaac import FILE, isaac_actuators
            from hyperleg_design.writing import write_json

            write_json(folder / FILE, isaac_actuators(design))
        files = sorted(
            str(p.relative_to(folder))
            for p in folder.rglob("*")
            if p.is_file() and not p.name.startswith(".")
        )
        self.tell(
            {"design": design.name, "folder": str(folder), "files": files},
            f"{design.name} -> {folder}: {', '.join(files)}",
        )


@dataclass(frozen=True, kw_only=True)
class Check(Printing):
    """Check files: designs, motors, sweeps, URDF, MJCF. Exit code 2 if any is wrong."""

    paths: Annotated[tuple[str, ...], tyro.conf.Positional]
    """Files, or names of shipped designs."""

    def run(self) -> None:
        """Check the files, print what is wrong, and exit with 2 where there is an error.

        Raises:
            SystemExit: with code 2, if a file has an error.
        """
        from hyperleg_design.report import checking

        findings = checking.check_paths(self.paths)
        self.tell(findings, checking.checks_text(findings))
        if any(f["errors"] for f in findings):
            raise SystemExit(2)


@dataclass(frozen=True, kw_only=True)
class Import(Printing):
    """Make a design from a URDF or MJCF and the motors behind its joints, and say where the file's
    limits contradict them.
    """

    file: Annotated[str, tyro.conf.Positional]
    """URDF or MJCF."""
    actuation: Path
    """YAML file that names motors and reductions; docs/robots.md says how."""
    out: Path | None = None
    """Design file to write, new or of an earlier import; without it, limits are only checked."""
    no_meshes: bool = False
    """Import although meshes are missing that the file names."""

    def run(self) -> None:
        """Import the file, and print where its limits contradict the motors."""
        from hyperleg_design.robot.assumed_posture import assumed_posture, posture_line
        from hyperleg_design.robot.checks.finding import finding_lines
        from hyperleg_design.robot.importing import base_line, import_robot, write_imported

        design, findings = import_robot(self.file, self.actuation, meshes=not self.no_meshes)
        if self.out is not None:
            write_imported(design, self.out)
        if self.json:
            emit(
                {
                    "design": design.name,
                    "file": None if self.out is None else str(self.out),
                    "trunk": {"link": design.trunk.link, "motion": design.trunk.motion},
                    "joints": list(design.joint_sections),
                    "assumed_default_deg": assumed_posture(design),
                    "findings": [vars(finding) for finding in findings],
                }
            )
            return
        written = "" if self.out is None else f" -> {self.out}"
        print(f"{design.name}: {len(design.joint_sections)} joints{written}")
        print(base_line(design))
        if line := posture_line(design):
            print(line)
        for line in finding_lines(findings):
            print(line)
        if not findings:
            print("the file's limits agree with the motors")


@dataclass(frozen=True, kw_only=True)
class Analyze(Chosen):
    """Analyse one design: masses, reductions, torques, speeds, reflected inertia, envelope, and
    what each ablation changes.
    """

    out: Path | None = None
    """Folder to write a page of the robot to, with its analysis as JSON; none by default."""

    def run(self) -> None:
        """Analyse the design, print the result, and write its page."""
        from hyperleg_design.report.sizing.robot_page import write_robot_page
        from hyperleg_design.report.text import analysis_text
        from hyperleg_design.report.tree_text import tree_analysis_text
        from hyperleg_design.sizing.analysis import analyze

        design = self.load()
        analysis = analyze(design)
        page = None if self.out is None else write_robot_page(design, self.out, analysis)
        text = (tree_analysis_text if "family" in analysis else analysis_text)(analysis)
        self.tell(analysis, text if page is None else f"{text}\nopen {page}")


@dataclass(frozen=True, kw_only=True)
class Compare(Printing):
    """Compare several designs side by side."""

    designs: Annotated[tuple[str, ...], tyro.conf.Positional] = (
        "toe",
        "toe_locked",
        "toe_removed_matched",
        "toe_removed",
    )
    """Shipped names or YAML files."""
    set: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """Parameter to change in all designs, PATH=VALUE; may be repeated."""
    set_file: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """YAML file of parameters that differ, applied to all before --set."""
    demand: bool = False
    """Add what a planned walk at 1.33 m/s asks of each (seconds a design)."""
    evaluate: tyro.conf.UseAppendAction[tuple[Literal["walk", "t_test"], ...]] = ()
    """Add what trained policies do on each under this protocol (a minute a design)."""
    seeds: Annotated[int, AtLeast(1)] = 3
    """Trainings of each design that are evaluated, at most."""
    policies: tuple[Path, ...] = ()
    """Folders of trainings; the shipped policies by default."""
    swap: Literal["", "lock_toe", "toe_motor_alone", "toe_motor_to_ankle"] = ""
    """With --evaluate: change of the toe that the policies were not trained for."""

    def run(self) -> None:
        """Compute the measures of all designs and print them side by side."""
        from hyperleg_design.report.sizing import comparison

        designs = [
            load_robot(name, overrides=self.set, overlays=self.set_file) for name in self.designs
        ]
        measures = comparison.compare(designs, demand=self.demand)
        walks = comparison.compare_walks(
            designs, self.evaluate, seeds=self.seeds, policies=self.policies, swap=self.swap
        )
        for protocol, entries in walks.items():
            for entry, walked in zip(measures.values(), entries, strict=True):
                entry[f"evaluated {protocol}"] = walked
        self.tell(measures, comparison.compare_text(measures))


@dataclass(frozen=True, kw_only=True)
class Sweep(Printing):
    """Evaluate a sweep of designs; the same command continues a run that was killed."""

    action: Annotated[Literal["run"], tyro.conf.Positional]
    """What to do with the sweep; there is only `run`."""
    file: Annotated[str, tyro.conf.Positional]
    """Shipped name or YAML file."""
    out: Path
    """Folder to write."""
    restart: bool = False
    """Throw away what an earlier run left there."""
    evaluate: tuple[str, ...] = ()
    """Protocols to run on every design: walk, t_test, or YAML files; those that the sweep names by
    default."""
    seeds: Annotated[int, AtLeast(1)] = 3
    """Trainings of the robot, or of each toe layout, whose policies are evaluated, at most; the
    best on each design is reported."""
    policies: tuple[Path, ...] = ()
    """Folders of trainings; the shipped policies by default."""
    batch: Annotated[int, AtLeast(1)] = 16
    """Designs evaluated side by side; a killed run loses at most those."""
    most_designs: Annotated[int, AtLeast(1)] = 1_000_000
    """Number of designs above which the sweep is refused, since its page takes about 2 GB of memory
    for a million."""
    scheduler: str = ""
    """Address of a Dask scheduler, such as tcp://host:8786; this process by default."""

    def run(self) -> None:
        """Run the sweep or what is left of it, write its page, and print a summary."""
        from hyperleg_design.report.sweep.page import sweep_report
        from hyperleg_design.report.sweep.trials import evaluated_report
        from hyperleg_design.sweep.effort import WORTH_SAYING, check_effort, effort_of
        from hyperleg_design.sweep.jobs import cluster
        from hyperleg_design.sweep.run import run_sweep
        from hyperleg_design.sweep.space import load_sweep
        from hyperleg_design.sweep.trial_runs import run_trials
        from hyperleg_design.sweep.trials.trial_plan import plan

        sweep, show = load_sweep(self.file), not self.json
        protocols = self.evaluate or sweep.evaluated
        wanted = plan(sweep, protocols, seeds=self.seeds, policies=self.policies)
        effort = effort_of(sweep, wanted)
        check_effort(effort, self.most_designs, sweep.source)
        if show and effort.seconds >= WORTH_SAYING:
            print(effort.text(), file=sys.stderr, flush=True)
        with cluster(self.scheduler) as executor:
            result = run_sweep(
                sweep, self.out, resume=not self.restart, progress=show, executor=executor
            )
            if protocols:
                run_trials(result, wanted, batch=self.batch, executor=executor, progress=show)
        summary = evaluated_report(result) if protocols else sweep_report(result)
        if self.json:
            emit(summary)
        else:
            print(
                f"{summary['designs']} designs ({summary['rejected']} rejected) -> "
                f"{', '.join(map(str, summary['files']))}"
            )
            for reason, count in summary["rejected_because"].items():
                print(f"  {count} rejected: {reason}")
            if protocols:
                print(summary["text"])


@dataclass(frozen=True, kw_only=True)
class Study(Printing):
    """The whole study: analyse the paper's biped and its ablations, sweep, and write a page."""

    out: Path = Path("results/study")
    """Folder to write; its index.html is the page."""
    policies: Path | None = None
    """Folder of trainings to evaluate, such as results/campaign; the shipped policies by
    default."""

    def run(self) -> None:
        """Run the study and write its page."""
        from hyperleg_design.report.study.study import run_study
        from hyperleg_design.report.walks.compared import coverage, coverage_text
        from hyperleg_design.writing import check_output_folder

        check_output_folder(self.out)
        trainings = coverage(self.policies)
        if not self.json and (text := coverage_text(trainings)):
            print(text, flush=True)
        page = run_study(self.out, policies=self.policies, progress=not self.json)
        self.tell({"page": str(page), "trainings": trainings}, f"open {page}")


@dataclass(frozen=True, kw_only=True)
class Version(Printing):
    """Versions of this package and of what it builds on."""

    def run(self) -> None:
        """Print the versions of this package and of the libraries that it builds on."""
        from importlib.metadata import version

        about = {"hyperleg-design": __version__, "content": str(resources.home())}
        about |= {name: version(name) for name in ("mujoco", "pin", "cvxpy", "numpy", "pyvista")}
        self.tell(about, "\n".join(f"{k} {v}" for k, v in about.items()))
