"""Verbs on policies: train, campaign, evaluate, robustness, paper; no logic of their own."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from hyperleg_design.cli.arguments import AtLeast
from hyperleg_design.cli.output import Printing, emit, require
from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.policy import load_policy
from hyperleg_design.evaluation.shipped import find_policy
from hyperleg_design.robot.load import changed_robot, load_robot
from hyperleg_design.robot.parameters.described import RobotDesign
from hyperleg_design.simulation.alteration import Alterations


@dataclass(frozen=True, kw_only=True)
class Train:
    """Train a policy, or go on with a training that was stopped; needs the learning extra."""

    task: str = "walk"
    """Task to train for: a shipped name (`hyperleg list tasks`), or a YAML file."""
    design: str = "toe"
    """Robot to train: a shipped name or a YAML file."""
    set: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """PATH=VALUE to change of the robot, such as toe.mass=0.5."""
    set_file: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """YAML file of the robot's parameters that differ, applied before --set."""
    seed: Annotated[int, AtLeast(0)] = 0
    """Seed of all random numbers."""
    preset: str = "laptop"
    """Training preset: a shipped name (`hyperleg list presets`), or a YAML file."""
    start: str = ""
    """Policy of another task or design to start from: an ONNX file, the folder of a training, or
    the name of a shipped one; from scratch by default."""
    designs: str = ""
    """Designs to draw from, so that one policy learns them all and observes which it has: toe, or
    a YAML file of ranges; the one design by default."""
    out: Path
    """Folder of the training."""
    iterations: Annotated[int | None, AtLeast(1)] = None
    """Iterations after which to stop with a checkpoint; by default the training runs to its end."""
    threads: Annotated[int, AtLeast(1)] = 1
    """Number of threads of this process; two trainings of one thread each make best use of two
    processor cores."""
    device: str = "cpu"
    """Where the networks learn, as torch names it: cuda for a GPU. Simulations stay on the
    processor."""
    overlay: str = ""
    """Overlay (`hyperleg gap apply`) whose effects the simulation gets; none by default."""
    motors: Path | None = None
    """Folder with motors of your own (NAME.yaml), beside the shipped ones."""

    def run(self) -> None:
        """Replace this process by the training.

        Raises:
            InputError: torch or rsl_rl is missing, or the training cannot begin.
            SystemExit: with the exit code of a training with an overlay, which runs in this
                process.
        """
        from hyperleg_design.learning import launch
        from hyperleg_design.learning.preset_file import load_preset
        from hyperleg_design.simulation.layout import layout_of
        from hyperleg_design.simulation.model import simulation_model
        from hyperleg_design.simulation.stepping.standing import check_standing
        from hyperleg_design.simulation.tasks import load_task

        given = {
            "task": self.task,
            "design": self.design,
            "seed": self.seed,
            "preset": self.preset,
            "out": self.out,
            "threads": self.threads,
            "device": self.device,
        }
        given |= {"start": find_policy(self.start, "--start")} if self.start else {}
        given |= {} if self.iterations is None else {"iterations": self.iterations}
        given |= {"designs": self.designs} if self.designs else {}
        arguments = [f"--{key}={value}" for key, value in given.items()]
        arguments += [f"--set={change}" for change in self.set]
        arguments += [f"--set-file={file}" for file in self.set_file]
        # What does not fit is an error here, before torch is loaded in a process of its own.
        robot = load_robot(self.design, overrides=self.set, overlays=self.set_file)
        task = load_task(self.task)
        posed = task.posed(robot)
        model, layout = simulation_model(posed, task.physics), layout_of(posed)
        task.check_robot(layout, robot.name)
        check_standing(model, layout, task.limits, robot.name)
        load_preset(self.preset).stages(task.name)
        require("torch", "rsl_rl")
        if not self.overlay:
            launch.run_here(arguments, self.threads)
        from hyperleg_design.gap.playback.overlay import read_overlay

        overlay = read_overlay(self.overlay)
        overlay.alterations(robot)
        if not launch.surrounded():
            launch.run_here(
                ["train", *arguments, f"--overlay={self.overlay}"],
                self.threads,
                "hyperleg_design.cli",
            )
        from hyperleg_design.learning.__main__ import main as train_here

        raise SystemExit(train_here(arguments, overlay.alterations, overlay.mapping()))


