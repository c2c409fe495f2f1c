"""The confound: what can be told of toe, torque and mass with the ablations that are there."""

from __future__ import annotations

import dataclasses

import pytest

from hyperleg_design.evaluation.attribution import WHOLE
from hyperleg_design.report.page import Table
from hyperleg_design.report.walks.confound_part import ATTRIBUTED, confound
from hyperleg_design.report.walks.evaluated import T_TEST


def test_steps_that_need_missing_ablations_are_named(found, draw):
    content = confound(found, draw).content
    (table,) = (item for item in content if isinstance(item, Table))
    assert {row[1] for row in table.rows} == {WHOLE}
    assert any(
        "toe_locked, toe_removed cannot be told" in item
        for item in content
        if isinstance(item, str)
    )


def test_the_whole_ladder_is_split(found, draw):
    matched = [
        e
        for p, e in zip(found.policies, found.evaluations, strict=True)
        if p.group == "walk" and p.design == "toe_removed_matched"
    ]
    policies, evaluations = list(found.policies), list(found.evaluations)
    for design in ("toe_locked", "toe_removed"):
        for seed, one in enumerate(matched):
            first = found.policies[0]
            path = first.path.parent.parent / f"walk-{design}-{seed}" / "policy.onnx"
            policies.append(dataclasses.replace(first, design=design, seed=seed, path=path))
            evaluations.append(dataclasses.replace(one, policy=f"walk-{design}-{seed}/policy"))
    whole = dataclasses.replace(found, policies=policies, evaluations=evaluations)
    content = confound(whole, draw).content
    (table,) = (item for item in content if isinstance(item, Table))
    power = [row for row in table.rows if row[0] == "power"]
    assert len(power) == 4
    steps = [float(row[2].split(" ")[0]) for row in power]
    assert sum(steps[:3]) == pytest.approx(steps[3], abs=0.02 * abs(steps[3]) + 0.1)


def test_without_two_ablations_nothing_is_split(found, draw):
    toe = [
        (p, e) for p, e in zip(found.policies, found.evaluations, strict=True) if p.design == "toe"
    ]
    alone = dataclasses.replace(
        found, policies=[p for p, _ in toe], evaluations=[e for _, e in toe]
    )
    assert confound(alone, draw).content[-1].startswith("Cannot be told yet")


def test_t_tests_are_split_as_walks_are(courses, draw):
    content = confound(courses, draw).content
    (table,) = (item for item in content if isinstance(item, Table))
    assert table.caption == "Group t_test_free: toe → toe_locked → toe_removed_matched."
    assert len(table.rows) == 3 * len(ATTRIBUTED[T_TEST])
    whole = next(row for row in table.rows if row[:2] == ["time", WHOLE])
    assert whole[3].startswith("+5.")  # the fixture's arms take 0 and 5 % longer than planned


def test_an_arm_of_one_training_is_left_out(courses, draw):
    pairs = [
        (p, e)
        for p, e in zip(courses.policies, courses.evaluations, strict=True)
        if p.seed == 0 or p.design != "toe_locked"
    ]
    fewer = dataclasses.replace(
        courses, policies=[p for p, _ in pairs], evaluations=[e for _, e in pairs]
    )
    content = confound(fewer, draw).content
    (table,) = (item for item in content if isinstance(item, Table))
    assert {row[1] for row in table.rows} == {WHOLE}
    assert any("toe_locked" in item and "not two" in item for item in content if type(item) is str)
