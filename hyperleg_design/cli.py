"""The command line: one verb a job, no logic of its own."""

from __future__ import annotations

import contextlib
import io
import json as json_module
import re
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from hyperleg_design import __version__, cli_gap, resources
from hyperleg_design.errors import HyperlegError, InputError
from hyperleg_design.robot.design import Design, load_design


def _emit(content: object) -> None:
    print(json_module.dumps(content, indent=2, allow_nan=False))


@dataclass(frozen=True, kw_only=True)
class Chosen:
    """A design, and what to change of it."""

    design: str = "hyperleg"
    """Shipped name or YAML file; `hyperleg list` shows what is shipped."""
    variant: str = ""
    """Ablation to make of it: toe, toe_locked, toe_removed_matched or toe_removed."""
    set: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """PATH=VALUE, such as toe.mass=0.3."""
    overlay: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """YAML file with leaves that differ, applied before --set."""

    def load(self) -> Design:
        """The design asked for."""
        return load_design(self.design, overrides=self.set, overlays=self.overlay, variant=self.variant or None)


@dataclass(frozen=True, kw_only=True)
class List:
    """What is shipped: designs, motors, sweeps."""

    kind: Annotated[str, tyro.conf.Positional] = "all"
    """designs, variants, motors, sweeps, parameters, or all."""
    json: bool = False
    """Print JSON."""

    def run(self) -> None:
        """Print it."""
        from hyperleg_design.report import listing

        found = listing.listing(self.kind)
        if self.json:
            _emit(found)
        else:
            print(listing.listing_text(found))


@dataclass(frozen=True, kw_only=True)
class Build(Chosen):
    """Write URDF, MJCF, the resolved design and the mass table."""

    out: Path
    """Folder to write; replaced if hyperleg made it."""
    json: bool = False
    """Print JSON."""

    def run(self) -> None:
        """Build it."""
        from hyperleg_design.robot.build import build

        design = self.load()
        folder = build(design, self.out)
        files = sorted(str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file() and not p.name.startswith("."))
        if self.json:
            _emit({"design": design.name, "folder": str(folder), "files": files})
        else:
            print(f"{design.name} -> {folder}: {', '.join(files)}")


@dataclass(frozen=True, kw_only=True)
class Check:
    """Check files: designs, motors, sweeps, URDF, MJCF. Exit code 2 if any is wrong."""

    paths: Annotated[tuple[str, ...], tyro.conf.Positional]
    """Files, or names of shipped designs."""
    json: bool = False
    """Print JSON."""

    def run(self) -> None:
        """Check them."""
        from hyperleg_design.report import checking

        findings = checking.check_paths(self.paths)
        if self.json:
            _emit(findings)
        else:
            print(checking.checks_text(findings))
        if any(f["errors"] for f in findings):
            raise SystemExit(2)


@dataclass(frozen=True, kw_only=True)
class Analyze(Chosen):
    """Masses, reductions, torques, speeds, reflected inertia, envelope and confound of one design."""

    json: bool = False
    """Print JSON."""

    def run(self) -> None:
        """Analyse it."""
        from hyperleg_design.report.text import analysis_text
        from hyperleg_design.sizing.analysis import analyze

        found = analyze(self.load())
        if self.json:
            _emit(found)
        else:
            print(analysis_text(found))


@dataclass(frozen=True, kw_only=True)
class Compare:
    """Several designs beside each other."""

    designs: Annotated[tuple[str, ...], tyro.conf.Positional] = ("toe", "toe_locked", "toe_removed_matched", "toe_removed")
    """Shipped names or YAML files."""
    set: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """PATH=VALUE, applied to all."""
    demand: bool = False
    """Add what a planned walk at 1.33 m/s asks of each (seconds a design)."""
    json: bool = False
    """Print JSON."""

    def run(self) -> None:
        """Compare them."""
        from hyperleg_design.report import comparison

        found = comparison.compare([load_design(name, overrides=self.set) for name in self.designs], demand=self.demand)
        if self.json:
            _emit(found)
        else:
            print(comparison.compare_text(found))


