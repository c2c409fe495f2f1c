"""What a sweep takes before it has begun: designs, trials, processor time and memory."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from hyperleg_design.errors import InputError
from hyperleg_design.sweep.trials.trial_plan import kind_of

if TYPE_CHECKING:
    from hyperleg_design.sweep.spaces.definition import Sweep
    from hyperleg_design.sweep.trials.trial_plan import Plan

SECONDS_A_DESIGN = 1e-4
"""Processor time of the sizing measures of one design [s]; measured with HyperLeg's family."""
BYTES_A_DESIGN = 2e3
"""Memory that summary and page take for one design [B]; measured with HyperLeg's family."""
SECONDS_A_TRIAL = 0.3
"""Processor time of one trial [s]; measured on walks of 20 m."""
WORTH_SAYING = 10.0
"""Processor time from which a sweep is announced before it begins [s]; assumed."""


@dataclass(frozen=True)
class Effort:
    """An estimate of what a sweep takes."""

    designs: int
    """Rows of the table: samples times variants."""
    trials: int
    """Trials of all policies on all designs."""

    @property
    def seconds(self) -> float:
        """Processor time of all designs and trials [s]."""
        return self.designs * SECONDS_A_DESIGN + self.trials * SECONDS_A_TRIAL

    @property
    def memory(self) -> float:
        """Memory that the summary and the page of the sweep take [B]."""
        return self.designs * BYTES_A_DESIGN

    def text(self) -> str:
        """Write the estimate as a line for a person.

        Returns:
            The line.
        """
        trials = f" and {self.trials} trials" if self.trials else ""
        memory = self.memory / 1e9
        needed = f" and {memory:.1f} GB of memory" if memory >= 0.1 else ""
        return (
            f"{self.designs} designs{trials}: about {_time(self.seconds)} on one processor{needed}"
        )


def effort_of(sweep: Sweep, plan: Plan) -> Effort:
    """Estimate what a sweep takes.

    Args:
        sweep: the definition.
        plan: protocols and policies that run on its designs.

    Returns:
        The estimate.
    """
    trials = sum(
        sweep.count * int(protocol.trials) * len(plan.policies[kind_of(protocol), variant])
        for protocol in plan.protocols
        for variant in sweep.variants
    )
    return Effort(sweep.size, trials)


def check_effort(effort: Effort, most: int, where: str) -> None:
    """Refuse a sweep of more designs than were asked for.

    Args:
        effort: of the sweep.
        most: designs that it may have.
        where: file of the sweep, for the error.

    Raises:
        InputError: it has more.
    """
    if effort.designs > most:
        remedy = (
            f"is more than {most}: {effort.text()}; lower the steps, sample with sobol, or give "
            f"--most-designs {effort.designs}"
        )
        raise InputError(where, "designs", effort.designs, remedy)


def _time(seconds: float) -> str:
    for unit, length in (("h", 3600.0), ("min", 60.0)):
        if seconds >= length:
            return f"{seconds / length:.0f} {unit}"
    return f"{seconds:.0f} s"
