"""Which trainings the planned comparison takes."""

from __future__ import annotations

from hyperleg_design.report.walks.compared import other_groups


def test_policies_that_answer_other_questions_stay_out_of_the_planned_comparison() -> None:
    others = other_groups()
    assert {"walk_free", "walk_clock", "walk_power", "walk_force", "walk_uneven"} <= others
    assert not {"walk_upright", "t_test_free", "own_group"} & others