@dataclass(frozen=True, kw_only=True)
class Campaign(Printing):
    """Train whatever a campaign still lacks, side by side, show where it stands, or pack its
    policies for shipping.
    """

    action: Annotated[Literal["run", "status", "pack"], tyro.conf.Positional]
    """Train what is missing, print where every training stands, or pack finished policies."""
    file: Annotated[str, tyro.conf.Positional] = "campaign"
    """Shipped name or YAML file."""
    out: Path = Path("results/campaign")
    """Folder of the trainings."""
    source: Annotated[Path, tyro.conf.arg(name="from")] = Path("results/campaign")
    """Folder of the trainings to pack."""
    target: Annotated[Path, tyro.conf.arg(name="to")] = Path("sim/policies")
    """Folder to pack into: policies, learning curves and what was trained."""

    def run(self) -> None:
        """Run the campaign, print its state, or pack its policies.

        Raises:
            SystemExit: with code 3, if the campaign was stopped before it was done.
        """
        from hyperleg_design.evaluation.shipped import pack, pack_text
        from hyperleg_design.learning.campaigns.campaign import load_campaign
        from hyperleg_design.learning.campaigns.campaign_status import campaign_status, status_table
        from hyperleg_design.learning.campaigns.run_campaign import run_campaign

        if self.action == "pack":
            require("onnx")
            packed = pack(self.source, self.target, load_campaign(self.file).ship)
            self.tell(packed, pack_text(packed))
            return
        campaign = load_campaign(self.file)
        finished = True
        if self.action == "run":
            require("torch", "rsl_rl")
            finished = run_campaign(campaign, self.out, show=None if self.json else print)
        if self.json:
            emit(campaign_status(campaign, self.out))
        elif self.action == "status":
            print(status_table(campaign_status(campaign, self.out)))
        if not finished:
            raise SystemExit(3)


@dataclass(frozen=True, kw_only=True)
class Evaluate(Printing):
    """Evaluate policies (ONNX): 20 m walks or Robot T-tests, falls counted, numbers with
    intervals.
    """

    policies: Annotated[tuple[str, ...], tyro.conf.Positional]
    """ONNX files, or names of shipped trainings such as walk_upright-toe-1."""
    protocol: str = ""
    """walk, t_test, or a YAML file; what suits the policy's task by default."""
    design: str = ""
    """Shipped name or YAML file of the robot; that which the policy was trained on by default."""
    variant: str = ""
    """Ablation to make of the design."""
    set: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """PATH=VALUE to change of the robot, such as toe.mass=0.5."""
    set_file: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """YAML file of parameters that differ, applied before --set."""
    out: Path
    """Folder to write tables to."""
    workers: Annotated[int, AtLeast(1)] = 2
    """Number of processes that run side by side."""
    overlay: str = ""
    """Overlay (`hyperleg gap apply`) whose effects the simulation gets; none by default."""
    swap: Literal["", "lock_toe", "toe_motor_alone", "toe_motor_to_ankle"] = ""
    """Change of the toe that the policies were not trained for; none by default."""
    logs: Path | None = None
    """Folder to write a log of every trial to, as `hyperleg gap` reads them; none by default."""
    lerobot: Path | None = None
    """Folder to write all trials to as a LeRobot dataset (v3.0); none by default."""
    all: bool = False
    """Print every measure, not only those that are read first."""

    def run(self) -> None:
        """Evaluate the policies, write the tables, and print the means.

        Raises:
            InputError: no policy, the same policy twice, or options that do not fit together.
        """
        from hyperleg_design.evaluation.evaluate import evaluate_many
        from hyperleg_design.evaluation.result import swapped
        from hyperleg_design.evaluation.result_tables import write_results
        from hyperleg_design.evaluation.shipped import check_different, find_policy
        from hyperleg_design.report.evaluation_text import evaluation_rows, evaluation_text
        from hyperleg_design.simulation.toe_swap import Swap
        from hyperleg_design.writing import check_output_folder

        if not self.policies:
            remedy = "expects ONNX files, or names of `hyperleg list policies`"
            raise InputError("evaluate", "", None, remedy)
        overlay = None
        if self.overlay:
            from hyperleg_design.gap.playback.overlay import read_overlay, write_overlay

            overlay = read_overlay(self.overlay)
        check_different(map(find_policy, self.policies), "evaluate")
        for name in ("out", "logs", "lerobot"):
            if (folder := getattr(self, name)) is not None:
                check_output_folder(folder, f"--{name}")
        alterations: Alterations | None = overlay.alterations if overlay else None
        if self.swap:
            if overlay:
                raise InputError("evaluate", "swap", self.swap, "cannot be used with an overlay")
            alterations = Swap(self.swap)
        evaluations = evaluate_many(
            self.policies,
            self.protocol or None,
            designs=[self._design(policy) for policy in self.policies],
            workers=self.workers,
            kept=1 if self.logs is None and self.lerobot is None else sys.maxsize,
            alterations=alterations,
        )
        if self.swap:
            evaluations = [swapped(evaluation, self.swap) for evaluation in evaluations]
        folder = write_results(self.out, evaluations)
        written = []
        if self.logs is not None:
            from hyperleg_design.gap.logs.recording import write_logs

            written = write_logs(self.logs, evaluations)
        if self.lerobot is not None:
            from hyperleg_design.evaluation.lerobot import write_lerobot

            write_lerobot(self.lerobot, evaluations)
        if overlay:
            write_overlay(folder / "overlay.yaml", overlay)
        rows = evaluation_rows(evaluations)
        if self.json:
            trained = {evaluation.policy: evaluation.trained.text() for evaluation in evaluations}
            emit({"folder": folder, "results": rows, "trained": trained, "logs": written})
        else:
            print(evaluation_text(rows, everything=self.all))
            for evaluation in evaluations:
                print(f"{evaluation.policy} on {evaluation.design}: {evaluation.trained.text()}")
            print(
                f"tables in {folder}" + (f"; {len(written)} logs in {self.logs}" if written else "")
            )

    def _design(self, policy: str) -> RobotDesign | None:
        """The robot for a policy; None for the policy's own, unchanged."""
        if self.design:
            return load_robot(
                self.design,
                overrides=self.set,
                overlays=self.set_file,
                variant=self.variant or None,
            )
        if self.variant:
            raise InputError("evaluate", "variant", self.variant, "needs --design")
        if not (self.set or self.set_file):
            return None
        return changed_robot(load_policy(policy).design, overrides=self.set, overlays=self.set_file)