@dataclass(frozen=True, kw_only=True)
class Sweep:
    """Evaluate a sweep of designs; killed, it goes on where it stopped."""

    action: Annotated[str, tyro.conf.Positional]
    """run"""
    file: Annotated[str, tyro.conf.Positional]
    """Shipped name or YAML file."""
    out: Path
    """Folder to write."""
    restart: bool = False
    """Throw away what an earlier run left there."""
    json: bool = False
    """Print JSON."""

    def run(self) -> None:
        """Run it."""
        from hyperleg_design.report.sweep_page import sweep_report
        from hyperleg_design.sweep.run import run_sweep

        if self.action != "run":
            raise InputError("sweep", "", self.action, "expects: hyperleg sweep run FILE --out DIR")
        result = run_sweep(self.file, self.out, resume=not self.restart, progress=not self.json)
        summary = sweep_report(result)
        if self.json:
            _emit(summary)
        else:
            print(f"{summary['designs']} designs ({summary['rejected']} rejected) -> {', '.join(summary['files'])}")


@dataclass(frozen=True, kw_only=True)
class Study:
    """The whole study: analyse the paper's biped and its ablations, sweep, and write a page."""

    out: Path = Path("results/study")
    """Folder to write; its index.html is the page."""
    policies: Path | None = None
    """Folder of trainings to evaluate, such as results/campaign; the shipped policies by default."""
    json: bool = False
    """Print JSON."""

    def run(self) -> None:
        """Run it."""
        from hyperleg_design.report.study import run_study

        page = run_study(self.out, policies=self.policies, progress=not self.json)
        if self.json:
            _emit({"page": str(page)})
        else:
            print(f"open {page}")


@dataclass(frozen=True, kw_only=True)
class Train:
    """Train a policy, or go on with a training that was stopped; needs the learning extra."""

    task: str = "walk"
    """walk, walk_paper, goal, goal_paper, or a YAML file."""
    design: str = "toe"
    """Shipped name or YAML file."""
    seed: int = 0
    """Of everything random."""
    preset: str = "laptop"
    """laptop, paper, or a YAML file."""
    start: str = ""
    """ONNX policy of another task to start from; from scratch by default."""
    out: Path
    """Folder of the training."""
    threads: int = 1
    """Of this process; two trainings of one thread each are the best use of two cores."""
    overlay: str = ""
    """Overlay (`hyperleg gap apply`) whose effects the simulation gets; none by default."""

    def run(self) -> None:
        """Become the training's process."""
        from hyperleg_design.learning import launch

        _require("torch", "rsl_rl")
        given = {"task": self.task, "design": self.design, "seed": self.seed, "preset": self.preset, "out": self.out, "threads": self.threads}
        given |= {"start": self.start} if self.start else {}
        arguments = [f"--{key}={value}" for key, value in given.items()]
        if not self.overlay:
            launch.run_here(arguments, self.threads)
        from hyperleg_design.gap.overlay import read_overlay

        overlay = read_overlay(self.overlay)
        overlay.alterations(load_design(self.design))  # a wrong place is told before the process is replaced
        if not launch.surrounded():
            launch.run_here(["train", *arguments, f"--overlay={self.overlay}"], self.threads, "hyperleg_design.cli")
        from hyperleg_design.learning.__main__ import main as train_here

        raise SystemExit(train_here(arguments, overlay.alterations, overlay.mapping()))


