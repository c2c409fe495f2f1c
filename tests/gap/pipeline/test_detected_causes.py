"""What a diagnosis makes of causes that no residual shows."""

import importlib
from dataclasses import replace

import pytest
from diagnosed import run

from hyperleg_design.gap.inference.detectors.underfoot import Underfoot
from hyperleg_design.gap.inference.rules import PosteriorRules
from hyperleg_design.gap.pipeline.detected_causes import misplaced_feet, of_feet
from hyperleg_design.gap.pipeline.diagnose import diagnose
from hyperleg_design.gap.results.diagnosis import Named, Place, Value, residual_shape
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.report.gap.text import diagnosis_text

CERTAIN, LEAST = PosteriorRules.most_certain, PosteriorRules.remainder
OTHER = Named("coulomb_friction", "hip", 0.9, 0.8, {})


@pytest.fixture(scope="module")
def none(robot_files):
    found = diagnose(
        robot_files["coupled"], [run("healthy", s, session="today") for s in (0, 1)], threads=1
    )
    assert found.verdict == "none"
    return found


def names(causes):
    return [(c.effect, c.location) for c in causes]


def feet(effect, shape, says, unit):
    return tuple(
        Underfoot(
            effect, foot, {"scale": Value(0.5, 0.4, 0.6, "")}, shape, says, weight, 30.0, 3.0, unit
        )
        for foot, weight in (("left_foot", 2.0), ("right_foot", 1.0))
    )


SLIDING, SOFT = (
    feet("ground_friction", "slips", "slides for 2 s", "N"),
    feet("ground_compliance", "sinks", "sinks by 1 mm", "m"),
)
BOTH = [("ground_friction", "left_foot"), ("ground_friction", "right_foot")]


def test_slippery_ground_is_the_cause_where_nothing_else_is(none):
    told = of_feet(none, SLIDING, CERTAIN, LEAST)
    assert (told.verdict, names(told.causes)) == ("explained", BOTH)
    assert (told.gap.before, told.gap.unit) == (pytest.approx(30.0), "N")
    assert told.gap.closed == pytest.approx(0.9)
    assert [(w.location, w.share) for w in told.where] == [
        ("left_foot", pytest.approx(2 / 3)),
        ("right_foot", pytest.approx(1 / 3)),
    ]
    assert sum(r.probability for r in told.rivals) < 0.06
    assert "slides for 2 s" in diagnosis_text(told.mapping())


def test_slippery_ground_is_one_cause_more_beside_others_and_is_not_named_twice(none):
    told = of_feet(replace(none, verdict="explained", causes=(OTHER,)), SLIDING, CERTAIN, LEAST)
    assert names(told.causes) == [("coulomb_friction", "hip"), *BOTH]
    assert of_feet(told, SLIDING, CERTAIN, LEAST) is told
    assert of_feet(none, (), CERTAIN, LEAST) is none


def test_a_foot_beyond_an_encoder_that_is_named_is_elsewhere_than_its_logs_say(none):
    subject = load_subject("hyperleg")
    named = replace(none, causes=(Named("encoder_offset", "left_knee", 0.9, 0.8, {}), OTHER))
    assert misplaced_feet(named, subject) == {"left_foot"}
    rubs = replace(none, causes=(Named("coulomb_friction", "left_knee", 0.9, 0.8, {}),))
    assert misplaced_feet(rubs, subject) == set()


def test_an_unknown_gap_under_feet_that_slide_is_theirs_and_another_is_not(none):
    unknown = replace(none, verdict="unknown")
    under = (
        Place("left_foot", "foot", "all", 0.4),
        Place("right_foot", "foot", "all", 0.3),
        Place("hip", "joint", "all", 0.3),
    )
    assert of_feet(replace(unknown, where=under), SLIDING, CERTAIN, LEAST).verdict == "explained"
    elsewhere = of_feet(
        replace(unknown, where=(Place("hip", "joint", "all", 1.0),)), SLIDING, CERTAIN, LEAST
    )
    left = [residual_shape("unlisted", name, "is left", 0.5) for name in ("left_foot_z", "hip")]
    half = replace(unknown, where=under, residual_shape=tuple(left), remainder=1.0)
    told = of_feet(half, SLIDING, CERTAIN, LEAST)
    assert told.remainder == pytest.approx(0.3)
    assert left[0] not in told.residual_shape
    assert left[1] in told.residual_shape
    all_theirs = of_feet(replace(half, where=under[:2]), SLIDING, CERTAIN, 0.5)
    assert all_theirs.remainder is None
    assert (elsewhere.verdict, elsewhere.causes) == ("unknown", ())
    assert names(elsewhere.rivals)[0] == BOTH[0]


def test_soft_ground_that_creeps_is_not_slippery_but_one_that_feet_slide_on_may_be(none):
    slippery = Named("ground_friction", "left_foot", 0.9, 0.5, {})
    soft = [("ground_compliance", foot) for _, foot in BOTH]
    assert (
        names(
            of_feet(
                replace(none, verdict="explained", causes=(slippery,)), SOFT, CERTAIN, LEAST
            ).causes
        )
        == soft
    )
    assert names(of_feet(of_feet(none, SLIDING, CERTAIN, LEAST), SOFT, CERTAIN, LEAST).causes) == [
        *BOTH,
        *soft,
    ]
    alike = replace(
        none,
        verdict="ambiguous",
        causes=(OTHER, slippery),
        equivalent=((BOTH[0], ("link_mass", "hip")),),
    )
    told = of_feet(alike, SOFT, CERTAIN, LEAST)
    assert (told.verdict, told.equivalent, names(told.causes)) == (
        "explained",
        (),
        [("coulomb_friction", "hip"), *soft],
    )


def test_what_other_logs_do_not_foretell_by_half_is_not_told(robot_files, monkeypatch):
    """Of a foot that sinks or slides now and then, without a rule."""
    pipeline = importlib.import_module("hyperleg_design.gap.pipeline.diagnose")
    monkeypatch.setattr(pipeline, "slips", lambda *_: SLIDING)
    monkeypatch.setattr(pipeline, "sinks", lambda *_: tuple(replace(o, left=16.0) for o in SOFT))
    told = diagnose(
        robot_files["coupled"], [run("healthy", s, session="today") for s in (0, 1)], threads=1
    )
    assert names(told.causes) == BOTH
