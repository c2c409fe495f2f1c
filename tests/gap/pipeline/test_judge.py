"""Judging conditioned logs of a small robot in plain MuJoCo: causes, and references that differ."""

from __future__ import annotations

from types import SimpleNamespace

import causes
import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.inference.hypotheses.reference_differences import Difference
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.pipeline import judge
from hyperleg_design.gap.pipeline.judge import judge_signals
from hyperleg_design.gap.results.finding import ERROR, WARNING, Finding

RULES = InferenceRules()
PLACES = [
    (effect, joint)
    for effect in ("viscous_friction", "coulomb_friction")
    for joint in ("hip", "knee")
]


@pytest.fixture(scope="module")
def logs(robot_files):
    """Conditioned logs by what is wrong with the robot: a healthy one and others a day before."""
    days = {"healthy": "today", "viscous": "today", "before": "before", "dry": "before"}
    runs = [
        diagnosed.run("healthy" if kind == "before" else kind, seed, session=day)
        for seed, (kind, day) in enumerate(days.items())
    ]
    return dict(zip(days, diagnosed.conditioned(robot_files["coupled"], *runs), strict=True))


def named(diagnosis):
    return [(cause.effect, cause.location) for cause in diagnosis.causes]


@pytest.mark.parametrize("references", [(), ("before",)])
def test_the_friction_that_the_simulation_has_is_named_with_its_size(logs, references):
    diagnosis = judge_signals([logs["viscous"]], [logs[r] for r in references], PLACES, RULES)
    assert diagnosis.verdict == "explained"
    assert named(diagnosis) == [("viscous_friction", "knee")]
    damping = diagnosis.causes[0].parameters["damping"]
    assert damping.low < 0.30 < damping.high  # 0.33 in the simulation, 0.03 in the model
    assert diagnosis.reference_differences == ()
    assert (diagnosis.lacks is None) == (not references)


@pytest.mark.parametrize("references", [("before", "dry"), ("dry", "before")])
def test_of_two_references_the_odd_one_is_mended_whichever_comes_first(logs, references):
    """Either may be wrong: a healthy log under test says which."""
    diagnosis = judge_signals([logs["healthy"]], [logs[r] for r in references], PLACES, RULES)
    (difference,) = diagnosis.reference_differences
    assert difference["log"] == logs["dry"].log.name
    assert (difference["effect"], difference["location"]) == ("coulomb_friction", "hip")
    assert diagnosis.verdict == "none"


def test_a_place_that_is_not_tried_is_not_named(logs):
    elsewhere = [place for place in PLACES if place[1] == "hip"]
    diagnosis = judge_signals([logs["viscous"]], [logs["before"]], elsewhere, RULES)
    assert ("viscous_friction", "knee") not in named(diagnosis)
    assert diagnosis.verdict != "none"  # the gap is there all the same


def test_at_least_one_reference_stays_as_it_was_recorded(logs, monkeypatch):
    """However often references seem to differ: here by a friction of nothing at all."""
    nothing = causes.unbounded("coulomb_friction", "hip", np.zeros((2, 1)))
    endless = Difference(0, "endless", nothing, np.zeros(2), np.ones(2), 20.0)
    monkeypatch.setattr(judge, "differences", lambda search, result: [endless])
    references = [logs["before"], logs["healthy"], logs["dry"]]
    diagnosis = judge_signals([logs["viscous"]], references, PLACES[:1], RULES)
    assert [entry["log"] for entry in diagnosis.reference_differences] == ["endless"] * 2


def test_warnings_about_logs_are_among_the_remarks_and_what_is_no_remark_is_not(logs):
    findings = (
        Finding(WARNING, "position/hip", "jumps", "look at the cable"),
        Finding(ERROR, "", "is empty", "record it again"),
    )
    check = SimpleNamespace(name="log_3", findings=findings)
    diagnosis = judge_signals([logs["healthy"]], [], PLACES[:1], RULES, checks=[check])
    assert "log_3: warning: position/hip jumps" in diagnosis.checks
    assert not any("is empty" in remark for remark in diagnosis.checks)
