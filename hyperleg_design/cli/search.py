"""The verb search; no logic of its own."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from hyperleg_design.cli.arguments import AtLeast
from hyperleg_design.cli.output import Printing, emit


@dataclass(frozen=True, kw_only=True)
class Search(Printing):
    """Search the space of a sweep for good designs; the same command continues a killed run."""

    file: Annotated[str, tyro.conf.Positional]
    """Sweep whose axes are the space: shipped name or YAML file."""
    out: Path
    """Folder of the search; holds its database by default."""
    trials: Annotated[int, AtLeast(1)] = 64
    """Designs to evaluate in all, those of earlier runs included."""
    evaluate: tuple[str, ...] = ()
    """Protocols to run on every design: walk, t_test, or YAML files; those that the sweep names by
    default."""
    objective: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """Measure to optimise, of `hyperleg list measures`; the sweep's objectives by default."""
    constraint: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """Bound such as walk.thermal_peak<=1; arrivals, heat and torque within bounds by default."""
    storage: str = ""
    """URL of the database, such as postgresql+psycopg://user@host/name; SQLite by default."""
    name: str = ""
    """Name of the study in the database; that of the sweep by default."""
    seeds: Annotated[int, AtLeast(1)] = 1
    """Trainings of the robot, or of each toe layout, whose policies are evaluated, at most; the
    best on each design is reported."""
    policies: tuple[Path, ...] = ()
    """Folders of trainings; the shipped policies by default."""
    batch: Annotated[int, AtLeast(1)] = 8
    """Designs evaluated side by side; a killed run repeats at most those."""
    finalists: Annotated[int, AtLeast(0)] = 3
    """Number of the best designs that run the protocols again, with new starting states and more
    trials, before a winner is named; 0 for none."""
    finetune: Annotated[int, AtLeast(0)] = 0
    """Policy steps by which each policy is trained on each finalist before its new trials; without,
    finalists walk with the policies of the search. Needs the learning extra."""
    workers: Annotated[int, AtLeast(1)] = 2
    """Number of those trainings that run side by side."""
    scheduler: str = ""
    """Address of a Dask scheduler, such as tcp://host:8786; this process by default."""

    def run(self) -> None:
        """Run the search or what is left of it, evaluate its finalists, and print them."""
        from hyperleg_design.report.sweep.search_text import final_text, search_text
        from hyperleg_design.sweep.finalists import check_fine_tuning, run_finalists
        from hyperleg_design.sweep.jobs import cluster
        from hyperleg_design.sweep.search import found_designs, run_search, search_of
        from hyperleg_design.sweep.space import load_sweep
        from hyperleg_design.sweep.trials.trial_plan import plan

        sweep = load_sweep(self.file)
        protocols = self.evaluate or sweep.evaluated
        wanted = plan(sweep, protocols, seeds=self.seeds, policies=self.policies)
        search = search_of(sweep, wanted, self.objective, self.constraint)
        if self.finetune:
            check_fine_tuning(search)
        with cluster(self.scheduler) as executor:
            study = run_search(
                search,
                self.out,
                self.trials,
                storage=self.storage,
                name=self.name,
                batch=self.batch,
                executor=executor,
                progress=not self.json,
            )
        final = run_finalists(
            search,
            study,
            self.out,
            count=self.finalists,
            steps=self.finetune,
            workers=self.workers,
            progress=not self.json,
        )
        if self.json:
            front = found_designs(search, study)
            emit({"trials": len(study.trials), "front": front, "final": final.to_mapping()})
            return
        print(search_text(search, study))
        if self.finalists:
            print(final_text(search, final))
