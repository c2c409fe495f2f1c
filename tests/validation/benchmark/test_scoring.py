"""Rules of scoring on answers made by hand."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hyperleg_design.validation.benchmark.case import Fault, Truth
from hyperleg_design.validation.benchmark.scoring import LARGEST_SET, OUTCOMES, score

WEAK = Fault(
    "torque_constant",
    ("elbow", "m_elbow"),
    {"scale": 0.75},
    (("transmission_ratio", ("elbow", "m_elbow")),),
)
ZERO = Fault("encoder_offset", ("shoulder",), {"offset": 0.08})
ODD = Fault("hysteresis", (), listed=False)


def cause(effect, location, probability=0.95, low=None, high=None, name="scale", **more):
    parameters = {} if low is None else {name: {"value": low, "low": low, "high": high}}
    return {
        "effect": effect,
        "location": location,
        "probability": probability,
        "parameters": parameters,
        **more,
    }


def answer(verdict, *causes, rivals=(), **more):
    return {"verdict": verdict, "causes": list(causes), "rivals": list(rivals), **more}


def test_a_true_first_cause_is_right_at_any_of_its_places_and_its_interval_is_judged():
    for place in WEAK.places:
        got = score(
            Truth((WEAK,)), answer("explained", cause("torque_constant", place, 0.95, 0.7, 0.8))
        )
        assert (got.outcome, got.inside, got.untrue_beside, got.all_named) == (
            "right",
            True,
            False,
            True,
        )
        assert not got.confident_wrong
    outside = score(
        Truth((WEAK,)), answer("explained", cause("torque_constant", "elbow", 0.95, 0.8, 0.9))
    )
    assert outside.outcome == "right"
    assert outside.inside is False


def test_the_right_effect_in_another_place_is_wrong_and_confident():
    got = score(Truth((WEAK,)), answer("explained", cause("torque_constant", "shoulder", 0.9)))
    assert (got.outcome, got.confident_wrong, got.all_named) == ("wrong", True, False)


def test_confidence_begins_at_nine_tenths_and_only_explained_answers_have_it():
    wrong = cause("payload", "lower", 0.89)
    assert not score(Truth((WEAK,)), answer("explained", wrong)).confident_wrong
    sure = cause("payload", "lower", 0.99)
    assert not score(Truth((WEAK,)), answer("ambiguous", sure)).confident_wrong
    assert score(Truth(), answer("explained", sure)).confident_wrong


def test_a_stated_equivalent_is_an_honest_one_and_no_untrue_cause():
    got = score(Truth((WEAK,)), answer("explained", cause("transmission_ratio", "elbow")))
    assert (got.outcome, got.untrue_beside, got.confident_wrong) == ("equivalent", False, False)
    assert got.inside is None


def test_the_set_of_the_first_cause_makes_it_an_honest_equivalent_unless_the_set_is_huge():
    first = cause("controller_gain", "elbow", 0.6)
    group = [
        {"effect": "controller_gain", "location": "elbow"},
        {"effect": "torque_constant", "location": "elbow"},
    ]
    told = answer("ambiguous", first, equivalent=[group])
    assert score(Truth((WEAK,)), told).outcome == "equivalent"
    more = [{"effect": "payload", "location": str(k)} for k in range(LARGEST_SET)]
    assert score(Truth((WEAK,)), {**told, "equivalent": [group + more]}).outcome == "wrong"
    elsewhere = [{**group[0], "location": "shoulder"}, group[1]]
    assert score(Truth((WEAK,)), {**told, "equivalent": [elsewhere]}).outcome == "wrong"


def test_a_true_cause_behind_an_untrue_one_is_told_apart():
    got = score(
        Truth((WEAK,)),
        answer(
            "explained", cause("backlash", "shoulder", 0.98), cause("torque_constant", "m_elbow")
        ),
    )
    assert (got.outcome, got.confident_wrong, got.all_named) == ("behind", True, True)
    beside = score(
        Truth((WEAK,)),
        answer("explained", cause("torque_constant", "elbow"), cause("backlash", "shoulder")),
    )
    assert (beside.outcome, beside.untrue_beside) == ("right", True)


def test_unknown_counts_apart_where_the_truth_leads_its_rivals():
    rivals = [cause("payload", "lower", 0.2), cause("transmission_ratio", "elbow", 0.1)]
    assert score(Truth((WEAK,)), answer("unknown", rivals=rivals)).outcome == "unknown, led"
    third = [cause("backlash", "elbow", 0.3), *rivals]
    assert score(Truth((WEAK,)), answer("unknown", rivals=third)).outcome == "unknown"
    assert score(Truth((WEAK,)), answer("none", rivals=rivals)).outcome == "none"


def test_several_faults_are_all_named_by_causes_one_by_one_or_by_one_that_stands_everywhere():
    both = Truth(
        tuple(Fault("coulomb_friction", (j,)) for j in ("shoulder", "elbow")), everywhere=True
    )
    named = (
        [cause("coulomb_friction", "shoulder"), cause("coulomb_friction", "elbow")],
        [cause("coulomb_friction", "joints")],
        [cause("coulomb_friction", "shoulder, elbow")],
        [cause("coulomb_friction", "", locations=["shoulder", "elbow"])],
    )
    for causes in named:
        got = score(both, answer("explained", *causes))
        assert (got.outcome, got.all_named, got.untrue_beside) == ("right", True, False)
    half = score(both, answer("explained", cause("coulomb_friction", "elbow")))
    assert (half.outcome, half.all_named) == ("right", False)


def test_nothing_wrong_is_right_only_as_none():
    truth = Truth()
    assert score(truth, answer("none")).outcome == "right"
    assert score(truth, answer("none", remainder=0.2)).outcome == "right"
    assert score(truth, answer("unknown")).outcome == "unknown"
    assert score(truth, answer("unknown", remainder=0.9)).outcome == "unknown"
    assert score(truth, answer("explained", remainder={"share": 1.0})).outcome == "remainder"
    false = score(truth, answer("ambiguous", cause("backlash", "elbow", 0.5)))
    assert (false.outcome, false.untrue_beside, false.all_named) == ("false cause", None, None)


def test_outside_the_catalogue_unknown_or_a_large_remainder_is_right():
    truth = Truth((ODD,))
    assert truth.kind == "outside"
    assert score(truth, answer("unknown")).outcome == "right"
    named = cause("stribeck_friction", "elbow", 0.95)
    assert score(truth, answer("explained", named)).outcome == "wrong"
    assert score(truth, answer("explained", named)).confident_wrong
    assert score(truth, answer("explained", named, remainder=0.6)).outcome == "right"
    assert score(truth, answer("explained", named, remainder=0.2)).outcome == "wrong"
    assert score(truth, answer("none")).outcome == "none"


def test_an_error_is_an_error_whatever_the_truth():
    for truth in (Truth(), Truth((WEAK,)), Truth((ODD,))):
        got = score(truth, {"verdict": "error", "message": "the log is empty"})
        assert got.outcome == "error"
        assert "the log is empty" in got.said


@pytest.mark.parametrize("truth", [Truth(), Truth((WEAK,)), Truth((WEAK, ZERO)), Truth((ODD,))])
@given(data=st.data())
def test_every_answer_has_one_outcome_and_probability_and_rivals_of_named_ones_change_none(
    truth, data
):
    named = st.builds(
        cause,
        st.sampled_from(["torque_constant", "encoder_offset", "payload"]),
        st.sampled_from(["elbow", "shoulder"]),
        st.floats(0, 1),
    )
    verdict = data.draw(st.sampled_from(["explained", "ambiguous", "none", "unknown", "error"]))
    told = answer(verdict, *data.draw(st.lists(named, max_size=3)))
    got = score(truth, told)
    assert got.outcome in OUTCOMES
    if verdict in ("explained", "ambiguous"):
        assert score(truth, {**told, "rivals": [cause("payload", "x")]}).outcome == got.outcome
    assert not (got.confident_wrong and got.outcome in ("right", "equivalent"))


def test_missing_and_odd_fields_do_not_stop_the_scoring():
    assert score(Truth((WEAK,)), {}).outcome == "error"
    assert score(Truth((WEAK,)), {"verdict": "explained", "causes": None}).outcome == "unknown"
    odd = {"effect": "torque_constant", "location": "elbow", "probability": None}
    assert score(Truth((WEAK,)), answer("explained", odd)).outcome == "right"
