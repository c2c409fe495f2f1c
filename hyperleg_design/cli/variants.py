"""Verb on policies for many designs; no logic of its own."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from hyperleg_design.cli.arguments import AtLeast
from hyperleg_design.cli.output import Printing, emit

COMPARISON = """
Each policy is compared with the one under `against`: a ratio below 1 means that the policy costs
less (or takes less time), and more_falls below 0 that it falls in fewer trials."""
"""What is printed above the table of comparisons."""


@dataclass(frozen=True, kw_only=True)
class Variants(Printing):
    """Check a policy for many designs on held-out designs, beside other policies on the same."""

    policies: Annotated[tuple[str, ...], tyro.conf.Positional]
    """The policy to judge, then those to compare with: ONNX files or shipped names; a path with {}
    is one policy for each design, by its number."""
    designs: str = "toe"
    """Designs, of which the held-out ones are evaluated: shipped name or YAML file."""
    protocol: str = "walk"
    """Walk or T-test: shipped name or YAML file."""
    out: Path
    """Folder to write tables to, and each held-out design (0/design.yaml and so on)."""
    finetune: Annotated[int, AtLeast(0)] = 0
    """Policy steps by which the first policy is trained on each held-out design, to be compared
    with it as well; none by default. Needs the learning extra. The same command continues a
    run that was killed."""
    workers: Annotated[int, AtLeast(1)] = 2
    """Number of those trainings that run side by side."""
    threads: Annotated[int, AtLeast(1)] = 1
    """Number of threads of the simulation."""

    def run(self) -> None:
        """Evaluate, write and print."""
        from hyperleg_design.evaluation.held_out import check_held_out, held_out_designs
        from hyperleg_design.sweep.tunings.held_out_tuning import fine_tune_held_out, write_held_out
        from hyperleg_design.writing import check_output_folder, write_text

        folder = check_output_folder(self.out)
        policies, designs = self.policies, held_out_designs(self.policies, self.designs)
        write_held_out(designs.robots, folder)
        if self.finetune:
            first, *others = policies
            tuned = fine_tune_held_out(
                first,
                designs.robots,
                self.finetune,
                folder,
                workers=self.workers,
                progress=not self.json,
            )
            policies = (first, tuned, *others)
        check = check_held_out(policies, designs, self.protocol, threads=self.threads)
        write_text(folder / "held_out.csv", check.rows.to_csv(index=False))
        write_text(folder / "comparisons.csv", check.comparisons.to_csv(index=False))
        if self.json:
            rows = check.rows.astype(object).where(check.rows.notna(), None).to_dict("records")
            comparisons = check.comparisons.astype(object).where(check.comparisons.notna(), None)
            emit({"folder": folder, "rows": rows, "comparisons": comparisons.to_dict("records")})
            return
        drawn = [*designs.leaves, "trials"]
        print(check.rows.drop(columns=drawn).to_string(index=False, float_format="{:.3f}".format))
        if len(check.comparisons):
            print(COMPARISON)
            print(check.comparisons.to_string(index=False, float_format="{:.3f}".format))
        print(f"tables in {folder}")
