"""The part of the study's page that evaluates the shipped policies: walks and T-tests with and
without the active toe.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hyperleg_design.report.page import Heading, Section
from hyperleg_design.report.study.context import Made
from hyperleg_design.report.walks.evaluated import T_TEST, TIME_CONSTANTS, WALK, Evaluated
from hyperleg_design.report.walks.paper_page import evaluate_with_bar, policy_parts

if TYPE_CHECKING:
    from hyperleg_design.report.study.context import Context

TITLE = "Walking and the T-test, with trained policies"
SAMPLE = "To finish in minutes, this page takes the last policy of each training. hyperleg paper also takes the policies shortly before the end of each training, as the analysis plan has it, walks at other speeds and on more contacts; the README's results are those."
NO_POLICY = (
    "The folder of trainings holds no finished one, so walks and T-tests are not shown; "
    "hyperleg campaign run trains them."
)


def experiment(context: Context) -> Made:
    """Evaluate the last policy of every training in ten walks or ten T-tests, and show the results.

    Args:
        context: what the study is about, and where its files go.

    Returns:
        The section, and its headline numbers.
    """
    evaluated = evaluate_with_bar(
        context.policies,
        progress=context.progress,
        late=False,
        over_speeds=False,
        band=TIME_CONSTANTS[::2],
    )
    if not evaluated.policies:
        return Made(Section(TITLE, [NO_POLICY]))
    content: list[Any] = [
        "Trained policies in simulation, with cooperative actuation, motor envelopes and friction, deterministic and without assist.",
        SAMPLE,
    ]
    for part in policy_parts(evaluated, context.folder, "policy_"):
        content += [Heading(part.title), *part.content]
    return Made(Section(TITLE, content), _facts(evaluated))


def _facts(evaluated: Evaluated) -> tuple[tuple[str, str], ...]:
    facts = []
    for kind, word in ((WALK, "walks"), (T_TEST, "T-tests")):
        trials = [
            e
            for group in evaluated.groups(kind)
            for design in evaluated.designs(group)
            for e in evaluated.of(group, design)
        ]
        if trials:
            fell, arrived = (
                sum(int(e.values(ending).sum()) for e in trials) for ending in ("fell", "arrived")
            )
            facts.append(
                (
                    f"{arrived} / {sum(len(e.outcomes) for e in trials)}",
                    f"{word} of {len(trials)} policies that arrived; {fell} fell",
                )
            )
    return tuple(facts)
