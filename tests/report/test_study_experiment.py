from __future__ import annotations

from hyperleg_design.report import study_experiment
from hyperleg_design.report.paper_page import NO_POLICY
from hyperleg_design.report.study import Context


def test_without_a_policy_one_sentence_says_so(hyperleg, tmp_path):
    made = study_experiment.experiment(Context(hyperleg, {}, tmp_path, tmp_path))
    assert list(made.section.content) == [NO_POLICY]
    assert made.facts == ()


def test_falls_are_a_headline(found):
    assert study_experiment._facts(found) == (("1 / 18", "falls in walks of 6 policies"), ("0 / 3", "falls in T-tests of 1 policies"))
