"""Which groups of trainings the analysis plan compares, and with which T-test."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from types import SimpleNamespace

from hyperleg_design.evaluation.plans.analysis_plan import load_plan
from hyperleg_design.evaluation.protocol import TTestProtocol, WalkProtocol
from hyperleg_design.evaluation.shipped import Shipped
from hyperleg_design.report.walks.evaluated import Evaluated
from hyperleg_design.report.walks.planned_part import studies

PLAN = load_plan()


def evaluated(*groups):
    """Groups, each as name, protocol, whether it observes a clock, and designs."""
    policies, evaluations = [], []
    for name, protocol, clocked, designs in groups:
        for design in designs:
            policies.append(Shipped(name, design, 0, 0, Path(name)))
            origin = {"deviations": ["clock"] if clocked else []}
            evaluations.append(SimpleNamespace(protocol=protocol, origin=origin))
    return Evaluated(policies, evaluations)


BOTH = (PLAN.active, PLAN.compared)
FREE = ("walk_upright", WalkProtocol(), False, BOTH)
CLOCKED = ("walk", WalkProtocol(), True, BOTH)
RUN, CLOCKED_RUN = (
    ("t_test_free", TTestProtocol(), False, BOTH),
    ("t_test", TTestProtocol(), True, BOTH),
)


def test_walks_go_with_the_t_test_that_was_trained_alike():
    assert studies(evaluated(FREE, CLOCKED, CLOCKED_RUN, RUN), PLAN) == [
        {"walk": "walk_upright", "t_test": "t_test_free"},
        {"walk": "walk", "t_test": "t_test"},
    ]


def test_a_t_test_of_another_kind_of_training_stands_alone():
    assert studies(evaluated(FREE, CLOCKED_RUN), PLAN) == [
        {"walk": "walk_upright"},
        {"t_test": "t_test"},
    ]


def test_a_group_without_one_arm_is_no_study():
    alone = (*FREE[:3], (PLAN.active,))
    assert studies(evaluated(alone, RUN), PLAN) == [{"t_test": "t_test_free"}]
    assert studies(evaluated(alone), dataclasses.replace(PLAN)) == []
