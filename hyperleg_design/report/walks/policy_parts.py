"""What evaluated policies say, as parts of a page: what there is, Tables III and IV and Figs. 4 to
7 beside the paper, learning.
"""

from __future__ import annotations

from typing import Any

from hyperleg_design.evaluation import statistics
from hyperleg_design.evaluation.result import by_checkpoint
from hyperleg_design.evaluation.shipped import learning_curve, trainings_text
from hyperleg_design.evaluation.versus_paper import VARIANTS
from hyperleg_design.report.drawer import Drawer, Part
from hyperleg_design.report.page import Cell, Details, Table
from hyperleg_design.report.sizing.envelope_figures import torque_speed_figure
from hyperleg_design.report.style import later
from hyperleg_design.report.walks import walk_parts as walks
from hyperleg_design.report.walks.arms_part import arms
from hyperleg_design.report.walks.compared import CAMPAIGNS
from hyperleg_design.report.walks.confound_part import confound
from hyperleg_design.report.walks.evaluated import T_TEST, WALK, Evaluated
from hyperleg_design.report.walks.impact_part import impacts
from hyperleg_design.report.walks.learning_figures import learning_figure
from hyperleg_design.report.walks.planned_part import planned, planned_rows
from hyperleg_design.report.walks.rewards_part import rewards
from hyperleg_design.report.walks.t_test_part import table_four
from hyperleg_design.report.walks.walk_figures import operating_points_figure


def parts(evaluated: Evaluated, draw: Drawer) -> list[Part]:
    """Make all parts that the policies allow, in the order of a page; the first states what is
    missing.

    Args:
        evaluated: the policies with their trials.
        draw: draws figures into the page's folder.

    Returns:
        The parts.
    """
    if not evaluated.policies:
        return [rewards(evaluated.rewards)] if evaluated.rewards is not None else []
    list_of_parts = [_what(evaluated)]
    if planned_rows(evaluated):
        list_of_parts.append(planned(evaluated))
    if evaluated.groups(WALK):
        list_of_parts += [
            walks.walks(evaluated, draw),
            walks.table_three(evaluated, draw),
            walks.cycle(evaluated, draw),
        ]
    if evaluated.speeds:
        list_of_parts.append(walks.speeds(evaluated, draw))
    if evaluated.groups(T_TEST):
        list_of_parts.append(table_four(evaluated, draw))
    list_of_parts += [arms(evaluated), confound(evaluated, draw)]
    if evaluated.rewards is not None:
        list_of_parts.append(rewards(evaluated.rewards))
    if evaluated.band:
        list_of_parts.append(impacts(evaluated, draw))
    return [*list_of_parts, _motors(evaluated, draw), _learning(evaluated, draw)]


def _what(evaluated: Evaluated) -> Part:
    rows: list[list[Any]] = []
    for kind in (WALK, T_TEST):
        for group in evaluated.groups(kind):
            table = evaluated.table(group)
            for design in evaluated.designs(group):
                part = table[table["variant"] == design]
                falls = statistics.share(list(by_checkpoint(part, "fell").values()), resamples=1000)
                arrived = int(part["arrived"].sum())
                ends = ", ".join(
                    f"{count} {str(name).replace('_', ' ')}"
                    for name, count in part["outcome"].value_counts().items()
                )
                seeds, policies = evaluated.seeds(group, design), part["policy"].nunique()
                fell = int(part["fell"].sum())
                share = f"{100 * falls.mean:.1f} % [{100 * falls.low:.1f}, {100 * falls.high:.1f}]"
                rows.append(
                    [
                        group,
                        design,
                        ", ".join(map(str, seeds)),
                        policies,
                        len(part),
                        Cell(fell, "bad" if fell else "good"),
                        share,
                        Cell(ends, "good" if arrived == len(part) else "note"),
                    ]
                )
    protocols = {e.protocol.name: e.protocol for e in evaluated.evaluations}
    text = "; ".join(
        f"{name}: {int(p.trials)} trials, starting states from seed {int(p.seed)}"
        for name, p in protocols.items()
    )
    content: list[Any] = [
        f"{len(evaluated.policies)} policies of {len({p.training for p in evaluated.policies})} trainings, each run on its own protocol ({text}), deterministic and without assist. "
        "Intervals are 95 % and rest on a hierarchical bootstrap over training seeds, late checkpoints and trials, widened for few seeds; "
        "a difference is told only where both sides have three seeds and the interval leaves zero out. Falls are counted, never dropped; what a fallen trial cannot give is counted as missing.",
        Table(
            [
                "group",
                "design",
                "seeds",
                "policies",
                "trials",
                "falls",
                "share of falls",
                "how trials ended",
            ],
            rows,
        ),
    ]
    content.append(
        f"Of the trainings that the study plans ({', '.join(f'{name}.yaml' for name in CAMPAIGNS)}), {len(evaluated.missing)} are not there: {trainings_text(evaluated.missing)}."
        if evaluated.missing
        else "All trainings that the study plans are there."
    )
    content.append(_deviations(evaluated))
    return Part("What was evaluated", content)


def _deviations(evaluated: Evaluated) -> Any:
    """Reward terms and observations that are not the paper's, by group."""
    terms: dict[str, dict[str, str]] = {}
    for policy, evaluation in zip(evaluated.policies, evaluated.evaluations, strict=True):
        given = evaluation.origin.get("deviations")
        terms.setdefault(policy.group, {}).update(given if isinstance(given, dict) else {})
    rows = [
        [group, name.replace("_", " "), text]
        for group, some in terms.items()
        for name, text in some.items()
    ]
    rows += [
        [group, "none", "the paper's reward alone"] for group, some in terms.items() if not some
    ]
    return Details(
        "What is not the paper's: reward terms and observations",
        [Table(["group", "term", "what it is"], rows)],
    )


def _motors(evaluated: Evaluated, draw: Drawer) -> Part:
    content: list[Any] = []
    for kind, word in ((T_TEST, "a T-test"), (WALK, "a walk")):
        for group in evaluated.groups(kind)[:1]:
            trials = {
                d: t
                for d in evaluated.designs(group)
                if d in VARIANTS and (t := evaluated.shown(group, d)) is not None
            }
            if kind == T_TEST and "toe" in trials:
                toe = trials["toe"]
                legs = toe.layout.leg_joints
                torque, speed = (
                    values.reshape(-1, legs)[::4]
                    for values in (toe.driven_joint_torque, toe.joint_velocity)
                )
                content.append(
                    draw(
                        "fig_4",
                        "Fig. 4: the ankle's motors and joints in their envelopes during a T-test, active toe.",
                        later(torque_speed_figure, toe.design, torque, speed),
                    )
                )
            if trials:
                content.append(
                    draw(
                        f"points_{group}",
                        f"Operating points of every motor in {word}, both legs.",
                        later(operating_points_figure, trials),
                    )
                )
    return Part("Motors in their envelopes", content)


def _learning(evaluated: Evaluated, draw: Drawer) -> Part:
    curves = [p for p in evaluated.policies if p.late == 0 and learning_curve(p.path.parent)]
    if not curves:
        return Part("Learning curves", ["No training brought its learning curve along."])
    caption = (
        "Means over the robots in training, with exploration, and with the assist where one is drawn. "
        "A training that starts from another policy begins with what that one can."
    )
    return Part("Learning curves", [draw("learning", caption, later(learning_figure, curves))])
