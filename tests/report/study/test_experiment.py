from __future__ import annotations

from hyperleg_design.report.study import experiment as study_experiment
from hyperleg_design.report.study.context import Context


def test_without_a_policy_one_sentence_says_so(hyperleg, tmp_path):
    made = study_experiment.experiment(Context(hyperleg, {}, tmp_path, tmp_path))
    assert list(made.section.content) == [study_experiment.NO_POLICY]
    assert made.facts == ()


def test_arrivals_and_falls_are_headlines(found):
    walks, courses = study_experiment._facts(found)
    assert walks == ("17 / 18", "walks of 6 policies that arrived; 1 fell")
    assert courses == ("3 / 3", "T-tests of 1 policies that arrived; 0 fell")