@dataclass(frozen=True, kw_only=True)
class Campaign:
    """Train whatever a campaign still lacks, side by side, show where it stands, or pack its policies for shipping."""

    action: Annotated[str, tyro.conf.Positional]
    """run, status or pack"""
    file: Annotated[str, tyro.conf.Positional] = "campaign"
    """Shipped name or YAML file."""
    out: Path = Path("results/campaign")
    """Folder of the trainings."""
    source: Annotated[Path, tyro.conf.arg(name="from")] = Path("results/campaign")
    """Folder of the trainings to pack."""
    target: Annotated[Path, tyro.conf.arg(name="to")] = Path("sim/policies")
    """Folder to pack into: policies, learning curves and what was trained."""

    def run(self) -> None:
        """Run it, print its state, or pack it."""
        from hyperleg_design.evaluation.shipped import pack, pack_text
        from hyperleg_design.learning.campaign import campaign_status, load_campaign, run_campaign, status_table

        if self.action not in ("run", "status", "pack"):
            raise InputError("campaign", "", self.action, "expects run, status or pack")
        if self.action == "pack":
            print(pack_text(pack(self.source, self.target)))
            return
        campaign = load_campaign(self.file)
        if self.action == "status":
            print(status_table(campaign_status(campaign, self.out)))
            return
        _require("torch", "rsl_rl")
        if not run_campaign(campaign, self.out, show=print):
            raise SystemExit(3)


@dataclass(frozen=True, kw_only=True)
class Evaluate:
    """Evaluate policies (ONNX): 20 m walks or Robot T-tests, falls counted, numbers with intervals."""

    policies: Annotated[tuple[str, ...], tyro.conf.Positional]
    """ONNX files."""
    protocol: str = ""
    """walk, t_test, or a YAML file; what suits the policy's task by default."""
    out: Path
    """Folder to write tables to."""
    workers: int = 2
    """Processes side by side."""
    overlay: str = ""
    """Overlay (`hyperleg gap apply`) whose effects the simulation gets; none by default."""
    logs: Path | None = None
    """Folder to write a log of every trial to, as `hyperleg gap` reads them; none by default."""
    json: bool = False
    """Print JSON."""

    def run(self) -> None:
        """Evaluate them."""
        from hyperleg_design.evaluation.evaluate import evaluate_many
        from hyperleg_design.evaluation.result import write_results
        from hyperleg_design.report.evaluation_text import evaluation_rows, evaluation_text
        from hyperleg_design.writing import check_output_folder

        if not self.policies:
            raise InputError("evaluate", "", None, "expects ONNX files")
        for folder in (self.out, self.logs):
            if folder is not None:
                check_output_folder(folder)
        overlay = None
        if self.overlay:
            from hyperleg_design.gap.overlay import read_overlay, write_overlay

            overlay = read_overlay(self.overlay)
        alterations = overlay.alterations if overlay else None
        found = evaluate_many(
            self.policies, self.protocol or None, workers=self.workers, kept=1 if self.logs is None else sys.maxsize, alterations=alterations
        )
        folder = write_results(self.out, found)
        written = []
        if self.logs is not None:
            from hyperleg_design.gap.recording import write_logs

            written = write_logs(self.logs, found)
        if overlay:
            write_overlay(folder / "overlay.yaml", overlay)
        rows = evaluation_rows(found)
        if self.json:
            _emit({"folder": str(folder), "results": rows, "logs": [str(path) for path in written]})
        else:
            print(evaluation_text(rows))
            print(f"tables in {folder}" + (f"; {len(written)} logs in {self.logs}" if written else ""))


@dataclass(frozen=True, kw_only=True)
class Paper:
    """Evaluate the shipped policies, and put Tables III and IV and Figs. 4 to 7 beside the paper's on a page."""

    policies: Path | None = None
    """Folder of trainings, such as results/campaign; the shipped policies by default."""
    out: Path = Path("results/paper")
    """Folder to write; its index.html is the page."""
    workers: int = 0
    """Processes side by side; 0 for as many as the machine has processors."""
    json: bool = False
    """Print JSON."""

    def run(self) -> None:
        """Evaluate and write."""
        from hyperleg_design.report.paper_page import read_tables, run_paper, tables_text

        page = run_paper(self.policies, self.out, workers=self.workers or None, progress=not self.json)
        tables = read_tables(self.out)
        if self.json:
            _emit({"page": str(page), "tables": tables})
        else:
            print(tables_text(tables))
            print(f"open {page}")


