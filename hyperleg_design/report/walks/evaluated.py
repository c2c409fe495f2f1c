"""All shipped policies under their protocols, evaluated side by side: what tables, figures and the
page are made from.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from hyperleg_design.evaluation.evaluate import evaluate_many, evaluation_pool, protocol_for
from hyperleg_design.evaluation.policy import load_policy
from hyperleg_design.evaluation.protocol import Protocol, TTestProtocol, load_protocol
from hyperleg_design.evaluation.result import Evaluation
from hyperleg_design.evaluation.result_tables import trial_table
from hyperleg_design.evaluation.robustness import CONDITIONS, robustness
from hyperleg_design.evaluation.shipped import Shipped, check_different
from hyperleg_design.evaluation.versus_paper import VARIANTS
from hyperleg_design.report.walks.compared import (
    compared_policies,
    missing_trainings,
    rewarded_policies,
)

if TYPE_CHECKING:
    import pandas as pd

    from hyperleg_design.evaluation.rollout import Trial

WALK, T_TEST = "walk", "t_test"
"""Kinds of protocol."""
TIME_CONSTANTS = (0.01, 0.014, 0.02, 0.028, 0.04)
"""Time constants of the contact over which impacts are shown [s]; the first is the stiffest that
steps of 5 ms allow."""
BAND_SEEDS, BAND_TRIALS = 3, 4
"""Trainings of each design, and walks of each, at every time constant and speed."""
SPEED = "speed"
"""Condition of `robustness` that the cost of transport is shown over."""


@dataclass(frozen=True, eq=False)
class Evaluated:
    """Policies and what was measured on them."""

    policies: list[Shipped]
    evaluations: list[Evaluation]
    """Evaluations of all policies."""
    missing: list[str] = field(default_factory=list)
    """Trainings of the study's campaigns that are not there."""
    band: Mapping[str, Mapping[float, list[Evaluation]]] = field(default_factory=dict)
    """Walks over a band of contact time constants [s], by design."""
    speeds: Mapping[str, pd.DataFrame] = field(default_factory=dict)
    """Trials over commanded speeds, as `robustness` gives them, by group; of groups that observe no
    gait clock and were trained for all of these speeds."""
    rewards: pd.DataFrame | None = None
    """Walks under the rewards of `REWARDS`, one row each, with their `group`."""

    def groups(self, kind: str) -> list[str]:
        """List the groups of trainings that were run under a kind of protocol.

        Args:
            kind: of protocol.

        Returns:
            Names of the groups, in their order.
        """
        return list(
            dict.fromkeys(
                p.group
                for p, e in zip(self.policies, self.evaluations, strict=True)
                if _kind(e) == kind
            )
        )

    def designs(self, group: str) -> list[str]:
        """List the designs of a group, the paper's two first.

        Args:
            group: of trainings.

        Returns:
            Names of the designs.
        """
        names = dict.fromkeys(p.design for p in self.policies if p.group == group)
        return sorted(
            names,
            key=lambda name: (VARIANTS.index(name) if name in VARIANTS else len(VARIANTS), name),
        )

    def of(self, group: str, design: str, *, late: bool = True) -> list[Evaluation]:
        """Collect the evaluations of a group and design.

        Args:
            group: of trainings.
            design: name of the design.
            late: whether policies before the last of a training count, too.

        Returns:
            Evaluations by seed, the last policy of each training first.
        """
        pairs = zip(self.policies, self.evaluations, strict=True)
        return [
            e for p, e in pairs if (p.group, p.design) == (group, design) and (late or p.late == 0)
        ]

    def shown(self, group: str, design: str) -> Trial | None:
        """Find a trial of a group and design whose signals were kept.

        Args:
            group: of trainings.
            design: name of the design.

        Returns:
            The trial; None where there is none.
        """
        return next(
            (evaluation.trials[0] for evaluation in self.of(group, design) if evaluation.trials),
            None,
        )

    def seeds(self, group: str, design: str) -> list[int]:
        """List the trainings of a group and design.

        Args:
            group: of trainings.
            design: name of the design.

        Returns:
            Their seeds.
        """
        return sorted({p.seed for p in self.policies if (p.group, p.design) == (group, design)})

    def table(self, group: str) -> pd.DataFrame:
        """Tabulate all trials of a group.

        Args:
            group: of trainings.

        Returns:
            One row for each trial; `variant` and `seed` are those of the trainings' folders.
        """
        pairs = zip(self.policies, self.evaluations, strict=True)
        return _trials([(p, e) for p, e in pairs if p.group == group])


