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
    """Search the space of a sweep for good designs; killed, it goes on where it stopped."""

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
    """Bound such as walk.thermal_peak<=1; falls, heat and torque within bounds by default."""
    storage: str = ""
    """URL of the database, such as postgresql+psycopg://user@host/name; SQLite by default."""
    name: str = ""
    """Name of the study in the database; that of the sweep by default."""
    seeds: Annotated[int, AtLeast(1)] = 1
    """Trainings of each toe layout whose policies are evaluated, at most."""
    policies: Path | None = None
    """Folder of trainings; the shipped policies by default."""
    batch: Annotated[int, AtLeast(1)] = 8
    """Designs evaluated side by side; a killed run repeats at most those."""
    scheduler: str = ""
    """Address of a Dask scheduler, such as tcp://host:8786; this process by default."""

    def run(self) -> None:
        """Run the search or what is left of it, and print the best designs."""
        from hyperleg_design.report.sweep.search_text import search_text
        from hyperleg_design.sweep.jobs import cluster
        from hyperleg_design.sweep.search import found_designs, run_search, search_of
        from hyperleg_design.sweep.space import load_sweep
        from hyperleg_design.sweep.trial_runs import plan

        sweep = load_sweep(self.file)
        protocols = self.evaluate or sweep.evaluated
        wanted = plan(sweep, protocols, seeds=self.seeds, policies=self.policies)
        search = search_of(sweep, wanted, self.objective, self.constraint)
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
        if self.json:
            emit({"trials": len(study.trials), "front": found_designs(search, study)})
        else:
            print(search_text(search, study))