@dataclass(frozen=True, kw_only=True)
class Replay:
    """Show one trial of a policy: as a GIF file, or in the browser."""

    policy: Annotated[str, tyro.conf.Positional]
    """ONNX file, or name of a shipped training such as walk-toe-0."""
    protocol: str = ""
    """walk, t_test, or a YAML file; what suits the policy's task by default."""
    seed: int | None = None
    """Of the starting state; the protocol's by default."""
    gif: Path | None = None
    """File to write."""
    viser: bool = False
    """Show it in the browser; needs viser."""

    def run(self) -> None:
        """Replay it."""
        from hyperleg_design.report import replay

        if (self.gif is None) == (not self.viser):
            raise InputError("replay", "", None, "expects --gif FILE or --viser")
        if self.viser:
            replay.check_browser()
        found = replay.replay(self.policy, self.protocol or None, seed=self.seed)
        print(f"{found.policy}: {found.outcomes[0].replace('_', ' ')} after {found.end_times[0]:.2f} s")
        if self.gif is not None:
            print(f"written to {replay.replay_gif(found, self.gif)}")
        else:
            print("open http://localhost:8080; Ctrl-C to stop", flush=True)
            replay.replay_in_browser(found)


def _require(*modules: str) -> None:
    """Raise one clear error where the learning extra is not installed."""
    import importlib.util

    missing = [m for m in modules if importlib.util.find_spec(m) is None]
    if missing:
        raise InputError("train", "", None, f"needs {', '.join(missing)}: make .venv/.learning, or install hyperleg-design[learning]")


@dataclass(frozen=True, kw_only=True)
class Version:
    """Versions of this package and of what it builds on."""

    json: bool = False
    """Print JSON."""

    def run(self) -> None:
        """Print them."""
        from importlib.metadata import version

        found = {"hyperleg-design": __version__, "content": str(resources.home())}
        found |= {name: version(name) for name in ("mujoco", "pin", "cvxpy", "numpy", "pyvista")}
        if self.json:
            _emit(found)
        else:
            print("\n".join(f"{k} {v}" for k, v in found.items()))


@dataclass(frozen=True, kw_only=True)
class GapCheck:
    """Say what logs can and cannot show: rates, jitter, dropouts, units, excitation of each effect. Exit code 2 on errors."""

    logs: Annotated[tuple[str, ...], tyro.conf.Positional]
    """Files or folders: Parquet, CSV, PACE .pt, BAM JSON, SAGE folder, LeRobot dataset, MCAP or ROS 2 bag."""
    robot: str = ""
    """Shipped design, YAML, MJCF or URDF; compares names and ranges of joints."""
    map: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """THEIRS=OURS, a CSV file's column and ours, such as q1=position/knee."""
    out: Path | None = None
    """Folder to write check.json and the logs as Parquet to."""
    json: bool = False
    """Print JSON."""

    def run(self) -> None:
        """Check them."""
        from hyperleg_design.gap.checking import check_sources
        from hyperleg_design.report.gap_text import checks_text

        checks = check_sources(self.logs, robot=self.robot, mapping=self.map, out=self.out)
        if self.json:
            _emit([check.mapping() for check in checks])
        else:
            print(checks_text(checks))
        if not all(check.usable for check in checks):
            raise SystemExit(2)


@dataclass(frozen=True, kw_only=True)
class GapEffects:
    """The catalogue of effects: where each can sit, its parameters, usual magnitudes and their source."""

    json: bool = False
    """Print JSON."""

    def run(self) -> None:
        """Print it."""
        from hyperleg_design.gap.show import effects_table
        from hyperleg_design.report.gap_show import effects_text

        found = effects_table()
        if self.json:
            _emit(found)
        else:
            print(effects_text(found))


@dataclass(frozen=True, kw_only=True)
class GapShow:
    """One effect alone: the trace it leaves on a standard motion, and how a closed loop moves with and without it."""

    effect: Annotated[str, tyro.conf.Positional]
    """Identifier; `hyperleg gap effects` lists them."""
    robot: str = ""
    """Design, MJCF or URDF to show it on; by default what suits the effect: one joint on a servo, or the biped."""
    location: str = ""
    """Where it sits; the first place that it can by default."""
    set: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """PARAMETER=VALUE; a usual magnitude by default."""
    out: Path = Path("results/gap_show")
    """Folder of the figure."""
    json: bool = False
    """Print JSON."""

    def run(self) -> None:
        """Draw it."""
        from hyperleg_design.gap.show import show
        from hyperleg_design.report.gap_show import show_figure, show_summary, show_text

        shown = show(self.effect, self.robot or None, location=self.location or None, settings=self.set)
        path = show_figure(shown, self.out / f"{self.effect}.png")
        summary = {**show_summary(shown), "figure": str(path)}
        if self.json:
            _emit(summary)
        else:
            print(show_text(summary))


