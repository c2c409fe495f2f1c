"""Verb `hyperleg validate`: the frozen benchmark of the diagnosis; no logic of its own."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from hyperleg_design.cli.arguments import AtLeast
from hyperleg_design.cli.output import Printing
from hyperleg_design.errors import InputError


@dataclass(frozen=True, kw_only=True)
class Validate(Printing):
    """Run the frozen benchmark of the diagnosis: real logs, faults drawn by a seed, simulated
    robots by other authors, blind plants; the same command continues a run that was stopped.
    """

    out: Path = Path("results/validation")
    """Folder of the results, one a checkout."""
    suites: tuple[str, ...] = ("real", "newcomers", "blind")
    """Suites of the benchmark to run: real, drawn, newcomers, blind."""
    splits: tuple[str, ...] = ("development", "held out")
    """Splits to run. Development cases may be looked at while a diagnosis is being improved, and
    held-out cases may not."""
    only: tuple[str, ...] = ()
    """Run only cases whose names contain one of these texts."""
    data: Path | None = None
    """Folder of the real logs; by default HYPERLEG_DATA, else ../shared/data beside the
    checkout."""
    checkout: Path | None = None
    """Folder of another checkout whose diagnosis is to be scored."""
    workers: Annotated[int, AtLeast(1)] = 1
    """Number of processes that run side by side, each on one thread."""
    list_cases: bool = False
    """List the cases instead."""

    def run(self) -> None:
        """Run the benchmark or what is left of it, and print its table.

        Raises:
            InputError: no such folder of data, or an unknown case.
        """
        from hyperleg_design.validation.benchmark.runner import chosen_cases, run_benchmark
        from hyperleg_design.validation.real.cases import data_folder

        cases = chosen_cases(self.suites, self.splits, self.only)
        if self.list_cases:
            named = [{"name": c.name, "split": c.split, "about": c.about} for c in cases]
            self.tell(named, "\n".join(f"{c.name} ({c.split}): {c.about}" for c in cases))
            return
        if self.data is not None and not self.data.is_dir():
            raise InputError("validate", "--data", str(self.data), "no such folder")
        outcome = run_benchmark(
            self.out,
            cases,
            self.data or data_folder(),
            checkout=self.checkout,
            workers=self.workers,
            progress=not self.json,
        )
        content = {"cases": list(outcome.rows), "skipped": list(outcome.skipped)}
        self.tell(content, "\n".join([*outcome.remarks, outcome.markdown()]))