@dataclass(frozen=True, kw_only=True)
class Robustness(Printing):
    """Evaluate policies under changed conditions and draw curves over them: pushes, slopes, floor
    friction, payload, errors of friction and torque constants, uneven floors, and speeds.
    """

    policies: Annotated[tuple[str, ...], tyro.conf.Positional]
    """ONNX files, or names of shipped trainings, all of walks or all of T-tests."""
    conditions: tuple[str, ...] = ()
    """speed, push, slope, floor_friction, payload, joint_friction, torque_constant, uneven_floor;
    all that there are for the task by default."""
    trials: Annotated[int, AtLeast(1)] = 10
    """Number of trials at each level of a condition."""
    out: Path
    """Folder to write: robustness.png, trials.parquet and curves.json."""
    workers: Annotated[int, AtLeast(1)] = 2
    """Processes side by side."""

    def run(self) -> None:
        """Evaluate the policies under changed conditions, and write the page with its curves."""
        from hyperleg_design.report.walks.robustness_page import run_robustness
        from hyperleg_design.report.walks.robustness_text import robustness_text

        points = run_robustness(
            self.policies,
            self.out,
            conditions=self.conditions,
            trials=self.trials,
            workers=self.workers,
            progress=not self.json,
        )
        curves = self.out / "robustness.png"
        self.tell(points, f"{robustness_text(points)}\ncurves in {curves}")


@dataclass(frozen=True, kw_only=True)
class Paper(Printing):
    """Evaluate the shipped policies, and put Tables III and IV and Figs. 4 to 7 beside the paper's
    on a page.
    """

    policies: Path | None = None
    """Folder of trainings, such as results/campaign; the shipped policies by default."""
    out: Path = Path("results/paper")
    """Folder to write; its index.html is the page."""
    workers: Annotated[int | None, AtLeast(1)] = None
    """Number of processes that run side by side; as many as the machine has processors by
    default."""

    def run(self) -> None:
        """Evaluate the policies and write the page."""
        from hyperleg_design.report.walks.compared import coverage, coverage_text
        from hyperleg_design.report.walks.paper_page import read_tables, run_paper, tables_text
        from hyperleg_design.writing import check_output_folder

        check_output_folder(self.out)
        trainings = coverage(self.policies)
        if not self.json and (text := coverage_text(trainings)):
            print(text, flush=True)
        page = run_paper(self.policies, self.out, workers=self.workers, progress=not self.json)
        tables = read_tables(self.out)
        content = {"page": str(page), "trainings": trainings, "tables": tables}
        self.tell(content, f"{tables_text(tables)}\nopen {page}")
