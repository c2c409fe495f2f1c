"""What an evaluation gives: trials, measures, and how they become tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.policy import OnnxPolicy, Policy, policy_name

if TYPE_CHECKING:
    import pandas as pd

    from hyperleg_design.evaluation.motor_use import MotorUse
    from hyperleg_design.evaluation.power import CyclePower
    from hyperleg_design.evaluation.rollout import Trial
    from hyperleg_design.robot.design import Design


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Trials of one policy under one protocol, and what was measured on each."""

    policy: str
    """Name of the policy."""
    variant: str
    """Ablation of the design."""
    design: str
    """Name of the design."""
    seed: int
    """Of the training; -1 where unknown."""
    steps: int
    """Policy steps of the training; -1 where unknown."""
    protocol: Any
    """The `WalkProtocol` or `TTestProtocol`."""
    trials: list[Trial]
    """With all signals."""
    measures: list[dict[str, float]]
    """Of each trial, the same names in all; NaN where a trial gives no such number."""
    motors: list[MotorUse | None]
    """Of each trial; None where it gives none."""
    cycles: list[CyclePower | None] = field(default_factory=list)
    """Right-leg power over the steady strides of each walk; None where there is none."""

    @property
    def outcomes(self) -> list[str]:
        """How each trial ended, of `rollout.OUTCOMES`."""
        return [trial.outcome for trial in self.trials]

    def values(self, measure: str) -> np.ndarray:
        """A measure in all trials, `(n,)`.

        Raises:
            InputError: no such measure.
        """
        if measure not in self.measures[0]:
            raise InputError("evaluation", "measure", measure, f"there are {', '.join(self.measures[0])}")
        return np.array([row[measure] for row in self.measures])


def evaluation_of(
    policy: Policy,
    design: Design,
    protocol: Any,
    trials: list[Trial],
    measures: list[dict[str, float]],
    motors: list[MotorUse | None],
    cycles: Sequence[CyclePower | None] = (),
) -> Evaluation:
    """An `Evaluation` with what the policy says of itself."""
    known = policy if isinstance(policy, OnnxPolicy) else None
    return Evaluation(
        policy=policy_name(policy),
        variant=design.variant,
        design=design.name,
        seed=known.seed if known else -1,
        steps=known.steps if known else -1,
        protocol=protocol,
        trials=trials,
        measures=measures,
        motors=motors,
        cycles=list(cycles),
    )


def trial_table(evaluations: Sequence[Evaluation]) -> pd.DataFrame:
    """One row a trial: policy, variant, design, training seed, training steps, protocol, trial, outcome, end time, all measures."""
    import pandas as pd

    rows = []
    for one in evaluations:
        head = {"policy": one.policy, "variant": one.variant, "design": one.design, "seed": one.seed, "steps": one.steps}
        for index, (trial, measures) in enumerate(zip(one.trials, one.measures, strict=True)):
            rows.append(head | {"protocol": one.protocol.name, "trial": index, "outcome": trial.outcome, "end_time": trial.end_time} | measures)
    return pd.DataFrame(rows)


def motor_table(evaluations: Sequence[Evaluation]) -> pd.DataFrame:
    """One row a motor and trial: policy, variant, training seed, trial, motor, and the fields of `MotorUse`."""
    import pandas as pd

    rows = []
    for one in evaluations:
        for index, (trial, use) in enumerate(zip(one.trials, one.motors, strict=True)):
            if use is None:
                continue
            for k, motor in enumerate(trial.layout.motors):
                head = {"policy": one.policy, "variant": one.variant, "seed": one.seed, "trial": index, "motor": motor}
                rows.append(head | {name: float(values[k]) for name, values in vars(use).items()})
    return pd.DataFrame(rows)


def by_seed(table: pd.DataFrame, measure: str) -> list[np.ndarray]:
    """A measure of the rows of a trial table, one array a training seed, as `statistics` takes it; checkpoints of a seed are pooled.

    Policies that do not say their seed count as a seed each.

    Raises:
        InputError: no such column.
    """
    if measure not in table:
        raise InputError("evaluation", "measure", measure, f"there are {', '.join(map(str, table.columns))}")
    key = table["seed"].astype(str).where(table["seed"] >= 0, table["policy"])
    return [part[measure].to_numpy(float) for _, part in table.groupby(key, sort=True)]