def evaluate_shipped(
    folder: str | Path | None = None,
    *,
    walk: Protocol | None = None,
    t_test: Protocol | None = None,
    band: Sequence[float] = TIME_CONSTANTS,
    late: bool = True,
    over_speeds: bool = True,
    workers: int | None = None,
    progress: Callable[[int, int, str], None] | None = None,
) -> Evaluated:
    """Evaluate all policies of a folder of trainings, each under the protocol that suits its task.

    Policies that a shipped campaign lists as mere starts of others are left out.

    Args:
        folder: of trainings; the shipped policies by default.
        walk: protocol of policies that walk at a speed; the shipped one by default.
        t_test: protocol of policies that run to waypoints; the shipped one by default.
        band: time constants of the contact over which walks are repeated [s]; none to leave that
            out.
        late: whether policies shortly before the end of a training count beside its last one.
        over_speeds: whether the first trainings of each design also walk at every speed of `SPEED`.
        workers: processes; as many as the machine has processors by default.
        progress: called with how many of how many evaluations are done, and which was the last.

    Returns:
        Empty where there is no policy.

    Raises:
        InputError: no such folder, a policy that cannot be used, or the same policy twice.
    """
    policies, rewarded = compared_policies(folder, late=late), rewarded_policies(folder)
    check_different(policy.path for policy in [*policies, *rewarded])
    protocols = {WALK: walk or load_protocol("walk"), T_TEST: t_test or load_protocol("t_test")}
    few = protocols[WALK].changed(trials=min(BAND_TRIALS, int(protocols[WALK].trials)))
    kinds = [
        T_TEST if isinstance(protocol_for(load_policy(p.path)), TTestProtocol) else WALK
        for p in policies
    ]
    banded = _banded(policies, kinds) if band else []
    count, done = len(policies) + len(banded) * len(band) + len(rewarded), 0

    def note(evaluation: Evaluation) -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done, count, evaluation.policy)

    processes = workers or os.cpu_count() or 1
    with evaluation_pool(processes) as pool:
        evaluating = partial(evaluate_many, workers=processes, pool=pool, progress=note)
        evaluations = _under_own_protocols(policies, kinds, protocols, evaluating)
        walks = _over_contacts(banded, band, few, evaluating)
        speeds = {
            group: robustness(
                [p.path for p in some], [SPEED], protocol=few, workers=processes, pool=pool
            )
            for group, some in (_free(policies, kinds) if over_speeds else {}).items()
        }
        rewards = None
        if rewarded:
            some = evaluating([p.path for p in rewarded], protocols[WALK], kept=0)
            rewards = _trials(list(zip(rewarded, some, strict=True)))
    return Evaluated(policies, evaluations, missing_trainings(policies), walks, speeds, rewards)


def _trials(chosen: Sequence[tuple[Shipped, Evaluation]]) -> pd.DataFrame:
    """All trials of some policies; group, variant and seed are those of the trainings' folders."""
    table = trial_table([e for _, e in chosen])
    table["group"] = [p.group for p, e in chosen for _ in e.measures]
    table["variant"] = [p.design for p, e in chosen for _ in e.measures]
    table["seed"] = [p.seed for p, e in chosen for _ in e.measures]
    return table


def _under_own_protocols(
    policies: Sequence[Shipped],
    kinds: Sequence[str],
    protocols: Mapping[str, Protocol],
    evaluating: Callable[..., list[Evaluation]],
) -> list[Evaluation]:
    """Evaluate each policy under the protocol of its kind; the first last policy of each group and
    design keeps the signals of one trial.
    """
    shown = {(p.group, p.design): i for i, p in reversed(list(enumerate(policies))) if p.late == 0}
    evaluations: dict[int, Evaluation] = {}
    for kind, protocol in protocols.items():
        places = [i for i, own in enumerate(kinds) if own == kind]
        if places:
            signals = [int(i in shown.values()) for i in places]
            of_kind = evaluating([policies[i].path for i in places], protocol, kept=signals)
            evaluations |= dict(zip(places, of_kind, strict=True))
    return [evaluations[i] for i in range(len(policies))]


def _over_contacts(
    policies: Sequence[Shipped],
    constants: Sequence[float],
    protocol: Protocol,
    evaluating: Callable[..., list[Evaluation]],
) -> dict[str, dict[float, list[Evaluation]]]:
    """Evaluate policies on contacts of several time constants [s], by design and constant."""
    jobs = [(policy, constant) for policy in policies for constant in constants]
    if not jobs:
        return {}
    walks = evaluating(
        [policy.path for policy, _ in jobs],
        protocol,
        kept=0,
        overrides=[{"contact.time_constant": constant} for _, constant in jobs],
    )
    by_design: dict[str, dict[float, list[Evaluation]]] = {}
    for (policy, constant), evaluation in zip(jobs, walks, strict=True):
        by_design.setdefault(policy.design, {}).setdefault(constant, []).append(evaluation)
    return by_design


def _banded(policies: Sequence[Shipped], kinds: Sequence[str]) -> list[Shipped]:
    """Last policies of the first trainings of the paper's two designs, of the first group that
    walks and has most of them.
    """
    last = [
        p
        for p, kind in zip(policies, kinds, strict=True)
        if kind == WALK and p.late == 0 and p.design in VARIANTS
    ]
    if not last:
        return []
    groups = {p.group: len({q.design for q in last if q.group == p.group}) for p in last}
    group = max(groups, key=lambda name: groups[name])
    return [
        p
        for design in VARIANTS
        for p in [q for q in last if (q.group, q.design) == (group, design)][:BAND_SEEDS]
    ]


def _free(policies: Sequence[Shipped], kinds: Sequence[str]) -> dict[str, list[Shipped]]:
    """Last policies of the first trainings of each group and design that choose their cadence by
    themselves over all speeds of `SPEED`, by group.
    """
    fastest = max(CONDITIONS[SPEED].levels)
    chosen: dict[str, list[Shipped]] = {}
    counts: dict[tuple[str, str], int] = {}
    for policy, kind in zip(policies, kinds, strict=True):
        task = load_policy(policy.path).task if kind == WALK and not policy.late else None
        if task is None or "clock" in task.observations["policy"]:
            continue
        if getattr(task.commands, "forward_high", 0.0) < fastest:
            continue
        key = (policy.group, policy.design)
        counts[key] = counts.get(key, 0) + 1
        if counts[key] <= BAND_SEEDS:
            chosen.setdefault(policy.group, []).append(policy)
    return chosen


def _kind(evaluation: Evaluation) -> str:
    return T_TEST if isinstance(evaluation.protocol, TTestProtocol) else WALK