@dataclass(frozen=True, kw_only=True)
class GapApply:
    """Write the causes of a diagnosis as an overlay that simulator, training and evaluation accept."""

    diagnosis: Annotated[Path, tyro.conf.Positional]
    """`diagnosis.json`."""
    out: Path = Path("overlay.yaml")
    """File to write."""
    robot: str = ""
    """Design, MJCF or URDF on which to check the places; unchecked by default."""
    json: bool = False
    """Print JSON."""

    def run(self) -> None:
        """Write it."""
        from hyperleg_design.gap.overlay import overlay_of_diagnosis, write_overlay

        overlay = overlay_of_diagnosis(self.diagnosis, self.robot)
        if self.robot:
            from hyperleg_design.gap.subject import load_subject

            overlay.alterations(load_subject(self.robot))
        path = write_overlay(self.out, overlay)
        if self.json:
            _emit({"file": str(path), **overlay.mapping()})
        else:
            effects = ", ".join(f"{effect} at {location}" for effect, location in overlay.change)
            print(f"{effects} -> {path}")


GAP_VERBS: dict[str, Any] = {
    "check": GapCheck,
    "effects": GapEffects,
    "show": GapShow,
    "apply": GapApply,
    **cli_gap.VERBS,
}


@dataclass(frozen=True, kw_only=True)
class Gap:
    """Diagnose the gap between simulation and robot; `hyperleg gap --help` lists its verbs."""

    def run(self) -> None:
        """Show its verbs."""
        _parse(["gap", "--help"])


VERBS: dict[str, Any] = {
    "list": List,
    "build": Build,
    "check": Check,
    "analyze": Analyze,
    "sweep": Sweep,
    "compare": Compare,
    "study": Study,
    "train": Train,
    "campaign": Campaign,
    "evaluate": Evaluate,
    "replay": Replay,
    "paper": Paper,
    "gap": Gap,
    "version": Version,
}


def _parse(arguments: list[str]) -> Any:
    """The command asked for; what is wrong with the arguments goes into one line."""
    errors = io.StringIO()
    verbs, prog, about = VERBS, "hyperleg", "Design, size and compare legged robots with cooperative actuation."
    if arguments[:1] == ["gap"]:
        verbs, prog, about = GAP_VERBS, "hyperleg gap", "Diagnose the gap between simulation and robot: where they differ, and why."
        arguments = arguments[1:] or ["--help"]
    try:
        with contextlib.redirect_stderr(errors):
            return tyro.extras.subcommand_cli_from_dict(verbs, prog=prog, description=about, args=arguments, config=(tyro.conf.FlagCreatePairsOff,))
    except SystemExit as stop:
        if not stop.code:
            raise
        text = re.sub(r"[╭╮╰╯│─]+", " ", errors.getvalue())
        text = re.sub(r"\s+", " ", text).strip()
        raise InputError("arguments", "", None, text or "see hyperleg --help") from None


def main(arguments: list[str] | None = None) -> int:
    """Entry point; returns the exit code: 0, or 2 on bad input."""
    try:
        _parse(list(sys.argv[1:] if arguments is None else arguments) or ["--help"]).run()
    except HyperlegError as error:
        print(f"hyperleg: {error}", file=sys.stderr)
        return 2
    except BrokenPipeError:
        sys.stderr.close()
        return 0
    except KeyboardInterrupt:
        print("hyperleg: stopped", file=sys.stderr)
        return 130
    except SystemExit as stop:
        return int(stop.code or 0)
    return 0


if __name__ == "__main__":
    sys.exit(main())
